//! Wrong loops among the right ones of published graphs.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::Path;

use super::*;
use crate::pose_graph::{OptimiseConfig, Optimised, optimise, read_g2o};

fn published(name: &str) -> Option<Graph> {
    let path = format!("../../../shared/data/posegraphs/{name}.g2o.gz");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let Ok(file) = File::open(path) else {
        let _ = writeln!(std::io::stderr(), "skipped: posegraphs/{name}.g2o.gz is absent");
        return None;
    };
    let mut text = String::new();
    flate2::read::MultiGzDecoder::new(file).read_to_string(&mut text).unwrap();
    Some(read_g2o(&text).unwrap())
}

/// As many wrong loops as half of the right ones, between poses drawn at random (Knuth's generator): none is believed, no
/// right one is lost, and the error is that of the clean graph, which is published with it.
#[test]
fn wrong_loops_change_nothing() {
    for (name, chi2) in [("intel_vertigo", 546.461), ("ring", 11.163), ("intel", 45.005)] {
        let Some(clean) = published(name) else { continue };
        let loops: Vec<Edge> =
            clean.edges.iter().filter(|edge| edge.kind == EdgeKind::Loop).copied().collect();
        let (mut graph, mut state) = (clean.clone(), 7_u64);
        let mut below = |count: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % count
        };
        for _ in 0..loops.len() / 2 {
            let (from, to) = (below(clean.poses.len()), below(clean.poses.len()));
            let like = loops[below(loops.len())];
            if from.abs_diff(to) >= 20 {
                graph.edges.push(Edge { from, to, ..like });
            }
        }
        let outcome = optimise_from_edges(&mut graph, &RobustConfig::default()).unwrap();
        let (right, wrong) = outcome.weights.split_at(clean.edges.len());
        assert!(wrong.len() > loops.len() / 3 && wrong.iter().all(|weight| *weight == 0.0), "{name}");
        assert!(right.iter().all(|weight| *weight == 1.0), "{name}");
        assert!((outcome.optimised.chi2 - chi2).abs() < 1.0e-3 * chi2, "{name}: {:?}", outcome.optimised);
        // Without the judgement the wrong ones bend the graph.
        let Optimised { chi2: bent, .. } = optimise(&mut graph, &[], &OptimiseConfig::default()).unwrap();
        assert!(bent > 100.0 * chi2, "{name}: {bent}");
    }
}
