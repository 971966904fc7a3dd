//! Learning in a new place, end to end on simulated sweeps. Longer: `cargo xtask reproduce online-learning`.

use floorguard_laboratory::train::{anchors, learn_place};
use floorguard_perception::online_learning::Weights;
use floorguard_tests::online::{holds, places};

/// Fifteen seconds are too short for anything to be taken over: the answers must be the shipped ones, sample by sample.
#[test]
fn answers_are_shipped_until_an_update() {
    let place = &places(1, 15)[0];
    let (report, weights) = learn_place(place, &anchors(4), None);
    assert_eq!(report.windows.len(), 2);
    let samples =
        report.shipped.found + report.shipped.missed + report.shipped.wrong + report.shipped.rejected;
    assert!(samples > 100, "{report:?}");
    assert_eq!((report.shipped, weights), (report.learned, Weights::ZERO));
    assert!(holds(&report));
    let [people, non_people, _] = report.windows[1].labelled;
    assert!(people + non_people > 0, "{report:?}");
}
