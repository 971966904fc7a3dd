//! The guard alone, under a program outside that drives by velocities: bytes in, bytes out, judged by true geometry.

use floorguard_configuration::CommandConfiguration;
use floorguard_laboratory::plan::{HeardAt, OutsideProgram, SentFrame, Stretch};
use floorguard_laboratory::world::{Observation, Observer, Plan, load_scenario, run_virtual};
use floorguard_runtime::configuration::BaseKind;
use floorguard_sim::wire::SentVelocity;

/// State "stop" and flag "past its deadline" of the book, Velocity link.
const STOP: u8 = 3;
const EXPIRED: u8 = 8;
const SECOND_US: u64 = 1_000_000;

/// A person stands 5 m ahead; beside that an empty hall.
const PERSON_AHEAD: &str = "title = \"a person stands ahead\"\n[route]\nspeed_mps = 0.5\nwaypoints_m = []\n\
    [scene]\nwall = [{ from_m = [-4.0, -6.0], to_m = [12.0, -6.0] }, { from_m = [12.0, -6.0], to_m = [12.0, 6.0] }]\n\
    [[person]]\nat_m = [5.0, 0.1]\nsees_robot = false\n";

/// The same hall without people.
fn empty() -> &'static str {
    PERSON_AHEAD.split("[[person]]").next().unwrap_or_default()
}

fn plan(scenario: &str, seconds: u64) -> Plan {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scenario.toml");
    std::fs::write(&path, scenario).unwrap();
    let scenario = load_scenario(&path).unwrap();
    let mut plan = Plan::of("outside", scenario, 1, seconds * SECOND_US).unwrap();
    plan.command = Some(CommandConfiguration::on_port("127.0.0.1:7000".parse().unwrap()));
    plan
}

/// Twenty requests a second, from 1 s on.
fn stretch(until_s: f64, linear_mps: f32) -> Stretch {
    let first =
        SentVelocity { sender: 7, sequence: 1, sent_ms: 0, deadline_ms: 150, linear_mps, angular_radps: 0.0 };
    let span_us = (SECOND_US, (until_s * 1.0e6) as u64);
    Stretch { span_us, period_us: 50_000, first }
}

fn play(mut plan: Plan, sent: Vec<SentFrame>) -> (Observation, Vec<HeardAt>) {
    let program = OutsideProgram::new(sent);
    plan.outside = Some(program.clone());
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).unwrap();
    (observer.into_observation(), program.heard())
}

#[test]
fn velocity_toward_person_is_stopped_with_reason() {
    let (seen, heard) = play(plan(PERSON_AHEAD, 14), stretch(14.0, 0.8).frames(1));
    assert!(seen.verdict.passed, "{}", seen.verdict.why_not());
    assert_eq!(seen.verdict.bodies.counts.while_moving(), 0, "{:?}", seen.verdict.bodies.contacts);
    // It went there, and stands before the person although the program still asks for 0.8 m/s.
    let (went_m, at_end_m) = (seen.path_m(0.0, 10.0), seen.path_m(11.0, 14.0));
    assert!(went_m > 1.5 && at_end_m < 0.02, "{went_m} m, then {at_end_m} m");
    let last = &heard.last().expect("permits").permit;
    assert_eq!((last.permitted, last.requested, last.state), ([0.0; 2], [0.8, 0.0], STOP), "{last:?}");
    let names_it =
        ["person", "obstacle", "body would touch"].iter().any(|word| last.reason.as_str().contains(word));
    assert!(names_it && last.causes & 1 << last.cause != 0, "{last:?}");
    // 50 permits a second, numbered without a gap, and every request accepted.
    assert!(heard.len() >= 13 * 50, "{}", heard.len());
    assert!(heard.windows(2).all(|pair| pair[1].permit.sequence == pair[0].permit.sequence + 1));
    assert_eq!(last.counters, [260, 0, 0, 0, 0, 0, 0]);
}

#[test]
fn robot_stands_at_the_missed_deadline() {
    let mut sent = stretch(5.0, 0.5);
    sent.first.deadline_ms = 60;
    let again = Stretch {
        span_us: (7 * SECOND_US, 11 * SECOND_US),
        first: SentVelocity { sequence: 500, ..sent.first },
        ..sent
    };
    let (first, second) = (sent.frames(1), again.frames(1));
    let last_us = first.last().expect("requests").at_us;
    let (seen, heard) = play(plan(empty(), 11), [first, second].concat());
    assert!(seen.verdict.passed, "{}", seen.verdict.why_not());
    let between = |from_us: u64, to_us: u64| {
        heard.iter().filter(move |heard| (last_us + from_us..last_us + to_us).contains(&heard.at_us))
    };
    let moves = between(0, 55_000).all(|heard| heard.permit.permitted[0] > 0.4);
    assert!(moves, "it drives until the deadline");
    // The guard itself would believe the command for 200 ms.
    let stands = between(75_000, 190_000).all(|heard| {
        let permit = &heard.permit;
        (permit.permitted, permit.requested, permit.flags & EXPIRED) == ([0.0; 2], [0.0; 2], EXPIRED)
    });
    assert!(stands, "{:?}", between(75_000, 190_000).collect::<Vec<_>>());
    assert!(between(75_000, 190_000).count() >= 5);
    let held = between(500_000, 1_500_000)
        .all(|heard| heard.permit.reason.as_str().starts_with("wanted command stale"));
    assert!(held, "{:?}", between(500_000, 600_000).next());
    assert!(seen.path_m(6.0, 7.0) < 0.01, "{}", seen.path_m(6.0, 7.0));
    let again_m = seen.path_m(7.0, 11.0);
    assert!(again_m > 0.5, "it goes on when requests come again: {again_m}");
}

