//! Legs in scans that a real scanner recorded and people labelled, each recording tested with what the others taught.

use floorguard_laboratory::evaluate::{legs, walker};
use floorguard_tests::data::recording;

/// Required of the mean and of the worst recording; measured 0.819 and 0.769.
const F1_MEAN_MIN: f64 = 0.80;
const F1_WORST_MIN: f64 = 0.74;
/// Measured 0.747 at 0.70°, coarser than the 0.5° of an S300.
const F1_COARSE_MIN: f64 = 0.74;
/// Measured 0.759 and 0.702 where no map is known, only what the scans before showed.
const F1_WITHOUT_MAP_MIN: f64 = 0.72;
const F1_WITHOUT_MAP_WORST_MIN: f64 = 0.65;
/// Measured 0.451 for a scan alone: 14 numbers do not tell a chair's leg from a person's.
const F1_SINGLE_SCAN_MIN: f64 = 0.42;

#[test]
fn legs_are_found_in_held_out_recordings() {
    let Some(scans) = recording("laser2d_people/leigh_leg_training.csv.gz") else { return };
    let report = legs(&scans, false).expect("it is readable");
    println!("{report:?}");
    assert_eq!((report.method, report.folds.len(), report.legs), ("recordings", 4, 1052));
    assert!(report.f1_mean >= F1_MEAN_MIN && report.f1_worst >= F1_WORST_MIN, "{report:?}");
    assert!(report.f1_coarse >= F1_COARSE_MIN, "{}", report.f1_coarse);
    assert!(report.f1_without_map_mean >= F1_WITHOUT_MAP_MIN, "{}", report.f1_without_map_mean);
    assert!(report.f1_without_map_worst >= F1_WITHOUT_MAP_WORST_MIN, "{}", report.f1_without_map_worst);
    assert!(report.f1_single_scan >= F1_SINGLE_SCAN_MIN, "{}", report.f1_single_scan);
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

/// Somebody walks before a robot that follows and whose motion is not recorded.
#[test]
fn walker_before_moving_robot_is_confirmed() {
    let Some(scans) = recording("laser2d_people/leigh_person_following_outdoor_1.scans.csv.gz") else {
        return;
    };
    let Some(truth) = recording("laser2d_people/leigh_person_following_outdoor_1.people_gt.csv") else {
        return;
    };
    let report = walker(&scans, Some(&truth)).expect("both are readable");
    println!("{report:?}");
    assert!(report.judged > 2_500 && report.judged_moving > 1_500, "{report:?}");
    assert!(report.tracked > 0.85 && report.confirmed_moving > 0.75, "{report:?}");
    assert!(report.others_per_scan < 0.2, "{report:?}");
}
