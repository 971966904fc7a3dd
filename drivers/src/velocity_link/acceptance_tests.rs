//! Timelines of requests: who is listened to, in which order, and until when.

use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

use super::*;

const DEADLINE_MS: u16 = 100;

fn acceptance() -> Acceptance {
    Acceptance::new(AcceptanceRules { sender: None, deadline_max_us: 200_000 })
}

fn at(ms: u64) -> Stamp {
    Stamp::from_micros(ms * 1_000)
}

/// A request of a sender whose clock is 1,000 ms behind.
fn request(sender: u32, sequence: u32, sent_ms: u64) -> VelocityRequest {
    VelocityRequest {
        sender,
        sequence,
        sent_ms: sent_ms as u32,
        deadline_ms: DEADLINE_MS,
        stop: StopDemand::None,
        twist: Twist2 { linear_mps: 0.5, angular_radps: 0.0 },
    }
}

fn offer(acceptance: &mut Acceptance, request: &VelocityRequest, ms: u64) -> Result<Accepted, Refusal> {
    acceptance.offer(&request.encode(), Arrival { peer: 1, at: at(ms) })
}

#[test]
fn request_is_zero_from_its_deadline_on() {
    let mut acceptance = acceptance();
    assert_eq!(acceptance.requested(at(0)), Twist2::ZERO);
    offer(&mut acceptance, &request(7, 1, 0), 1_000).unwrap();
    assert_eq!(acceptance.requested(at(999)), Twist2::ZERO, "the clock ran backwards");
    assert_eq!(acceptance.requested(at(1_099)).linear_mps, 0.5);
    assert_eq!(acceptance.requested(at(1_100)), Twist2::ZERO);
    assert_eq!(acceptance.expires(), Some(at(1_100)));
}

#[test]
fn long_deadline_is_cut_to_the_robots() {
    let mut acceptance = acceptance();
    let long = VelocityRequest { deadline_ms: 1_000, ..request(7, 1, 0) };
    assert_eq!(offer(&mut acceptance, &long, 1_000).map(|accepted| accepted.expires), Ok(at(1_200)));
}

#[test]
fn order_is_that_of_the_sequence() {
    let mut acceptance = acceptance();
    offer(&mut acceptance, &request(7, u32::MAX, 0), 1_000).unwrap();
    offer(&mut acceptance, &request(7, 1, 50), 1_050).unwrap();
    let refused = offer(&mut acceptance, &request(7, 0, 25), 1_060);
    assert_eq!(refused, Err(Refusal::OutOfOrder { found: 0, newest: 1 }));
    assert_eq!(offer(&mut acceptance, &request(7, 1, 50), 1_070), Err(Refusal::Repeated { sequence: 1 }));
    // What is refused does not live on: the deadline is that of the newest accepted one.
    assert_eq!(acceptance.expires(), Some(at(1_150)));
    let counters = acceptance.counters();
    assert_eq!((counters.accepted, counters.out_of_order, counters.repeated), (2, 1, 1));
}

#[test]
fn late_requests_are_refused_by_senders_clock() {
    let mut acceptance = acceptance();
    offer(&mut acceptance, &request(7, 1, 0), 1_000).unwrap();
    // 40 ms longer on its way than the first: it holds for 60 ms.
    let accepted = offer(&mut acceptance, &request(7, 2, 50), 1_090).unwrap();
    assert_eq!((accepted.stamp.as_micros() / 1_000, accepted.expires.as_micros() / 1_000), (1_050, 1_150));
    let late = offer(&mut acceptance, &request(7, 3, 100), 1_250);
    assert!(matches!(late, Err(Refusal::Late { late_us: 149_000..=150_000 })), "{late:?}");
    assert!(offer(&mut acceptance, &request(7, 4, 240), 1_260).is_ok(), "in time again");
}

