//! Every decision with its full truth table.

use super::fixtures::{config, forward};
use crate::Blocked;
use crate::field_selection::travel_of;
use crate::limiter::{is_straight, lets_leave, limited};
use crate::scan_check::ScanFinding;
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::time::Stamp;

#[test]
fn fg_req_001_actions_are_ordered_only_categories_stop() {
    let ordered = [Action::None, Action::Limit, Action::Category2, Action::Category1, Action::Category0];
    assert!(ordered.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!(ordered.map(Action::stops), [false, false, true, true, true]);
}

#[test]
fn fg_req_002_every_cause_has_its_slot_and_its_action() {
    for (index, cause) in Cause::all().into_iter().enumerate() {
        assert_eq!(cause.index(), index, "{cause:?}");
        let is_limit = cause.action() == Action::Limit;
        assert_eq!(is_limit, matches!(cause.clear(), Clear::Quiet(500_000)), "{cause:?}");
        let stops_by_itself = matches!(cause.clear(), Clear::Quiet(us) if us >= 1_000_000);
        assert!(
            is_limit
                || stops_by_itself
                || matches!(cause.clear(), Clear::Start | Clear::Reset | Clear::Restart),
            "{cause:?}"
        );
        // What turns the torque off can never be driven away from.
        assert!(cause.action() <= Action::Category2 || cause.escape() == Escape::Never, "{cause:?}");
        // The audit's page shows these lines.
        let (action, clear, escape) = (cause.action(), cause.clear(), cause.escape());
        std::println!("cause: {cause:?} | {action} | {clear:?} | {escape:?} | {cause}");
    }
}

#[test]
fn fg_req_010_health_names_the_first_fault() {
    let rules = SourceRules { frozen_samples: 2, ..SourceRules::required(100, 0.3, 200) };
    let now = Stamp::from_micros(1_000_000);
    for bits in 0..16_u8 {
        let [faulty, old, frozen, blind] = [1, 2, 4, 8].map(|bit| bits & bit != 0);
        let mut monitor = SourceMonitor::default();
        assert_eq!(monitor.health(&rules, now), Health::Absent);
        let stamp = if old { now.minus_micros(100_001) } else { now.minus_micros(100_000) };
        for print in 0..4 {
            assert!(monitor.accept(stamp, if frozen { 7 } else { print + 1 }, now));
        }
        monitor.blind = blind;
        monitor.fault = faulty.then_some(FaultKind::LinkDown);
        let expected = match (faulty, old, frozen, blind) {
            (true, ..) => Health::Faulty,
            (_, true, ..) => Health::Stale,
            (_, _, true, _) => Health::Frozen,
            (.., true) => Health::Blind,
            _ => Health::Healthy,
        };
        assert_eq!(monitor.health(&rules, now), expected, "{bits:04b}");
    }
}

#[test]
fn fg_req_013_source_demand_by_fitting_health_and_age() {
    let now = Stamp::from_micros(1_000_000);
    let at = |age_us: u64, rules: SourceRules| {
        let mut monitor = SourceMonitor::default();
        monitor.accept(now.minus_micros(age_us), 1, now);
        monitor.demand(&rules, now)
    };
    let rules = SourceRules::required(100, 0.3, 200);
    assert_eq!(at(100_000, rules), Action::None);
    assert_eq!(at(100_001, rules), Action::Limit);
    assert_eq!(at(200_000, rules), Action::Limit);
    assert_eq!(at(200_001, rules), Action::Category2);
    assert_eq!(at(900_000, SourceRules { stop_after_us: None, ..rules }), Action::Limit);
    assert_eq!(at(900_000, SourceRules { fitted: false, ..rules }), Action::None);
    let mut faulty = SourceMonitor::default();
    faulty.accept(now, 1, now);
    faulty.fault = Some(FaultKind::Garbled);
    assert_eq!(faulty.demand(&rules, now), Action::Category2, "a fault does not wait for the deadline");
    assert_eq!(SourceMonitor::default().demand(&rules, now), Action::Category2);
}

#[test]
fn fg_req_011_only_stamps_beyond_tolerance_are_future() {
    let now = Stamp::from_micros(1_000_000);
    for (ahead_us, accepted) in [(0, true), (2_000, true), (2_001, false), (u64::MAX / 2, false)] {
        let mut monitor = SourceMonitor::default();
        assert_eq!(monitor.accept(now.plus_micros(ahead_us), 1, now), accepted);
        assert_eq!(monitor.health(&SourceRules::required(100, 0.3, 200), now) == Health::Healthy, accepted);
        assert_eq!(monitor.age_us(now) == 0, accepted);
    }
    // An older sample does not make the source older, nor a refused one fresher.
    let mut monitor = SourceMonitor::default();
    monitor.accept(now, 1, now);
    monitor.accept(now.minus_micros(50_000), 2, now);
    assert_eq!(monitor.age_us(now), 0);
    monitor.accept(now.plus_micros(500_000), 3, now);
    assert_eq!(monitor.newest, Some(now));
}

#[test]
fn fg_req_040_leaving_by_cause_action_direction_and_path() {
    for cause in Cause::all() {
        for action in [Action::None, Action::Limit, Action::Category2, Action::Category1, Action::Category0] {
            for (backward, clear) in [(false, false), (false, true), (true, false), (true, true)] {
                let direction = match cause.escape() {
                    Escape::Never => false,
                    Escape::Forward => !backward,
                    Escape::Backward => backward,
                    Escape::AwayFromEvidence => true,
                };
                let expected = match action {
                    Action::None | Action::Limit => true,
                    Action::Category2 => direction && clear,
                    Action::Category1 | Action::Category0 => false,
                };
                assert_eq!(lets_leave(cause, action, backward, clear), expected, "{cause:?} {action:?}");
            }
        }
    }
    assert!(is_straight(forward(-0.1)) && is_straight(Twist2 { linear_mps: 0.1, angular_radps: 0.02 }));
    assert!(!is_straight(forward(0.0)) && !is_straight(forward(f32::NAN)));
    assert!(!is_straight(Twist2 { linear_mps: 0.1, angular_radps: -0.021 }));
}

#[test]
fn fg_req_041_evidence_blocks_the_directions_that_come_nearer() {
    let body = Body::around(&config().footprint);
    let at = |x_m, y_m| {
        let mut blocked = Blocked::default();
        blocked.add(Point2::new(x_m, y_m), &body);
        (blocked.forward, blocked.backward)
    };
    assert_eq!(at(1.2, 0.0), (true, false));
    assert_eq!(at(-0.6, 0.0), (false, true));
    assert_eq!(at(0.3, 0.5), (false, false), "beside: neither direction comes nearer");
    assert_eq!(at(0.3, 0.0), (true, true), "inside the body");
    // The proof by numbers: no step in a free direction shortens the distance.
    for (x, y) in (-30..40).flat_map(|x| (-15..15).map(move |y| (x as f32 * 0.1, y as f32 * 0.1))) {
        let (forward_blocked, backward_blocked) = at(x, y);
        let before = body.distance_m(Point2::new(x, y));
        for (blocked, step) in [(forward_blocked, 0.01), (backward_blocked, -0.01)] {
            assert!(blocked || body.distance_m(Point2::new(x - step, y)) >= before - 1.0e-6, "{x} {y}");
        }
    }
}

#[test]
fn fg_req_024_blind_by_share_or_by_run() {
    let table =
        [(5.0, 0.0, false), (5.1, 0.0, true), (0.0, 0.052, false), (0.0, 0.053, true), (6.0, 0.06, true)];
    for (silent_percent, silent_run_rad, expected) in table {
        let finding = ScanFinding { silent_percent, silent_run_rad, ..ScanFinding::default() };
        assert_eq!(finding.is_blind(), expected, "{silent_percent} {silent_run_rad}");
    }
}

#[test]
fn fg_req_025_steering_bins() {
    let bin = |linear_mps, angular_radps| travel_of(Twist2 { linear_mps, angular_radps });
    assert_eq!(bin(0.0, 0.0), None);
    assert_eq!(bin(0.0, 0.2), Some(Travel::Spin));
    assert_eq!(bin(0.01, -0.2), Some(Travel::Spin));
    assert_eq!(bin(0.01, 0.0), Some(Travel::Straight));
    assert_eq!(bin(-0.01, 0.0), Some(Travel::Reverse));
    assert_eq!(bin(-0.5, 0.4), Some(Travel::Reverse));
    assert_eq!(bin(0.5, 0.2), Some(Travel::Left));
    assert_eq!(bin(0.5, -0.2), Some(Travel::Right));
    assert_eq!(bin(0.5, 0.1), Some(Travel::Straight));
}

#[test]
fn fg_req_006_limiting_keeps_curve_and_never_exceeds_input() {
    let drive = config().drive;
    let wanted = Twist2 { linear_mps: 0.8, angular_radps: 0.4 };
    let out = limited(wanted, 0.4, &drive, (wanted, 0.01));
    assert!((out.linear_mps - 0.4).abs() < 1.0e-6 && (out.angular_radps - 0.2).abs() < 1.0e-6);
    assert_eq!(limited(wanted, 0.0, &drive, (wanted, 0.01)), Twist2::ZERO);
    assert_eq!(limited(forward(f32::NAN), 1.0, &drive, (wanted, 0.01)), Twist2::ZERO);
    let from_rest = limited(forward(1.0), 1.0, &drive, (Twist2::ZERO, 0.01));
    assert!((from_rest.linear_mps - 0.005).abs() < 1.0e-6, "0.5 m/s² for 10 ms");
    let turning_back = limited(forward(-1.0), 1.0, &drive, (forward(1.0), 0.01));
    assert!((turning_back.linear_mps + 0.005).abs() < 1.0e-6);
    let spin = Twist2 { linear_mps: 0.0, angular_radps: 2.0 };
    assert!((limited(spin, 1.0, &drive, (spin, 0.1)).angular_radps - 0.8).abs() < 1.0e-6);
}

#[test]
fn fg_req_050_a_condition_must_persist() {
    let mut persistence = Persistence::default();
    let at = Stamp::from_micros;
    assert!(!persistence.check(true, (100, at(0))) && !persistence.check(true, (100, at(99))));
    assert!(persistence.check(true, (100, at(100))));
    assert!(!persistence.check(false, (100, at(101))) && !persistence.check(true, (100, at(102))));
}