#[test]
fn swapped_sender_does_not_drive() {
    let other = Stretch {
        span_us: (2 * SECOND_US + 10_000, 5 * SECOND_US),
        first: SentVelocity { sender: 8, linear_mps: -0.25, ..stretch(0.0, 0.0).first },
        ..stretch(0.0, 0.0)
    };
    // The same name from another address is another sender, too.
    let disguised = Stretch { first: SentVelocity { sender: 7, sequence: 9_000, ..other.first }, ..other };
    let sent = [stretch(6.0, 0.4).frames(1), other.frames(2), disguised.frames(3)].concat();
    let (seen, heard) = play(plan(empty(), 6), sent);
    assert!(seen.verdict.passed, "{}", seen.verdict.why_not());
    let last = &heard.last().expect("permits").permit;
    assert_eq!(last.counters, [100, 0, 0, 0, 0, 0, 120]);
    let backwards = heard.iter().find(|heard| {
        heard.permit.requested[0] < 0.0 || heard.permit.permitted[0] < 0.0 || heard.permit.measured[0] < -0.02
    });
    assert_eq!(backwards, None);
    assert!(heard.iter().all(|heard| [0, 7].contains(&heard.permit.sender)));
    assert!(seen.path_m(1.0, 6.0) > 1.0);
}

/// Velocity in, velocity out: the base is a controller that takes velocities and reports its own. Without a lidar, too.
#[test]
fn base_of_velocities_stands_before_person() {
    for has_lidar in [true, false] {
        let mut plan = plan(PERSON_AHEAD, 16);
        (plan.robot.base, plan.robot.has_lidar) = (BaseKind::Velocity, has_lidar);
        let (seen, heard) = play(plan, stretch(16.0, 0.8).frames(1));
        let counts = &seen.verdict.bodies.counts;
        assert_eq!(counts.while_moving(), 0, "{has_lidar}: {:?}", seen.verdict.bodies.contacts);
        let (went_m, at_end_m) = (seen.path_m(0.0, 13.0), seen.path_m(13.0, 16.0));
        assert!(went_m > 1.5 && at_end_m < 0.02, "{has_lidar}: {went_m} m, then {at_end_m} m");
        let last = &heard.last().expect("permits").permit;
        assert_eq!((last.permitted, last.state), ([0.0; 2], STOP), "{last:?}");
        // Without a lidar people are not recognised: the guard permits half a metre a second at most.
        let fastest_mps = heard.iter().fold(0.0_f32, |most, heard| most.max(heard.permit.permitted[0]));
        assert!(if has_lidar { fastest_mps > 0.7 } else { fastest_mps <= 0.5 }, "{has_lidar}: {fastest_mps}");
    }
}

/// One of each kind, between requests that are right: each is refused and counted, and none is driven.
#[test]
fn refused_requests_are_counted_on_wire() {
    let mut sent = stretch(3.0, 0.3).frames(1);
    let bad = SentVelocity { sequence: 2_000, sent_ms: 2_010, linear_mps: 0.9, ..stretch(0.0, 0.0).first };
    let mut damaged = bad.encode();
    damaged[20] ^= 1;
    let wrong = [
        damaged,
        SentVelocity { linear_mps: f32::NAN, ..bad }.encode(),
        SentVelocity { angular_radps: f32::INFINITY, ..bad }.encode(),
        // Sent 300 ms ago, as it arrives now.
        SentVelocity { sent_ms: 1_710, ..bad }.encode(),
        // The request of 2.00 s is number 21.
        SentVelocity { sequence: 3, ..bad }.encode(),
        SentVelocity { sequence: 21, ..bad }.encode(),
        SentVelocity { deadline_ms: 5, ..bad }.encode(),
    ];
    sent.extend(wrong.into_iter().map(|bytes| SentFrame { at_us: 2_010_000, peer: 1, bytes }));
    let (_, heard) = play(plan(empty(), 3), sent);
    let last = &heard.last().expect("permits").permit;
    assert_eq!(last.counters, [40, 2, 2, 1, 1, 1, 0], "{last:?}");
    assert!(heard.iter().all(|heard| heard.permit.requested[0] <= 0.3));
}
