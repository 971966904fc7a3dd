//! Adds wrong loops to published pose graphs and counts how many are believed.

use std::io::Read;
use std::time::Instant;

use floorguard_mapping_host::Se2;
use floorguard_mapping_host::metrics::{ErrorStatistics, PosePair, TimedPose, absolute_errors};
use floorguard_mapping_host::pose_graph::*;

/// A linear congruential generator (Knuth's constants), 0 to 1.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count
    }
}

fn main() {
    let names: Vec<String> = std::env::args().skip(1).collect();
    for name in ["ring", "intel", "intel_vertigo", "manhattan_olson", "manhattan", "city10000"] {
        if names.is_empty() || names.iter().any(|n| n == name) {
            graph(name);
        }
    }
}

fn graph(name: &str) {
    let path = format!("../shared/data/posegraphs/{name}.g2o.gz");
    let mut text = String::new();
    flate2::read::MultiGzDecoder::new(std::fs::File::open(path).unwrap()).read_to_string(&mut text).unwrap();
    let clean = read_g2o(&text).unwrap();
    let mut right = clean.clone();
    right.poses = orientation_start(&right, &[]).unwrap();
    optimise(&mut right, &[], &OptimiseConfig::default()).unwrap();
    for share in [0.0, 0.1, 0.3, 0.5] {
        wrong(name, &clean, &right.poses, share);
    }
}

fn wrong(name: &str, clean: &Graph, right: &[Se2], share: f64) {
    let model: Vec<Edge> = clean.edges.iter().filter(|e| e.kind == EdgeKind::Loop).copied().collect();
    let (mut graph, mut random) = (clean.clone(), Random(7));
    let first_wrong = graph.edges.len();
    for _ in 0..(share * model.len() as f64) as usize {
        let (from, to) = (random.below(right.len()), random.below(right.len()));
        let like = model[random.below(model.len())];
        if from.abs_diff(to) >= 20 {
            graph.edges.push(Edge { from, to, ..like });
        }
    }
    let began = Instant::now();
    let outcome = optimise_from_edges(&mut graph, &RobustConfig::default()).unwrap();
    let took = began.elapsed();
    let believed = outcome.weights[first_wrong..].iter().filter(|w| **w > 0.5).count();
    let lost = outcome.weights[..first_wrong].iter().filter(|w| **w < 0.5).count();
    let timed = |pose: &Se2| TimedPose {
        time_s: 0.0,
        place_m: nalgebra::Vector3::new(pose.x_m, pose.y_m, 0.0),
        rotation: nalgebra::UnitQuaternion::identity(),
    };
    let pair = |(result, truth)| PosePair { truth: timed(truth), result: timed(result) };
    let pairs: Vec<PosePair> = graph.poses.iter().zip(right).map(pair).collect();
    println!(
        "{name:16} {:3.0} %: {} wrong added, {believed} believed; {} right, {lost} lost; rms {:.3} m; {:.0} ms, {} rounds",
        100.0 * share,
        graph.edges.len() - first_wrong,
        model.len(),
        ErrorStatistics::of(&absolute_errors(&pairs)).rmse,
        took.as_secs_f64() * 1e3,
        outcome.rounds
    );
}
