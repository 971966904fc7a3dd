//! Some static worlds of the BARN benchmark, driven by both local planners: every tenth for ours, every thirtieth for the
//! dynamic window. All of them: `cargo run --release --bin floorguard-barn`.

use floorguard_tests::barn::{Which, drive, load, summarise};
use floorguard_tests::data::recording;
use rayon::prelude::*;

#[test]
fn ours_beats_the_window_in_static_worlds() {
    let Some(path) = recording("barn/barn_even.npz") else { return };
    let worlds = load(&path).expect("the benchmark's worlds");
    assert_eq!(worlds.len(), 150);
    // The published runs name the optimal time of world 0: 27.937 s are 4.1597 of it.
    assert!((worlds[0].optimal_s() - 27.937 / 4.1597).abs() < 0.01, "{}", worlds[0].optimal_s());
    let run = |which: Which, every: usize| {
        let some: Vec<_> = worlds.iter().step_by(every).collect();
        let runs: Vec<_> =
            some.into_par_iter().map(|world| (world.clone(), drive(world, which, 1))).collect();
        let summary = summarise(&runs);
        println!("{which:?}: {summary:?}");
        summary
    };
    let (ours, window) = (run(Which::Mppi, 10), run(Which::Dwa, 30));
    assert!(ours.success >= 0.98 && ours.collision == 0.0, "{ours:?}");
    assert!(ours.score.clipped >= 0.245, "{ours:?}");
    assert!(window.collision == 0.0, "{window:?}");
    assert!(ours.score.open >= 1.5 * window.score.open, "{ours:?} {window:?}");
}
