//! Learning in a new place, end to end on simulated sweeps. Longer: `cargo xtask reproduce online-learning`.

use floorguard_laboratory::train::{anchors, learn_place};
use floorguard_perception::online_learning::Weights;
use floorguard_tests::online::{holds, places};

/// Fifteen seconds are too short for anything to be taken over: what is said must be the shipped answer, look for look.
#[test]
fn before_anything_is_judged_good_the_answers_are_the_shipped_ones() {
    let place = &places(1, 15)[0];
    let (report, weights) = learn_place(place, &anchors(4), None);
    assert_eq!(report.windows.len(), 2);
    let looks = report.shipped.found + report.shipped.missed + report.shipped.wrong + report.shipped.rejected;
    assert!(looks > 100, "{report:?}");
    assert_eq!((report.shipped, weights), (report.learned, Weights::ZERO));
    assert!(holds(&report));
    let [people, nobodies, _] = report.windows[1].labelled;
    assert!(people + nobodies > 0, "{report:?}");
}
