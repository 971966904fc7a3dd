//! The numbers of a decision against figures computed by hand: what mutated operators would change.

use super::fixtures::{Rig, config, forward};
use crate::field_selection::{Demand, travel_of};
use crate::limiter::{effective_speed_mps, limited};
use crate::machine::DecisionMachine;
use crate::protection::{CauseRecord, FaultKind, Travel, Unit};
use crate::rules::Escape;
use crate::source_monitor::SourceMonitor;
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::time::Stamp;

fn person(x_m: f32, y_m: f32, vx_mps: f32) -> AdvisedPerson {
    AdvisedPerson {
        position: Point2::new(x_m, y_m),
        velocity_mps: Point2::new(vx_mps, 0.0),
        ..AdvisedPerson::default()
    }
}

/// What a cause says after one piece of advice.
fn after_advice(rig: &mut Rig, person: AdvisedPerson, cause: Cause) -> Option<CauseRecord> {
    let people = [person].into_iter().collect();
    rig.guard.on_advice(&Advice { stamp: rig.now, people, ..Advice::default() }, rig.now);
    rig.guard.causes().find(|record| record.cause == cause).copied()
}

fn near(a: f32, b: f32) -> bool {
    (a - b).abs() < 1.0e-4
}

fn turning(linear_mps: f32, angular_radps: f32) -> Twist2 {
    Twist2 { linear_mps, angular_radps }
}

#[test]
fn fg_req_031_speed_towards_people_follows_the_formula() {
    let mut configured = config();
    configured.drive.speed_mps = 0.9;
    let mut rig = Rig::with(configured);
    rig.run_ms(5_000);
    assert!(near(rig.measured.linear_mps, 0.8));
    // Response 0.15 s, braking 0.8/0.8 s, margin 0.5 s.
    let stop_s = 1.65;
    let coming = person(5.9, 0.0, -1.0);
    let [time_s, _] = rig.guard.body.times_to_person_s(&coming, forward(0.8));
    assert!((2.0..2.9).contains(&time_s), "{time_s}");
    let slow = after_advice(&mut rig, coming, Cause::CollisionSlow).expect("slows");
    assert!(near(slow.measured, time_s) && near(slow.limit, 3.0) && slow.unit == Unit::Seconds);
    let expected_mps = 0.9 * (time_s - stop_s) / (3.0 - stop_s);
    assert!(near(slow.speed_limit_mps, expected_mps), "{} {expected_mps}", slow.speed_limit_mps);
    let stop = after_advice(&mut rig, person(3.0, 0.0, -1.0), Cause::CollisionStop).expect("stops");
    assert!(near(stop.limit, stop_s) && stop.measured < stop_s, "{stop:?}");
}

#[test]
fn fg_req_031_standing_robot_judges_requested_slow_start() {
    let mut rig = Rig::cruising();
    rig.measured = Twist2::ZERO;
    for (wanted, likely) in [
        (forward(0.8), forward(0.3)),
        (forward(0.2), forward(0.2)),
        (turning(0.6, 0.4), turning(0.3, 0.2)),
        (turning(-0.6, 0.4), turning(-0.3, 0.2)),
    ] {
        rig.guard.on_wheels(Twist2::ZERO, rig.now, rig.now);
        rig.guard.on_command(wanted, rig.now, rig.now);
        let seen = rig.guard.likely_motion();
        assert!(near(seen.linear_mps, likely.linear_mps) && near(seen.angular_radps, likely.angular_radps));
    }
    rig.guard.on_command(forward(0.8), rig.now, rig.now);
    let stop = after_advice(&mut rig, person(2.0, 0.0, -1.0), Cause::CollisionStop).expect("stops");
    assert!(near(stop.limit, 0.15 + 0.3 / 0.8 + 0.5), "{stop:?}");
    // Faster than standing, what it does counts.
    rig.guard.on_wheels(forward(0.06), rig.now, rig.now);
    assert_eq!(rig.guard.likely_motion(), forward(0.06));
    rig.guard.on_wheels(forward(0.05), rig.now, rig.now);
    assert_ne!(rig.guard.likely_motion(), forward(0.05), "0.05 m/s is standing");
}

#[test]
fn fg_req_031_collision_only_at_the_body() {
    for (y_m, stops) in [(0.73, false), (0.6, true)] {
        let mut rig = Rig::cruising();
        rig.measured = Twist2::ZERO;
        rig.wanted = Twist2::ZERO;
        rig.run_ms(200);
        let found = after_advice(&mut rig, person(0.25, y_m, 0.0), Cause::CollisionStop);
        assert_eq!(found.is_some(), stops, "{y_m} m beside: {found:?}");
    }
}

