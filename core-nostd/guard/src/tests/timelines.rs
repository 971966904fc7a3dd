//! The whole guard over time: what happens, when, and how it ends.

use std::format;

use super::fixtures::{Rig, config, forward};
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::sensing::SafetyInput;

pub(super) fn stopped(decision: &Decision) -> bool {
    decision.action.stops() && decision.permitted == Twist2::ZERO
}

#[test]
fn fg_req_012_motion_needs_healthy_sources_ready_within_two_seconds() {
    for missing in Source::ALL.into_iter().filter(|source| config().rules(*source).required_at_start) {
        let mut rig = Rig::new();
        rig.silent.push(missing);
        for _ in 0..400 {
            let decision = rig.step();
            assert!(stopped(&decision), "without {}: {decision:?}", missing.name());
        }
        assert_eq!(rig.step().state, GuardState::Init);
        rig.silent.clear();
        let ready_ms = rig.until(|decision| decision.permitted.linear_mps > 0.0).unwrap();
        assert!(ready_ms <= 2_000, "{ready_ms}");
    }
}

#[test]
fn fg_req_013_lost_source_stops_within_20_ms_named() {
    for source in Source::ALL {
        let Some(deadline_us) = config().rules(source).stop_after_us else { continue };
        let mut rig = Rig::cruising();
        rig.silent.push(source);
        // The newest scan may be 30 ms old when the line is cut.
        let stopped_ms = rig.until(stopped).unwrap();
        assert!(stopped_ms * 1_000 <= deadline_us + 20_000, "{}: {stopped_ms} ms", source.name());
        let lost =
            rig.guard.causes().find(|record| record.cause == Cause::SourceLost(source)).copied().unwrap();
        assert_eq!(lost.health, Health::Stale);
        assert!(format!("{lost}").contains(source.name()), "{lost}");
        rig.silent.clear();
        let went_on_ms = rig.until(|decision| decision.permitted.linear_mps > 0.0);
        if matches!(source, Source::Drive | Source::Discrete) {
            // Power that comes back does not start the robot (ISO 3691-4 4.1.14): an operator does.
            assert_eq!(went_on_ms, None, "{}", source.name());
            rig.guard.request_reset(rig.now);
            assert!(rig.until(|decision| decision.permitted.linear_mps > 0.0).is_some(), "{}", source.name());
        } else {
            assert!(went_on_ms.is_some_and(|ms| ms >= 1_000), "{}: {went_on_ms:?}", source.name());
        }
    }
}

#[test]
fn fg_req_014_silent_perception_limits_speed() {
    let mut rig = Rig::cruising();
    rig.silent.push(Source::Perception);
    let decision = rig.run_ms(600);
    assert_eq!((decision.state, decision.action), (GuardState::Slow, Action::Limit));
    assert!(decision.speed_limit_mps <= 0.5 && decision.permitted.linear_mps <= 0.5);
}

#[test]
fn fg_req_011_future_stamps_are_a_fault_with_offset() {
    for source in Source::ALL.into_iter().filter(|source| config().rules(*source).stop_after_us.is_some()) {
        let mut rig = Rig::cruising();
        rig.stamp_ahead_us[source.index()] = 3_200_000;
        let stopped_ms = rig.until(stopped).unwrap();
        assert!(stopped_ms <= 50, "{}: {stopped_ms} ms", source.name());
        let record =
            rig.guard.causes().find(|record| record.cause == Cause::SourceLost(source)).copied().unwrap();
        assert!(format!("{record}").contains("3.200 s in the future"), "{record}");
    }
}

#[test]
fn fg_req_015_a_scanner_whose_counter_stands_still_is_frozen() {
    let mut rig = Rig::cruising();
    rig.frozen_scanner = true;
    assert!(rig.until(stopped).unwrap() <= 200);
    assert!(
        rig.guard
            .health()
            .iter()
            .any(|report| report.source == Source::Scanner && report.health == Health::Frozen)
    );
}

#[test]
fn fg_req_016_lidar_without_returns_is_blind_and_stops() {
    let mut rig = Rig::cruising();
    rig.silent.push(Source::Lidar);
    for step in 0..8_u16 {
        let mut packet = super::fixtures::packet(rig.now, step * 480, 5.0);
        for column in &mut packet.columns {
            column.range_raw.fill(0);
        }
        rig.guard.on_lidar_packet(&packet, rig.now);
    }
    assert!(rig.guard.causes().any(|record| record.cause == Cause::SourceLost(Source::Lidar)));
    assert!(rig.guard.health().iter().any(|report| report.health == Health::Blind));
}

#[test]
fn fg_req_020_protective_field_stops_after_two_scans() {
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.8, 0.0));
    let stopped_ms = rig.until(stopped).unwrap();
    assert!(stopped_ms <= 80, "{stopped_ms}");
    let cause = rig.step().primary_cause.unwrap();
    assert_eq!(cause.cause, Cause::ScanProtective);
    assert!((cause.measured - 0.9).abs() < 0.02 && (cause.limit - 1.4).abs() < 0.02, "{cause}");
}

#[test]
fn fg_req_009_stop_lasts_one_second_after_clear_field() {
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    rig.run_ms(2_000);
    rig.obstacles.clear();
    let free_ms = rig.until(|decision| decision.permitted.linear_mps > 0.0).unwrap();
    assert!((960..=1_100).contains(&free_ms), "{free_ms}");
}

