//! Prints how long each stage of the lidar path takes: `cargo xtask bench`.

use std::path::Path;
use std::process::ExitCode;

use floorguard_tests::bench::{DECISION_MAX_NS, cleaning, navigation, ours, run};

/// Without arguments, times of the stages; fails where the guard decides too late. With `--peers FOLDER`, the inputs of
/// the peers go there, and our times are printed as JSON, one object a line; with TASK only those of one. With `--navigation`, times
/// of planning.
fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [] => stages(),
        [option] if option == "--navigation" => planning(),
        [option, folder] if option == "--peers" => peers(Path::new(folder), None),
        [option, folder, task] if option == "--peers" => peers(Path::new(folder), Some(task)),
        _ => {
            eprintln!("usage: floorguard-bench [--navigation | --peers FOLDER [TASK]]");
            ExitCode::from(2)
        }
    }
}

fn planning() -> ExitCode {
    println!("{:22} {:28} {:>10}  note", "task", "input", "ms");
    for row in navigation() {
        println!("{:22} {:28} {:10.3}  {}", row.task, row.input, row.ms, row.note);
    }
    println!(
        "computing time of one thread, the fastest round; other programs at work still cost caches and memory"
    );
    ExitCode::SUCCESS
}

fn peers(folder: &Path, task: Option<&str>) -> ExitCode {
    match ours(folder, task) {
        Ok(times) => {
            for time in times {
                let row = serde_json::json!({
                    "task": time.task, "peer": "floorguard", "input": time.input, "note": time.note,
                    "ns": time.median.wall_ns, "fastest_ns": time.fastest.wall_ns,
                    "cpu_ns": time.median.cpu_ns, "fastest_cpu_ns": time.fastest.cpu_ns,
                });
                println!("{row}");
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(3)
        }
    }
}

fn stages() -> ExitCode {
    let measured = run();
    println!("{:24} {:22} {:>12} {:>10}", "input", "stage", "ns / sweep", "ns / point");
    let mut in_time = true;
    for input in &measured {
        for row in &input.stages {
            println!("{:24} {:22} {:12.0} {:10.2}", row.input, row.stage, row.ns_per_sweep, row.ns_per_point);
        }
        let decisions = &input.decisions;
        let verdict = if decisions.is_in_time() { "in time" } else { "TOO LATE" };
        println!(
            "{:24} guard, one packet: median {:.0} ns, the slowest packet {:.0} ns, allowed {DECISION_MAX_NS:.0} ns: {verdict}",
            input.input, decisions.median_ns, decisions.worst_ns
        );
        in_time &= decisions.is_in_time();
    }
    println!();
    for line in cleaning::run() {
        println!("{:46} {:36} {}", line.stage, line.value, line.beside);
    }
    println!();
    println!("{:24} {:28} {:>12} {:>10}", "input", "stage", "ms / frame", "fastest");
    for row in floorguard_tests::bench::run_floor() {
        println!(
            "{:24} {:28} {:12.2} {:10.2}",
            row.input,
            row.stage,
            1e-6 * row.median.wall_ns,
            1e-6 * row.fastest.wall_ns
        );
    }
    println!("medians on this machine, one core; quote ratios measured in one run, not these absolutes");
    if in_time { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
