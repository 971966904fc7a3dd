//! Our detector against the published one on the same simulated sweeps; `cargo xtask reproduce candidates` makes the
//! whole table.

use floorguard_tests::candidates::{SEED, scores};

#[test]
fn our_detector_claims_more_people_fewer_objects() {
    for (scene, precision_min, recall_min) in [("supermarket", 0.97, 0.86), ("airport", 0.92, 0.84)] {
        let ([ours, published], misses) = scores(scene, 6, SEED).expect("the scene is built in");
        println!("{scene}: ours {:.3} {:.3}, {ours:?}", ours.precision(), ours.recall());
        print!("{}", misses.text());
        println!("{scene}: published {:.3} {:.3}, {published:?}", published.precision(), published.recall());
        assert!(ours.labels > 80, "{scene}: {ours:?}");
        assert!(ours.precision() >= precision_min && ours.recall() >= recall_min, "{scene}: {ours:?}");
        assert!(ours.precision() > published.precision() && ours.recall() > published.recall());
    }
}
