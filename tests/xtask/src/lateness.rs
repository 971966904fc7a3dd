//! `cargo xtask lateness`: how late the guard ring answers its timers, alone and watched by everybody at once.
//!
//! In turn a robot in real time that only records and has its panel, and the same robot with the bridge to ROS 2 and Foxglove: four
//! programs read everything over DDS and one reads nothing, one watches by Foxglove's protocol and one asks as the panel's page
//! does. The simulated world takes the cores of the same computer; the watchers have one of them.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use anyhow::{Context as _, Result, ensure};
use clap::Args;

use crate::{check_ros2, shell};

/// Programs that read everything over DDS.
const READERS: usize = 4;
/// Largest lateness of 99.9 % of the timers, milliseconds.
const LATE_MAX_MS: f64 = 1.0;
/// Watchers begin so long after the robot, and end so long before it, seconds: who ends has read something, or says that it has not.
const WATCH_FROM_S: u32 = 2;
const WATCH_ENDS_S: u32 = 6;
/// What the program prints before its figures.
const MARK: &str = "guard ring: ";
const PANEL: &str = "127.0.0.1:18080";
const FOXGLOVE: &str = "127.0.0.1:18765";

/// How long, and how often.
#[derive(Args)]
pub struct Options {
    /// Seconds of a run, in real time.
    #[arg(long, default_value_t = 45, value_parser = clap::value_parser!(u32).range(20..))]
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
    let watched_s = options.duration.saturating_sub(WATCH_FROM_S + WATCH_ENDS_S).to_string();
    let watchers = if is_watched { watch(python, &domain, &watched_s)? } else { Vec::new() };
    let printed = robot.wait_with_output()?;
    for (what, mut watcher) in watchers {
        // One that still waits has found no robot.
        let has_read = watcher.try_wait()?.is_some_and(|status| status.success());
        watcher.kill()?;
        watcher.wait()?;
        ensure!(
            has_read,
            "the watcher `{what}` has read nothing: the figures would be those of a robot without it"
        );
    }
    let printed = String::from_utf8_lossy(&printed.stderr);
    read(&printed)
        .with_context(|| format!("no figures of the guard ring in what the robot printed:\n{printed}"))
}

fn recording() -> PathBuf {
    shell::target_folder().join("check-ros2/lateness.mcap")
}

/// All who watch for so long, with their names.
fn watch(python: &Path, domain: &str, seconds: &str) -> Result<Vec<(&'static str, Child)>> {
    // The sockets are there before the robot's devices are.
    std::thread::sleep(Duration::from_secs(WATCH_FROM_S.into()));
    let folder = check_ros2::folder();
    let readers = (0..READERS).map(|_| ("reader", "cyclone.py", [domain, "--read", seconds]));
    let others = [
        ("stalled reader", "cyclone.py", [domain, "--stall", seconds]),
        ("Foxglove", "watchers.py", ["foxglove", FOXGLOVE, seconds]),
        ("panel", "watchers.py", ["panel", PANEL, seconds]),
    ];
    let started = readers.chain(others).map(|(what, script, arguments)| {
        // On a robot they have other computers: here they have one core of those that there are.
        let mut watcher = Command::new("taskset");
        watcher.args(["--cpu-list", "0"]).arg(python).arg(folder.join(script)).args(arguments);
        Ok((what, watcher.stdout(Stdio::null()).spawn()?))
    });
    started.collect::<std::io::Result<_>>().context("cannot start a watcher")
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
