//! Optimises the published pose graphs.
use std::io::Read;

use floorguard_mapping_host::pose_graph::*;

/// Processor time of this thread, seconds.
fn cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1e-9
}

/// Adds wrong loops: random pairs, with the measured pose of a random right loop.
fn with_wrong(graph: &Graph, share: f64) -> (Graph, usize) {
    let mut state = 12345_u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % n
    };
    let mut wrong = graph.clone();
    let loops: Vec<Edge> = graph.edges.iter().filter(|e| e.kind == EdgeKind::Loop).copied().collect();
    let count = (loops.len() as f64 * share) as usize;
    for _ in 0..count {
        let like = loops[random(loops.len())];
        let (a, b) = (random(graph.poses.len()), random(graph.poses.len()));
        if a.abs_diff(b) > 1 {
            wrong.edges.push(Edge { from: a.min(b), to: a.max(b), ..like });
        }
    }
    (wrong, graph.edges.len())
}

fn main() {
    let want = [("intel", 45.005), ("intel_vertigo", 546.461), ("manhattan_olson", 146.077), ("manhattan", 3900.94),
        ("city10000", 511.985), ("ring", 11.163), ("kitti_00", 98.322), ("ais2klinik", 172.816)];
    for (name, optimum) in want {
        if std::env::args().nth(1).is_some_and(|n| n != name) { continue; }
        let file = std::fs::File::open(format!("../shared/data/posegraphs/{name}.g2o.gz")).unwrap();
        let mut text = String::new();
        flate2::read::MultiGzDecoder::new(file).read_to_string(&mut text).unwrap();
        let read = read_g2o(&text).unwrap();
        let mut graph = read.clone();
        let t = cpu_s();
        graph.poses = chain_start(&graph);
        let at_start = graph.chi2();
        let result = optimise(&mut graph, &[], &OptimiseConfig { steps_max: 100, share_least: 1e-6 });
        let chain = cpu_s() - t;
        let mut linear = read.clone();
        let t = cpu_s();
        linear.poses = orientation_start(&linear, &[]).unwrap();
        let linear_start = linear.chi2();
        let result2 = optimise(&mut linear, &[], &OptimiseConfig { steps_max: 100, share_least: 1e-6 });
        let lin = cpu_s() - t;
        if !name.starts_with("ais") {
            for share in [0.1, 0.3, 0.5] {
                let (mut wrong, right) = with_wrong(&read, share);
                let t = cpu_s();
                let result = optimise_along_path(&mut wrong, &RobustConfig::default()).unwrap();
                let took = cpu_s() - t;
                let kept_wrong = result.weights[right..].iter().filter(|w| **w > 0.5).count();
                let lost_right = result.weights[..right].iter().filter(|w| **w < 0.5).count();
                let mut clean = Graph { poses: wrong.poses.clone(), edges: read.edges.clone() };
                let chi2 = clean.chi2();
                let away = clean.poses.iter().zip(&graph.poses).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
                let _ = &mut clean;
                println!("   {name} wrong {share}: added {} kept wrong {kept_wrong} lost right {lost_right} chi2 {chi2:.3} farthest {away:.3} m rounds {} {:.0} ms",
                    wrong.edges.len() - right, result.rounds, took * 1e3);
            }
        }
        println!("{name} want {optimum}: chain {at_start:.3e} -> {:?} {:.1} ms; linear {linear_start:.3} -> {:?} {:.1} ms", result.map(|r| (r.chi2, r.steps)), chain*1e3,
            result2.map(|r| (r.chi2, r.steps)), lin*1e3);
    }
}
