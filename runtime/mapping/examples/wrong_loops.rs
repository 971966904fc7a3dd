//! Adds wrong loops to published pose graphs and counts how many are believed.

use std::io::Read;
use std::time::Instant;

use floorguard_mapping_host::Se2;
use floorguard_mapping_host::metrics::{ErrorStatistics, PosePair, TimedPose, absolute_errors};
use floorguard_mapping_host::pose_graph::*;

/// A linear congruential generator (Knuth's constants), 0 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn main() {
    let names: Vec<String> = std::env::args().skip(1).collect();
    for name in ["intel", "intel_vertigo", "manhattan_olson", "ring", "manhattan", "city10000"] {
        if !names.is_empty() && !names.iter().any(|n| n == name) {
            continue;
        }
        let path = format!("../shared/data/posegraphs/{name}.g2o.gz");
        let mut text = String::new();
        flate2::read::MultiGzDecoder::new(std::fs::File::open(path).unwrap())
            .read_to_string(&mut text)
            .unwrap();
        let clean = read_g2o(&text).unwrap();
        let mut right = clean.clone();
        right.poses = orientation_start(&right, &[]).unwrap();
        optimise(&mut right, &[], &OptimiseConfig::default()).unwrap();
        let loops = clean.edges.iter().filter(|e| e.kind == EdgeKind::Loop).count();
        for share in [0.0, 0.1, 0.3, 0.5] {
            let mut graph = clean.clone();
            let mut random = Random(7);
            let wrong = (share * loops as f64) as usize;
            let first_wrong = graph.edges.len();
            let model: Vec<Edge> = clean.edges.iter().filter(|e| e.kind == EdgeKind::Loop).copied().collect();
            let count = graph.poses.len();
            for _ in 0..wrong {
                let mut pick = || (random.next() * count as f64) as usize % count;
                let (from, to) = (pick(), pick());
                if from.abs_diff(to) < 20 {
                    continue;
                }
                let like = model[(random.next() * model.len() as f64) as usize % model.len()];
                graph.edges.push(Edge { from, to, ..like });
            }
            let added = graph.edges.len() - first_wrong;
            let t = Instant::now();
            let outcome = if std::env::var("PLAIN").is_ok() {
                graph.poses = orientation_start(&graph, &[]).unwrap();
                optimise_robustly(&mut graph, &RobustConfig::default()).unwrap()
            } else {
                optimise_from_edges(&mut graph, &RobustConfig::default()).unwrap()
            };
            let took = t.elapsed();
            let believed = outcome.weights[first_wrong..].iter().filter(|w| **w > 0.5).count();
            let lost = graph.edges[..first_wrong]
                .iter()
                .zip(&outcome.weights)
                .filter(|(e, w)| e.kind == EdgeKind::Loop && **w < 0.5)
                .count();
            let timed = |pose: &Se2| TimedPose {
                time_s: 0.0,
                place_m: nalgebra::Vector3::new(pose.x_m, pose.y_m, 0.0),
                rotation: nalgebra::UnitQuaternion::identity(),
            };
            let pairs: Vec<PosePair> = graph
                .poses
                .iter()
                .zip(&right.poses)
                .map(|(a, b)| PosePair { truth: timed(b), result: timed(a) })
                .collect();
            let away = ErrorStatistics::of(&absolute_errors(&pairs)).rmse;
            let extent = right.poses.iter().map(|p| p.distance(Se2::default())).fold(0.0, f64::max);
            println!(
                "{name:16} {:3.0} %: added {added} believed {believed}, right {loops} lost {lost}, rms {:.3} of {extent:.0} m, {:.0} ms, {} rounds",
                100.0 * share,
                away,
                took.as_secs_f64() * 1e3,
                outcome.rounds
            );
        }
    }
}
