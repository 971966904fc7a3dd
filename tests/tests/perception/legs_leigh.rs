//! Legs in scans that a real scanner recorded and people labelled, each recording tested with what the others taught.

use floorguard_laboratory::evaluate::legs;
use floorguard_tests::data::recording;

/// Required; measured 0.804.
const F1_MIN: f64 = 0.80;
/// Measured 0.751 at 0.70°, coarser than the 0.5° of an S300.
const F1_COARSE_MIN: f64 = 0.74;
/// Measured 0.451 where nothing is known of the furniture: 14 numbers do not tell a chair's leg from a person's.
const F1_WITHOUT_MAP_MIN: f64 = 0.42;

#[test]
fn legs_are_found_in_held_out_recordings() {
    let Some(scans) = recording("laser2d_people/leigh_leg_training.csv.gz") else { return };
    let report = legs(&scans, false).expect("it is readable");
    println!("{report:?}");
    assert_eq!((report.method, report.folds.len(), report.legs), ("recordings", 4, 1052));
    assert!(report.f1 >= F1_MIN, "{}", report.f1);
    assert!(report.f1_coarse >= F1_COARSE_MIN, "{}", report.f1_coarse);
    assert!(report.f1_without_map >= F1_WITHOUT_MAP_MIN, "{}", report.f1_without_map);
    let curve = &report.curve;
    assert!(curve.windows(2).all(|pair| pair[1].0 >= pair[0].0), "recall only rises");
}

/// The table that the core carries is what `train legs` makes of these recordings.
#[test]
fn built_in_table_finds_its_training_legs() {
    let Some(scans) = recording("laser2d_people/leigh_leg_training.csv.gz") else { return };
    let report = legs(&scans, true).expect("it is readable");
    assert!(report.method == "table" && report.f1 > 0.85, "{report:?}");
}
