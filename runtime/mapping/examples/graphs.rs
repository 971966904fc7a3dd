//! Optimises the published pose graphs from the edges alone and prints the processor time, the least of five runs.
use std::io::Read;

use floorguard_mapping_host::pose_graph::*;

/// Processor time of this thread, seconds.
fn cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1e-9
}

fn solved(read: &Graph, start: fn(&Graph) -> Vec<floorguard_mapping_host::Se2>) -> (Optimised, f64) {
    let mut least_s = f64::INFINITY;
    let mut last = None;
    for _ in 0..5 {
        let mut graph = read.clone();
        let began = cpu_s();
        graph.poses = start(&graph);
        last =
            Some(optimise(&mut graph, &[], &OptimiseConfig { steps_max: 100, share_least: 1e-6 }).unwrap());
        least_s = least_s.min(cpu_s() - began);
    }
    (last.unwrap(), least_s)
}

fn main() {
    let published = [
        ("intel", 45.005),
        ("intel_vertigo", 546.461),
        ("manhattan_olson", 146.077),
        ("manhattan", 3900.94),
        ("city10000", 511.985),
        ("ring", 11.163),
        ("kitti_00", 98.322),
        ("ais2klinik", 172.816),
    ];
    for (name, optimum) in published {
        let file = std::fs::File::open(format!("../shared/data/posegraphs/{name}.g2o.gz")).unwrap();
        let mut text = String::new();
        flate2::read::MultiGzDecoder::new(file).read_to_string(&mut text).unwrap();
        let read = read_g2o(&text).unwrap();
        let (chain, chain_s) = solved(&read, chain_start);
        let (linear, linear_s) = solved(&read, |graph| orientation_start(graph, &[]).unwrap());
        println!(
            "{name:16} published {optimum:9.3}  chain {:12.4} {:3} steps {:7.1} ms  linear {:12.4} {:3} steps {:7.1} ms",
            chain.chi2,
            chain.steps,
            1e3 * chain_s,
            linear.chi2,
            linear.steps,
            1e3 * linear_s
        );
    }
}
