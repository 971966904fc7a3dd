//! Optimises the published pose graphs.
use std::io::Read;
use std::time::Instant;

use floorguard_mapping_host::pose_graph::*;

fn main() {
    let want = [
        ("intel", 45.005),
        ("intel_vertigo", 546.461),
        ("manhattan_olson", 146.077),
        ("manhattan", 3900.94),
        ("city10000", 511.985),
        ("ring", 11.163),
        ("kitti_00", 98.322),
        ("ais2klinik", 172.816),
    ];
    for (name, optimum) in want {
        let file = std::fs::File::open(format!("../shared/data/posegraphs/{name}.g2o.gz")).unwrap();
        let mut text = String::new();
        flate2::read::MultiGzDecoder::new(file).read_to_string(&mut text).unwrap();
        let read = read_g2o(&text).unwrap();
        let mut graph = read.clone();
        let t = Instant::now();
        graph.poses = chain_start(&graph);
        let at_start = graph.chi2();
        let result = optimise(&mut graph, &[], &OptimiseConfig { steps_max: 100, share_least: 1e-6 });
        let chain = t.elapsed();
        let mut linear = read.clone();
        let t = Instant::now();
        linear.poses = orientation_start(&linear, &[]).unwrap();
        let linear_start = linear.chi2();
        let result2 = optimise(&mut linear, &[], &OptimiseConfig { steps_max: 100, share_least: 1e-6 });
        let lin = t.elapsed();
        println!(
            "{name} want {optimum}: chain {at_start:.3e} -> {:?} {:.1} ms; linear {linear_start:.3} -> {:?} {:.1} ms",
            result.map(|r| (r.chi2, r.steps)),
            chain.as_secs_f64() * 1e3,
            result2.map(|r| (r.chi2, r.steps)),
            lin.as_secs_f64() * 1e3
        );
    }
}
