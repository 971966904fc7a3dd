//! The window of an actuated lidar in a ray-cast simulation: published tables, four experiments, drift. What each judge must
//! refuse is judged too.

use floorguard_mapping::sliding_window::{CellPolicy, WindowPoint};
use floorguard_tests::reproduce::sliding_window::{
    accuracy, arrows, drift, erasure, navigation, reconstruction,
};

/// Lines of three sweeps for each figure of a table.
const TRIALS: u64 = 4;

#[test]
fn accuracy_is_as_published_or_better() {
    let found = accuracy(TRIALS, |point| point).unwrap();
    assert!(found.holds(), "{}", found.text());
}

#[test]
fn corrupted_windows_are_refused() {
    // Every surface 3 cm too far in the direction of its own grid.
    let farther = |one: WindowPoint| {
        let mut seen = one.face.project(one.point);
        seen.elevation_m += 0.03;
        WindowPoint { point: one.face.point(seen), ..one }
    };
    let found = accuracy(1, farther).unwrap();
    assert!(!found.holds(), "{}", found.text());
    // Six tenths of the smallest cell beside its place.
    let beside = |mut one: WindowPoint| {
        one.point.y_m += 0.015;
        one
    };
    let found = drift(beside).unwrap();
    assert!(!found.holds(), "{}", found.text());
}

#[test]
fn rooms_are_reconstructed() {
    let found = reconstruction(CellPolicy::Nearest).unwrap();
    assert!(found.holds(), "{}", found.text());
    let last = reconstruction(CellPolicy::Compat).unwrap();
    assert!(!last.holds(), "{}", last.text());
}

#[test]
fn corners_are_driven_around() {
    let found = navigation(true).unwrap();
    assert!(found.holds(), "{}", found.text());
    let standing = navigation(false).unwrap();
    assert!(!standing.holds(), "{}", standing.text());
}

#[test]
fn people_are_erased_and_followed() {
    let found = erasure(true).unwrap();
    assert!(found.holds(), "{}", found.text());
    let unaware = erasure(false).unwrap();
    assert!(!unaware.holds(), "{}", unaware.text());
    let walkers = arrows().unwrap();
    assert!(walkers.holds(), "{}", walkers.text());
}

#[test]
fn driving_leaves_no_drift() {
    let found = drift(|point| point).unwrap();
    assert!(found.holds(), "{}", found.text());
}
