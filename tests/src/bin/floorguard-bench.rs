//! Prints how long each stage of the lidar path takes: `cargo xtask bench`.

use floorguard_tests::bench;

fn main() {
    let rows = bench::run();
    println!("{:24} {:28} {:>12} {:>10}", "input", "stage", "us / sweep", "ns / point");
    for row in &rows {
        println!(
            "{:24} {:28} {:12.1} {:10.2}",
            row.input,
            row.stage,
            row.ns_per_sweep / 1e3,
            row.ns_per_point
        );
    }
    println!("medians on this machine, one core; quote ratios measured in one run, not these absolutes");
}