/// A number that is newer does not make a stamp newer.
#[test]
fn newer_number_with_old_stamp_is_late() {
    let mut acceptance = acceptance();
    offer(&mut acceptance, &request(7, 1, 2_000), 3_000).unwrap();
    let late = offer(&mut acceptance, &request(7, 2, 1_710), 3_010);
    assert!(matches!(late, Err(Refusal::Late { late_us: 299_000..=300_000 })), "{late:?}");
    assert!(offer(&mut acceptance, &request(7, 3, 1_990), 3_010).is_ok(), "20 ms late, and in time");
}

/// A network that stops for three seconds and then delivers everything at once: nothing of the past is driven.
#[test]
fn burst_after_a_stall_is_refused() {
    let mut acceptance = acceptance();
    offer(&mut acceptance, &request(7, 1, 0), 1_000).unwrap();
    let refused = (2..=60).filter(|number| {
        let sent_ms = u64::from(*number - 1) * 50;
        offer(&mut acceptance, &request(7, *number, sent_ms), 4_000).is_err()
    });
    // Sent at 2,900 and 2,950 of 3,000 ms: the last two are fresh.
    assert_eq!(refused.count(), 57);
    assert_eq!(acceptance.counters().late, 57);
}

#[test]
fn swapped_senders_are_refused_until_silence() {
    let mut acceptance = acceptance();
    offer(&mut acceptance, &request(7, 1, 0), 1_000).unwrap();
    assert_eq!(offer(&mut acceptance, &request(8, 9, 0), 1_500), Err(Refusal::OtherSender { found: 8 }));
    let elsewhere = Arrival { peer: 2, at: at(1_500) };
    let refused = acceptance.offer(&request(7, 2, 500).encode(), elsewhere);
    assert_eq!(refused, Err(Refusal::OtherSender { found: 7 }), "the same name from another address");
    assert_eq!((acceptance.holder(at(1_999)), acceptance.holder(at(2_000))), (Some(7), None));
    assert!(offer(&mut acceptance, &request(8, 10, 0), 2_000).is_ok(), "the first was silent for a second");
    assert_eq!(acceptance.holder(at(2_000)), Some(8));
    assert_eq!(acceptance.counters().other_sender, 2);
}

#[test]
fn named_sender_is_the_only_one() {
    let mut acceptance = Acceptance::new(AcceptanceRules { sender: Some(7), deadline_max_us: 200_000 });
    assert_eq!(offer(&mut acceptance, &request(8, 1, 0), 1_000), Err(Refusal::OtherSender { found: 8 }));
    assert!(offer(&mut acceptance, &request(7, 1, 0), 1_000).is_ok());
}

/// A program that is started again counts from the beginning, on another clock: after a second it is listened to.
#[test]
fn restarted_sender_is_taken_after_a_second() {
    let mut acceptance = acceptance();
    offer(&mut acceptance, &request(7, 900, 70_000), 71_000).unwrap();
    let again = offer(&mut acceptance, &request(7, 1, 0), 71_500);
    assert_eq!(again, Err(Refusal::OutOfOrder { found: 1, newest: 900 }));
    assert!(offer(&mut acceptance, &request(7, 12, 0), 72_100).is_ok());
}

/// Two quartz clocks, one slow by 100 parts in a million, for twenty minutes.
#[test]
fn drifting_clocks_stay_in_time() {
    let mut acceptance = acceptance();
    for number in 0..1_440_u32 {
        let here_ms = u64::from(number) * 900;
        let sent_ms = here_ms - here_ms / 10_000;
        let accepted = offer(&mut acceptance, &request(7, number + 1, sent_ms), 1_000 + here_ms);
        assert!(accepted.is_ok(), "{number}: {accepted:?}");
    }
}

#[test]
fn stops_are_for_bases_alone() {
    let mut acceptance = acceptance();
    let stop = VelocityRequest { stop: StopDemand::Hold, ..request(7, 1, 0) };
    assert!(matches!(offer(&mut acceptance, &stop, 1_000), Err(Refusal::Frame(FrameError::Field { .. }))));
    let counters = acceptance.counters();
    assert_eq!((counters.damaged, counters.accepted), (1, 0));
}
