//! Predictions of recorded pedestrians: on no set worse than constant velocity, and the ellipse holds what it says.

use floorguard_tests::data::recording;
use floorguard_tests::prediction::{TrackSet, evaluate, load};

/// Files of a place, and what constant velocity is known to reach there (mean over the steps and at the last one, metres).
const PLACES: [(&str, &[&str], (f64, f64)); 3] = [
    ("eth", &["eth_biwi_eth"], (1.08, 2.28)),
    ("univ", &["univ_students001", "univ_students003"], (0.52, 1.17)),
    ("zara2", &["zara2_crowds_zara02"], (0.32, 0.72)),
];

#[test]
fn people_are_predicted_better_than_by_constant_velocity() {
    let (mut ours, mut straight) = ((0.0, 0.0), (0.0, 0.0));
    for (place, files, known) in PLACES {
        let sets: Option<Vec<TrackSet>> = files
            .iter()
            .map(|file| recording(&format!("trajectories/eth_ucy/{file}.txt.gz")))
            .map(|path| path.map(|path| load(&path).expect("tracks")))
            .collect();
        let Some(sets) = sets else { return };
        let result = evaluate(&sets);
        println!("{place}: {result:?}");
        let reference = result.constant_velocity;
        assert!((reference.mean_m - known.0).abs() < 0.006 && (reference.final_m - known.1).abs() < 0.006);
        assert!(result.ours.mean_m < reference.mean_m && result.ours.final_m < reference.final_m, "{place}");
        if result.windows > 1_000 {
            assert!((0.93..=0.97).contains(&result.covered), "{place}: {}", result.covered);
        }
        ours = (ours.0 + result.ours.mean_m / 3.0, ours.1 + result.ours.final_m / 3.0);
        straight = (straight.0 + reference.mean_m / 3.0, straight.1 + reference.final_m / 3.0);
    }
    println!("mean of the places: ours {ours:?}, constant velocity {straight:?}");
    assert!(ours.0 < 0.91 * straight.0 && ours.1 < 0.89 * straight.1);
}
