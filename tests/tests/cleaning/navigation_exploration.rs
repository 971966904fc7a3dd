//! A small slice of `cargo xtask reproduce exploration`.

use floorguard_tests::data::recording;
use floorguard_tests::exploration::{BUILDINGS, Building, Rules, best_tour_m, explore};

/// One furnished floor: known to the last corner, and the way not much longer than in hindsight.
#[test]
fn furnished_floor_is_explored_to_its_end() {
    let (name, file) = BUILDINGS[1];
    let Some(path) = recording(file) else { return };
    let building = Building::load(name, &path).unwrap();
    assert!((building.reachable_m2() - 180.0).abs() < 60.0, "{}", building.reachable_m2());
    let ours = explore(&building, Rules::Ours).unwrap();
    assert!(ours.has_ended && ours.covered_share >= 0.99, "{ours:?}");
    let tour_m = best_tour_m(&building, &ours.view_points).unwrap();
    assert!(tour_m <= ours.way_m + 0.1, "nothing is shorter than the best: {tour_m} {}", ours.way_m);
    assert!(ours.way_m <= 1.3 * tour_m, "{} m, the best tour {tour_m} m", ours.way_m);
}