#[test]
fn fg_req_013_late_source_reports_age_and_deadline() {
    let mut rig = Rig::cruising();
    rig.silent.push(Source::Imu);
    rig.until(|decision| decision.action.stops()).expect("stops");
    let records: std::vec::Vec<_> = rig.guard.causes().copied().collect();
    let of = |cause| records.iter().find(|record| record.cause == cause).expect("held");
    let late = of(Cause::SourceLate(Source::Imu));
    assert!(near(late.limit, 0.05) && (0.05..0.07).contains(&late.measured), "{late:?}");
    let lost = of(Cause::SourceLost(Source::Imu));
    assert!(near(lost.limit, 0.1) && (0.1..0.12).contains(&lost.measured) && lost.unit == Unit::Seconds);
    let mut rig = Rig::cruising();
    rig.guard.on_source_fault(Source::Imu, FaultKind::Garbled, rig.now);
    let lost = rig.guard.causes().find(|record| record.cause == Cause::SourceLost(Source::Imu));
    assert_eq!(lost.expect("held").unit, Unit::None, "a fault is not an age");
}

#[test]
fn fg_req_012_absent_or_optional_sources_are_not_awaited() {
    let mut configured = config();
    configured.sources[Source::Imu.index()].fitted = false;
    let mut rig = Rig::with(configured);
    rig.silent = std::vec![Source::Imu, Source::Perception];
    rig.run_ms(2_000);
    assert!(rig.guard.state.started);
}

#[test]
fn fg_req_001_category_1_removes_torque_category_2_holds() {
    let mut rig = Rig::cruising();
    rig.silent.push(Source::Drive);
    let torque_off = |rig: &mut Rig| rig.until(|decision| decision.torque_off);
    let decision = rig.run_ms(150);
    assert!(decision.action == Action::Category1 && !decision.torque_off, "{decision:?}");
    assert!(torque_off(&mut rig).is_some() && rig.measured.linear_mps < 0.06);
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    let decision = rig.run_ms(3_000);
    assert!(decision.action == Action::Category2 && !decision.torque_off && rig.measured == Twist2::ZERO);
}

#[test]
fn fg_req_050_the_envelope_waits_for_the_response_time() {
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    rig.until(|decision| decision.action.stops()).expect("stops");
    rig.run_ms(60);
    assert!(near(rig.guard.state.checks.envelope_mps, 0.8), "{}", rig.guard.state.checks.envelope_mps);
    rig.run_ms(200);
    assert!(rig.guard.state.checks.envelope_mps < 0.75);
}

#[test]
fn fg_req_021_what_is_desired_keeps_the_curve() {
    let mut rig = Rig::cruising();
    rig.guard.on_command(turning(0.8, 0.4), rig.now, rig.now);
    let verdict = |action, limit_mps| machine::Verdict {
        action,
        state: GuardState::Slow,
        limit_mps,
        primary: None,
        holding: None,
    };
    for (limit_mps, share) in [(0.3, 0.375), (f32::INFINITY, 1.0), (0.0, 0.125)] {
        let desired = rig.guard.desired(&verdict(Action::Limit, limit_mps));
        assert!(
            near(desired.linear_mps, 0.8 * share) && near(desired.angular_radps, 0.4 * share),
            "{desired:?}"
        );
    }
}

#[test]
fn fg_req_025_directions_change_exactly_at_their_limits() {
    let cases = [
        (turning(0.0, 0.0), None),
        (turning(0.0, 0.1), Some(Travel::Spin)),
        (turning(0.04, 0.09), Some(Travel::Straight)),
        (turning(-0.04, 0.09), Some(Travel::Reverse)),
        (turning(0.05, 0.5), Some(Travel::Left)),
        (turning(0.5, 0.15), Some(Travel::Straight)),
        (turning(0.5, -0.15), Some(Travel::Straight)),
        (turning(0.5, 0.16), Some(Travel::Left)),
        (turning(0.5, -0.16), Some(Travel::Right)),
        (turning(-0.5, 0.16), Some(Travel::Reverse)),
    ];
    for (twist, travel) in cases {
        assert_eq!(travel_of(twist), travel, "{twist:?}");
    }
    let demand = |measured| Demand { wanted: forward(-0.2), permitted: Twist2::ZERO, measured };
    assert_eq!(demand(forward(0.2)).travel(), Some(Travel::Straight), "it still rolls forward");
    assert_eq!(demand(forward(0.05)).travel(), Some(Travel::Reverse), "it stands");
    assert_eq!(demand(forward(0.06)).travel(), Some(Travel::Straight));
}

