//! Tours on the benchmark grids against the best known ones (LKH), with the time they took.

use std::time::{Duration, Instant};

use floorguard_cleaning::{Distances, EuclideanCells, TourSolver};
use floorguard_tests::data::bench_input;
use floorguard_types::random::Pcg32;

/// All distances, worked out once.
struct Matrix {
    count: usize,
    values: Vec<i32>,
}

impl Distances for Matrix {
    fn between(&self, from: u16, to: u16) -> i32 {
        self.values[usize::from(from) * self.count + usize::from(to)]
    }
}

fn matrix(points: &[(f32, f32)]) -> Matrix {
    let straight = EuclideanCells { points, scale: 1_000.0 };
    let count = points.len();
    let ids = || 0..count as u16;
    Matrix { count, values: ids().flat_map(|a| ids().map(move |b| straight.between(a, b))).collect() }
}

fn length(points: &[(f32, f32)], order: &[u16]) -> f64 {
    let at = |i: usize| points[usize::from(order[i % order.len()])];
    (0..order.len()).map(|i| f64::from(at(i).0 - at(i + 1).0).hypot(f64::from(at(i).1 - at(i + 1).1))).sum()
}

/// Longer than the best known, in percent, after at most `budget`.
fn excess_percent(name: &str, budget: Duration) -> Option<f64> {
    let text = std::fs::read_to_string(bench_input(&format!("tsp/{name}.csv"))?).expect("readable");
    let points: Vec<(f32, f32)> = text
        .lines()
        .filter_map(|line| line.split_once(',').and_then(|(x, y)| Some((x.parse().ok()?, y.parse().ok()?))))
        .collect();
    let keys = std::fs::read_to_string(bench_input("tsp/best_known.json")?).expect("readable");
    let keys: serde_json::Value = serde_json::from_str(&keys).expect("JSON");
    let best = keys[name]["length"].as_f64().expect("a length");
    let distances = matrix(&points);
    let mut solver = Box::new(TourSolver::<1_026>::new(Pcg32::new(1, 1)));
    let begin = Instant::now();
    solver.start_closed(points.len(), &distances).expect("fits");
    let (first_time, first) = (begin.elapsed(), solver.length(&distances) as f64 / 1_000.0);
    let mut experiments = 0;
    while begin.elapsed() < budget {
        solver.improve(100, &distances);
        experiments += 100;
    }
    let order: Vec<u16> = solver.order().collect();
    let percent = 100.0 * (length(&points, &order) / best - 1.0);
    println!(
        "{name}: first {:+.2} % in {:.2} ms, then {percent:+.2} % in {:.1} ms with {experiments} experiments",
        100.0 * (first / best - 1.0),
        first_time.as_secs_f64() * 1e3,
        begin.elapsed().as_secs_f64() * 1e3,
    );
    Some(percent)
}

/// Optimised, 50 ms are enough; the unoptimised build of the tests gets more time, not a weaker limit.
fn budget() -> Duration {
    Duration::from_millis(if cfg!(debug_assertions) { 1_500 } else { 50 })
}

#[test]
fn a_hundred_and_three_hundred_cells_stay_within_one_percent() {
    for size in [100, 300] {
        for instance in 1..=3 {
            let Some(percent) = excess_percent(&format!("tsp_{size}_{instance}"), budget()) else { return };
            assert!(percent <= 1.0, "{percent} %");
        }
    }
}

#[test]
fn a_thousand_cells_stay_within_three_percent() {
    for instance in 1..=3 {
        let Some(percent) = excess_percent(&format!("tsp_1000_{instance}"), budget()) else { return };
        assert!(percent <= 3.0, "{percent} %");
    }
}
