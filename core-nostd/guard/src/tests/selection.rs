//! Which field set is watched, step by step, against the book, Guard: Field selection.

use heapless::Vec;

use super::fixtures::{config, forward, rectangle};
use crate::field_selection::{Demand, FieldSelection, travel_of};
use crate::*;
use floorguard_types::capacities::FIELD_SETS_MAX;
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

const ACTIVATION_US: u64 = 100_000;
const NOW: Stamp = Stamp::from_micros(10_000_000);

/// Sets 0 to 2 straight up to 0.3, 0.6 and 1.1 m/s, set 3 reverse to 0.3, set 4 left to 0.5 m/s.
fn sets() -> Vec<FieldSet, FIELD_SETS_MAX> {
    let mut sets = config().fields;
    let (protective, warning) = (rectangle([-0.45, 1.5], 0.5), rectangle([-0.45, 2.1], 0.6));
    let left = FieldSet { travel: Travel::Left, speed_max_mps: 0.5, protective, warning };
    sets.push(left).expect("room");
    sets
}

fn watching(active: usize) -> FieldSelection {
    FieldSelection { active, ..FieldSelection::new(&sets(), NOW) }
}

/// Drives as permitted, and wants something.
fn demand(drives: Twist2, wanted: Twist2) -> Demand {
    Demand { wanted, permitted: drives, measured: drives }
}

/// The selection after one update, beginning with the set `active`.
fn after(active: usize, demand: &Demand) -> FieldSelection {
    let mut selection = watching(active);
    selection.update(&sets(), demand, (ACTIVATION_US, NOW));
    selection
}

#[test]
fn fg_req_021_faster_robot_gets_larger_set_at_once() {
    for (drives_mps, active) in [(0.2, 0), (0.3, 0), (0.5, 1), (0.6, 1), (0.7, 2), (1.5, 2)] {
        let drives = forward(drives_mps);
        assert_eq!(after(0, &demand(drives, drives)).active, active, "{drives_mps}");
    }
    // Whichever is the higher: what is permitted, or what is measured.
    let (slow, fast) = (forward(0.2), forward(0.5));
    assert_eq!(after(0, &Demand { wanted: slow, permitted: fast, measured: slow }).active, 1);
    assert_eq!(after(0, &Demand { wanted: slow, permitted: slow, measured: fast }).active, 1);
}

#[test]
fn fg_req_021_smaller_set_needs_the_hysteresis() {
    for (drives_mps, active) in [(0.7, 2), (0.58, 2), (0.54, 1), (0.28, 1), (0.24, 0)] {
        let drives = forward(drives_mps);
        assert_eq!(after(2, &demand(drives, drives)).active, active, "{drives_mps}");
    }
    // What is wanted keeps the larger set although the robot is slow.
    assert_eq!(after(2, &demand(forward(0.2), forward(0.8))).active, 2);
}

#[test]
fn fg_req_022_only_faster_requests_watch_the_next_set() {
    let candidate = |active, wanted_mps: f32| {
        let drives = forward(0.25);
        after(active, &demand(drives, forward(wanted_mps))).candidate
    };
    assert_eq!(candidate(0, 0.3), None, "the set covers it");
    assert_eq!(candidate(0, 0.31), Some(1));
    assert_eq!(candidate(1, 0.7), Some(2));
    assert_eq!(candidate(2, 1.5), None, "there is no larger set");
}

#[test]
fn fg_req_022_watched_set_activates_after_clear_activation_time() {
    let sets = sets();
    let requested = demand(forward(0.25), forward(0.5));
    let mut selection = watching(0);
    let mut at_ms = |ms: u64| {
        selection.update(&sets, &requested, (ACTIVATION_US, NOW.plus_micros(ms * 1_000)));
        (selection.active, selection.candidate)
    };
    assert_eq!(at_ms(0), (0, Some(1)));
    assert_eq!(at_ms(99), (0, Some(1)));
    assert_eq!(at_ms(100), (1, None));
    let mut selection = watching(0);
    selection.update(&sets, &requested, (ACTIVATION_US, NOW));
    selection.candidate_blocked(NOW.plus_micros(50_000));
    selection.update(&sets, &requested, (ACTIVATION_US, NOW.plus_micros(149_000)));
    assert_eq!(selection.active, 0, "something was in it");
    selection.update(&sets, &requested, (ACTIVATION_US, NOW.plus_micros(150_000)));
    assert_eq!(selection.active, 1);
}