#[test]
fn fg_req_006_limiter_covers_steered_wheel_and_acceleration() {
    let drive = config().drive;
    assert!(near(effective_speed_mps(turning(0.0, 0.5), &drive), 0.4));
    assert!(near(effective_speed_mps(turning(0.6, 0.5), &drive), 0.6));
    let go = |wanted, previous, step_s| limited(wanted, 1.0, &drive, (previous, step_s));
    assert!(near(go(forward(0.8), Twist2::ZERO, 0.01).linear_mps, 0.005));
    assert!(near(go(forward(0.8), forward(0.5), 0.1).linear_mps, 0.55));
    assert!(near(go(forward(-0.8), forward(0.5), 0.1).linear_mps, -0.05), "turning back starts from rest");
    assert_eq!(go(forward(f32::NAN), forward(0.5), 0.1), Twist2::ZERO);
    assert_eq!(go(turning(0.5, f32::INFINITY), forward(0.5), 0.1), Twist2::ZERO);
}

#[test]
fn fg_req_005_evidence_ends_at_exactly_200_ms() {
    let at = |ms: u64| Stamp::from_micros(10_000_000 + ms * 1_000);
    let granted_after = |ms: u64| {
        let mut machine = DecisionMachine::new(at(0));
        machine.request_reset(at(2_000));
        machine.raise(CauseRecord::new(Cause::EmergencyStop, at(2_100)));
        machine.settle(true, at(2_100 + ms));
        machine.resets()
    };
    assert_eq!((granted_after(199), granted_after(200)), (0, 1));
}

#[test]
fn fg_req_001_lowest_limit_wins_first_of_equals_shown() {
    let now = Stamp::from_micros(20_000_000);
    let verdict = |first: (Cause, f32), second: (Cause, f32)| {
        let mut machine = DecisionMachine::IDLE;
        for (cause, limit_mps) in [first, second] {
            machine.raise(CauseRecord::new(cause, now).limited_to(limit_mps));
        }
        let verdict = machine.settle(true, now);
        (verdict.limit_mps, verdict.primary.map(|record| record.cause))
    };
    let both = verdict((Cause::Warning, 0.3), (Cause::AdviceLimit, 0.5));
    assert_eq!(both, (0.3, Some(Cause::Warning)));
    assert_eq!(verdict((Cause::Warning, 0.3), (Cause::PersonNear, 0.3)).1, Some(Cause::Warning));
}

#[test]
fn fg_req_040_each_contact_has_its_escape() {
    let expected = [
        (Cause::BumperFront, Escape::Backward),
        (Cause::CliffFront, Escape::Backward),
        (Cause::BumperRear, Escape::Forward),
        (Cause::CliffRear, Escape::Forward),
        (Cause::ScanProtective, Escape::AwayFromEvidence),
        (Cause::LidarProtective, Escape::AwayFromEvidence),
        (Cause::EmergencyStop, Escape::Never),
        (Cause::BlindSector, Escape::Never),
    ];
    for (cause, escape) in expected {
        assert_eq!(cause.escape(), escape, "{cause:?}");
    }
}

#[test]
fn fg_req_011_future_stamp_is_fresh_within_tolerance_only() {
    let stamp = Stamp::from_micros(10_000_000);
    let mut monitor = SourceMonitor::default();
    assert!(monitor.accept(stamp, 1, stamp));
    let before = |us: u64| Stamp::from_micros(10_000_000 - us);
    assert_eq!(monitor.age_us(before(2_000)), 0);
    assert_eq!(monitor.age_us(before(2_001)), u64::MAX);
    assert_eq!(monitor.age_us(stamp.plus_micros(7)), 7);
}

#[test]
fn unconfigured_guard_permits_nothing_in_place_equals_new() {
    let mut rig = Rig::new();
    rig.guard = Supervisor::UNCONFIGURED;
    for _ in 0..500 {
        assert_eq!(rig.step().permitted, Twist2::ZERO);
    }
    // Inputs received before the robot was configured are discarded.
    rig.guard.configure(config(), rig.now).unwrap();
    let mut fresh = Rig::new();
    (fresh.guard, fresh.now) = (Supervisor::new(config(), rig.now).unwrap(), rig.now);
    (rig.measured, fresh.measured) = (Twist2::ZERO, Twist2::ZERO);
    assert_eq!(rig.guard.state, fresh.guard.state);
    assert_eq!(rig.guard.scan_table, fresh.guard.scan_table);
    assert_eq!(rig.guard.packet_table, fresh.guard.packet_table);
    assert_eq!(rig.run_ms(5_000).permitted, forward(0.8));
    // A refused configuration changes nothing.
    let mut wrong = config();
    wrong.drive.speed_mps = f32::NAN;
    assert!(rig.guard.configure(wrong, rig.now).is_err());
    assert_eq!(rig.run_ms(100).permitted, forward(0.8));
}
