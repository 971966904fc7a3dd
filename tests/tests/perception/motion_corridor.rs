//! One walker in a simulated corridor, past a driving robot: he is found moving, and next to nothing else is. The whole
//! protocol with its figures is `cargo xtask reproduce motion`.

use floorguard_perception::motion::MotionParameters;
use floorguard_tests::corridor::{Method, Score, judge, record};
use floorguard_tests::reproduce::motion_figures;

/// Required accuracy and false positives. The parameters were chosen on seeds from 100 to 119.
const ACCURACY_MIN: f64 = 95.0;
const FALSE_MAX: u32 = 3;
const SEEDS: std::ops::Range<u64> = 0..4;
const SWEEPS: usize = 150;

#[test]
fn walker_past_driving_robot_is_found_moving() {
    let mut total = Score::default();
    for seed in SEEDS {
        let score = judge(&record(seed, SWEEPS), Method::Own { reach_m: 8.0 }, MotionParameters::FIXED);
        println!("seed {seed}: {score:?}");
        total.add(&score);
    }
    assert!(total.present > 400, "{total:?}");
    assert!(total.accuracy() >= ACCURACY_MIN, "{:.2} %: {total:?}", total.accuracy());
    assert!(total.false_positives <= FALSE_MAX, "{total:?}");
}

#[test]
fn the_published_figures_keep_their_trends() {
    let figures = motion_figures(1, 30);
    println!("{}", figures.text());
    assert!(figures.trends_hold());
}