#[test]
fn fg_req_023_obstacle_packet_stops_within_that_packet() {
    let mut rig = Rig::cruising();
    let decision = rig.guard.on_lidar_packet(&super::fixtures::packet(rig.now, 0, 1.2), rig.now);
    assert!(stopped(&decision), "{decision:?}");
    assert_eq!(decision.primary_cause.unwrap().cause, Cause::LidarProtective);
    let mut rig = Rig::cruising();
    let far = rig.guard.on_lidar_packet(&super::fixtures::packet(rig.now, 0, 2.5), rig.now);
    assert!(!far.action.stops(), "{far:?}");
    let own_body = rig.guard.on_lidar_packet(&super::fixtures::packet(rig.now, 0, 0.3), rig.now);
    assert!(!own_body.action.stops(), "{own_body:?}");
}

#[test]
fn fg_req_024_a_dazzled_sector_counts_as_blocked() {
    for (silent, expected) in [(5_usize, false), (7, true)] {
        let mut rig = Rig::cruising();
        let mut scan = super::fixtures::scan(rig.now, 900_000, &[]);
        for beam in scan.beams.iter_mut().skip(250).take(silent) {
            *beam = floorguard_types::sensing::BeamReturn::Unknown;
        }
        let decision = rig.guard.on_scan(&scan, rig.now);
        assert_eq!(stopped(&decision), expected, "{silent} beams of 0.5 degrees: {decision:?}");
    }
}

#[test]
fn fg_req_022_larger_field_must_be_clear_before_speed() {
    let mut config = config();
    config.thresholds.warning_speed_mps = 1.0;
    let mut rig = Rig::with(config);
    // Outside the fields up to 0.6 m/s, inside the one up to 1.1 m/s; beside the warning fields of the former.
    rig.obstacles.push(Point2::new(1.9, 0.48));
    for _ in 0..800 {
        let decision = rig.step();
        assert!(decision.permitted.linear_mps <= 0.6 + 1.0e-6, "{decision:?}");
        assert!(decision.state == GuardState::Init || !decision.action.stops(), "{decision:?}");
    }
    assert!(rig.step().permitted.linear_mps > 0.55);
    rig.obstacles.clear();
    assert!(rig.run_ms(2_000).permitted.linear_mps > 0.79);
}

#[test]
fn fg_req_021_field_follows_higher_commanded_or_measured_speed() {
    let mut rig = Rig::cruising();
    assert_eq!(rig.step().field_set, 2);
    rig.wanted = Twist2::ZERO;
    rig.silent.push(Source::Wheels);
    rig.guard.on_wheels(forward(0.8), rig.now, rig.now);
    assert_eq!(rig.guard.on_command(Twist2::ZERO, rig.now, rig.now).field_set, 2, "still rolling");
    assert_eq!(rig.guard.on_wheels(forward(0.0), rig.now, rig.now).field_set, 0, "standing");
}

#[test]
fn fg_req_040_front_bumper_permits_only_crawl_backward() {
    let mut rig = Rig::cruising();
    rig.inputs.bumper_front = SafetyInput::Active;
    rig.run_ms(500);
    rig.wanted = forward(-0.3);
    let decision = rig.run_ms(1_000);
    assert!(decision.escaping && decision.state == GuardState::Latched);
    assert!((decision.permitted.linear_mps + 0.1).abs() < 1.0e-3, "{decision:?}");
    rig.wanted = forward(0.3);
    assert!(stopped(&rig.run_ms(500)));
    rig.wanted = Twist2 { linear_mps: -0.3, angular_radps: 0.2 };
    assert!(stopped(&rig.run_ms(500)), "a bend is not proven not to approach");
}

#[test]
fn fg_req_041_escape_needs_an_unblocked_path() {
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    rig.run_ms(500);
    rig.wanted = forward(-0.3);
    assert!(rig.until(|decision| decision.permitted.linear_mps < 0.0).is_some());
    // Something behind the robot, seen by the lidar: the reverse field stops, and there is no way out.
    let mut rig = Rig::cruising();
    rig.wanted = forward(-0.3);
    rig.obstacles.push(Point2::new(1.1, 0.0));
    rig.run_ms(2_000);
    let decision = rig.guard.on_lidar_packet(&super::fixtures::packet(rig.now, 18_000, 1.2), rig.now);
    assert!(stopped(&decision), "{decision:?}");
}

#[test]
fn fg_req_031_person_near_limits_person_on_path_stops() {
    let person = |x_m: f32, y_m: f32, vx: f32| AdvisedPerson {
        id: 1,
        position: Point2::new(x_m, y_m),
        velocity_mps: Point2::new(vx, 0.0),
        position_sigma_m: 0.05,
        velocity_sigma_mps: 0.05,
    };
    let mut rig = Rig::cruising();
    rig.people.push(person(0.2, 1.2, 0.0));
    assert!(rig.run_ms(1_500).permitted.linear_mps <= 0.3 + 1.0e-6);
    let mut rig = Rig::cruising();
    rig.people.push(person(3.0, 0.0, -1.2));
    let decision = rig.run_ms(150);
    assert!(
        stopped(&decision) && decision.primary_cause.unwrap().cause == Cause::CollisionStop,
        "{decision:?}"
    );
}
