//! `cargo xtask lateness`: how late the guard ring answers its timers, alone and watched by everybody at once.
//!
//! In turn a robot in real time that only records and has its panel, and the same robot with the bridge to ROS 2 and Foxglove: four
//! programs read everything over DDS and one reads nothing, one watches by Foxglove's protocol and one asks as the panel's page
//! does. The simulated world takes the cores of the same computer; the watchers have one of them.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use anyhow::{Context as _, Result, ensure};
use clap::Args;

use crate::{check_ros2, shell};

/// Programs that read everything over DDS.
const READERS: usize = 4;
/// Largest lateness of 99.9 % of the timers, milliseconds.
const LATE_MAX_MS: f64 = 1.0;
/// What the program prints before its figures.
const MARK: &str = "guard ring: ";
const PANEL: &str = "127.0.0.1:18080";
const FOXGLOVE: &str = "127.0.0.1:18765";

/// How long, and how often.
#[derive(Args)]
pub struct Options {
    /// Seconds of a run, in real time.
    #[arg(long, default_value_t = 45)]
    duration: u32,
    /// Runs of each kind.
    #[arg(long, default_value_t = 3)]
    runs: u32,
    /// Seed of all randomness.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Figures of a run, milliseconds, and the number of its timers.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Late {
    median_ms: f64,
    permille_999_ms: f64,
    longest_ms: f64,
    timers: u64,
}

/// Builds, installs and plays. True if 99.9 % of the timers are answered in time in the median of the watched runs.
pub fn run(options: &Options) -> Result<bool> {
    let work = shell::target_folder().join("check-ros2");
    std::fs::create_dir_all(&work)?;
    let python = check_ros2::environment(&work, false).map_err(|why| anyhow::anyhow!("lateness: {why}"))?;
    let robot = check_ros2::program("floorguard/ros2,floorguard/foxglove")?;
    let mut found = [Vec::new(), Vec::new()];
    for run in 0..options.runs {
        for (is_watched, found) in [false, true].into_iter().zip(&mut found) {
            let late = play((&robot, &python), options, is_watched)?;
            let kind = if is_watched { "watched" } else { "alone  " };
            println!(
                "run {} {kind}: {:.2} ms late in the middle, {:.2} ms in 99.9 % of {} timers, {:.2} ms at most",
                run + 1,
                late.median_ms,
                late.permille_999_ms,
                late.timers,
                late.longest_ms
            );
            found.push(late.permille_999_ms);
        }
    }
    let [alone_ms, watched_ms] = found.map(median);
    println!(
        "99.9 % of the timers, median of {} runs: alone {alone_ms:.2} ms, watched {watched_ms:.2} ms, allowed {LATE_MAX_MS} ms",
        options.runs
    );
    Ok(watched_ms <= LATE_MAX_MS)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::INFINITY)
}

fn play((robot, python): (&Path, &Path), options: &Options, is_watched: bool) -> Result<Late> {
    let seconds = options.duration.to_string();
    let domain = check_ros2::domain().to_string();
    let mut command = Command::new(robot);
    command.args([
        "simulate",
        "--scenario",
        "supermarket",
        "--real-io",
        "--panel",
        PANEL,
        "--duration",
        &seconds,
    ]);
    command.args(["--seed", &options.seed.to_string(), "--record"]).arg(recording());
    if is_watched {
        command.arg(format!("--ros2={domain}")).args(["--foxglove", FOXGLOVE]);
    }
    let robot = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
    let robot = robot.context("cannot start the robot's program")?;
    let watchers = if is_watched { watch(python, &domain, &seconds)? } else { Vec::new() };
    let printed = robot.wait_with_output()?;
    for mut watcher in watchers {
        // What is still there waits for a robot that has ended.
        watcher.kill()?;
        watcher.wait()?;
    }
    let printed = String::from_utf8_lossy(&printed.stderr);
    read(&printed)
        .with_context(|| format!("no figures of the guard ring in what the robot printed:\n{printed}"))
}

fn recording() -> PathBuf {
    shell::target_folder().join("check-ros2/lateness.mcap")
}

/// All who watch; they wait for the robot by themselves.
fn watch(python: &Path, domain: &str, seconds: &str) -> Result<Vec<Child>> {
    // The sockets are there before the robot's devices are.
    std::thread::sleep(std::time::Duration::from_secs(2));
    let folder = check_ros2::folder();
    let readers = (0..READERS).map(|_| ("cyclone.py", [domain, "--read", seconds]));
    let others = [
        ("cyclone.py", [domain, "--stall", seconds]),
        ("watchers.py", ["foxglove", FOXGLOVE, seconds]),
        ("watchers.py", ["panel", PANEL, seconds]),
    ];
    let started = readers.chain(others).map(|(script, arguments)| {
        // On a robot they have other computers: here they have one core of those that there are.
        let mut watcher = Command::new("taskset");
        watcher.args(["--cpu-list", "0"]).arg(python).arg(folder.join(script)).args(arguments);
        watcher.stdout(Stdio::null()).spawn()
    });
    let started: Vec<Child> = started.collect::<Result<_, _>>().context("cannot start a watcher")?;
    ensure!(started.len() == READERS + 3, "not all watchers started");
    Ok(started)
}

/// The figures in the program's line `guard ring: … ms late in the middle, … ms in 99.9 % of … timers, … ms at most`.
fn read(printed: &str) -> Option<Late> {
    let line = printed.lines().filter_map(|line| line.split_once(MARK)).map(|(_, rest)| rest).next_back()?;
    let before = |mark: &str| line.split_once(mark)?.0.rsplit(' ').next();
    Some(Late {
        median_ms: before(" ms late in the middle")?.parse().ok()?,
        permille_999_ms: before(" ms in 99.9 %")?.parse().ok()?,
        timers: before(" timers")?.parse().ok()?,
        longest_ms: before(" ms at most")?.parse().ok()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_read_from_the_last_line() {
        let printed = "  guard ring: real-time priority 40\n  guard ring: 0.10 ms late in the middle, 0.62 ms in 99.9 % of 2004 \
                       timers, 11.34 ms at most\nverdict: good\n";
        let late = Late { median_ms: 0.1, permille_999_ms: 0.62, longest_ms: 11.34, timers: 2_004 };
        assert_eq!(read(printed), Some(late));
        assert_eq!(read("guard ring: real-time priority 40"), None);
    }
}