#[test]
fn fg_req_025_direction_change_limits_speed_during_activation() {
    let sets = sets();
    let left = Twist2 { linear_mps: 0.4, angular_radps: 0.3 };
    assert_eq!(travel_of(left), Some(Travel::Left));
    // From what is watched, doing what, to which set, with which speed meanwhile and afterwards.
    let cases = [
        (1, left, 4, 0.5, 0.5),
        (0, left, 4, 0.3, 0.5),
        (4, forward(0.5), 1, 0.5, 0.6),
        (2, forward(-0.2), 3, 0.0, 0.3),
        (3, forward(0.2), 0, 0.0, 0.3),
    ];
    for (active, drives, needed, meanwhile_mps, later_mps) in cases {
        let mut selection = after(active, &demand(drives, drives));
        selection.candidate = None;
        assert_eq!(selection.active, needed, "{active} {drives:?}");
        let cap = |us: u64| selection.cap_mps(&sets, drives, NOW.plus_micros(us));
        assert_eq!((cap(0), cap(ACTIVATION_US - 1)), (meanwhile_mps, meanwhile_mps), "{active} {drives:?}");
        assert_eq!((cap(ACTIVATION_US), cap(ACTIVATION_US + 1)), (later_mps, later_mps), "{active}");
    }
}

#[test]
fn fg_req_021_no_set_permits_the_opposite_direction() {
    let sets = sets();
    let cap = |active, wanted_mps| watching(active).cap_mps(&sets, forward(wanted_mps), NOW.plus_micros(1));
    assert_eq!([cap(1, 0.2), cap(1, 0.0), cap(1, -0.2)], [0.6, 0.6, 0.0]);
    assert_eq!([cap(3, 0.2), cap(3, 0.0), cap(3, -0.2)], [0.0, 0.3, 0.3]);
}

#[test]
fn fg_req_021_the_order_of_the_sets_does_not_matter() {
    let orders: [[usize; 5]; 4] = [[0, 1, 2, 3, 4], [4, 3, 2, 1, 0], [2, 0, 4, 1, 3], [1, 2, 3, 4, 0]];
    let spin = Twist2 { linear_mps: 0.0, angular_radps: 0.5 };
    let right = Twist2 { linear_mps: 0.2, angular_radps: -0.4 };
    for order in orders {
        let sets: Vec<_, FIELD_SETS_MAX> =
            order.iter().filter_map(|index| sets().get(*index).cloned()).collect();
        let needed = |drives: Twist2| {
            let mut selection = FieldSelection::new(&sets, NOW);
            assert_eq!(sets[selection.active].speed_max_mps, 0.3, "it begins with the slowest");
            selection.update(&sets, &demand(drives, drives), (0, NOW));
            let set = &sets[selection.active];
            (set.travel, set.speed_max_mps)
        };
        for (speed_mps, set_mps) in [(0.2, 0.3), (0.3, 0.3), (0.4, 0.6), (0.7, 1.1), (2.0, 1.1)] {
            assert_eq!(needed(forward(speed_mps)), (Travel::Straight, set_mps), "{order:?} {speed_mps}");
        }
        assert_eq!(needed(forward(-0.2)), (Travel::Reverse, 0.3), "{order:?}");
        assert_eq!(needed(forward(-0.9)), (Travel::Reverse, 0.3), "the largest of its direction");
        // Directions without sets of their own are watched straight ahead.
        for twist in [spin, right] {
            assert_eq!(needed(twist), (Travel::Straight, 0.3), "{order:?} {twist:?}");
        }
    }
}
