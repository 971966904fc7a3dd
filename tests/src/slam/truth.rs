//! Drives of the simulated robot among people, mapped from their recordings by our command, against the true poses that the
//! recordings hold: with every message, and with one of a hundred lost.

use std::fmt::Write as _;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use anyhow::{Context as _, ensure};
use clap::Parser as _;
use floorguard_app::commands::{Arguments, VerdictFailed, dispatch};
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::metrics::{ErrorStatistics, PosePair, TimedPose, absolute_errors, read_tum};
use floorguard_recording::Recording;
use floorguard_recording::decode::odometry;
use floorguard_recording::truth::TRUE_ODOMETRY;

use nalgebra::{UnitQuaternion, Vector3};

use super::logs::text;
use super::walls::wall_widths_m;

/// Scenarios, each with people, and its seed.
const DRIVES: [(&str, u64); 5] =
    [("supermarket", 3), ("busy-supermarket", 3), ("warehouse", 3), ("airport", 3), ("corridor", 3)];
/// Simulated seconds.
const DURATION_S: u64 = 180;
/// What is lost in the second run of each drive.
const LOST: [&str; 6] = ["--fault", "scanner:drop=1%", "--fault", "imu:drop=1%", "--fault", "lidar:drop=1%"];
/// Limits: root mean squares of place and heading, and how much farther off a place may be with losses.
const PLACE_MAX_M: f64 = 0.015;
const HEADING_MAX_RAD: f64 = 0.1 / 180.0 * std::f64::consts::PI;
const LOSS_MAX_M: f64 = 0.01;
/// How old a scan is when it comes is known to some milliseconds only (20 to 45 ms within the scanner): ages that are tried.
const AGES_S: std::ops::RangeInclusive<i32> = -12..=12;
const AGE_STEP_S: f64 = 0.002;
/// Cells of the map whose walls are measured, metres.
const FINE_CELL: &str = "0.01";

/// What a drive showed.
struct Driven {
    /// Metres.
    path_m: f64,
    /// With the stamps as they are, and with the age of the scans that fits best.
    stamped: Errors,
    aged: (f64, Errors),
}

#[derive(Clone, Copy)]
struct Errors {
    place: ErrorStatistics,
    heading_rad: f64,
}

/// Drives, maps, and prints the table. True if no drive is beyond a limit.
///
/// # Errors
/// A file that cannot be read or written, or a drive that cannot be mapped.
pub fn slam_beside_truth(folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let mut table = String::from(
        "| drive | path, m | place, cm | largest, cm | heading, ° | scans older by, ms | then place, cm | heading, ° | with losses, cm | walls, cm |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut holds = true;
    for (scenario, seed) in DRIVES {
        let whole = drive(folder, (scenario, seed), &[])?;
        let widths_m = wall_widths_m(&mapped(folder, scenario, "-fine", &["--cell-m", FINE_CELL])?)?;
        let lossy = drive(folder, (scenario, seed), &LOST)?;
        let (age_s, best) = whole.aged;
        let wall_m = widths_m.iter().sum::<f64>() / widths_m.len().max(1) as f64;
        holds &= best.place.rmse <= PLACE_MAX_M
            && best.heading_rad <= HEADING_MAX_RAD
            && lossy.aged.1.place.rmse - best.place.rmse <= LOSS_MAX_M;
        // Writing to a string cannot fail.
        let _ = writeln!(
            table,
            "| {scenario} | {:.0} | {:.2} | {:.1} | {:.3} | {:.0} | {:.2} | {:.3} | {:.2} | {:.1} |",
            whole.path_m,
            100.0 * whole.stamped.place.rmse,
            100.0 * whole.stamped.place.most,
            whole.stamped.heading_rad.to_degrees(),
            1.0e3 * age_s,
            100.0 * best.place.rmse,
            best.heading_rad.to_degrees(),
            100.0 * lossy.aged.1.place.rmse,
            100.0 * wall_m
        );
    }
    println!("{table}");
    std::fs::write(folder.join("slam-truth.md"), &table)?;
    Ok((table, holds))
}

/// Runs the program's own command; a verdict that is not good is no error here.
fn command(words: &[&str]) -> anyhow::Result<()> {
    let arguments = Arguments::try_parse_from([&["floorguard"], words].concat())?;
    match dispatch(arguments) {
        Err(error) if !error.is::<VerdictFailed>() => Err(error),
        _ => Ok(()),
    }
}

fn utf8(path: &Path) -> anyhow::Result<&str> {
    path.to_str().context("a folder whose name is no text")
}

/// Maps the recording of a scenario; the folder of the map.
fn mapped(folder: &Path, scenario: &str, kind: &str, more: &[&str]) -> anyhow::Result<std::path::PathBuf> {
    let (file, out) = (folder.join(format!("{scenario}.mcap")), folder.join(format!("{scenario}{kind}")));
    command(&[&["map", utf8(&file)?, "--out", utf8(&out)?], more].concat())?;
    Ok(out)
}

fn drive(folder: &Path, (scenario, seed): (&str, u64), faults: &[&str]) -> anyhow::Result<Driven> {
    let file = folder.join(format!("{scenario}.mcap"));
    let (seed, duration) = (seed.to_string(), DURATION_S.to_string());
    let words = ["simulate", "--scenario", scenario, "--seed", &seed, "--duration", &duration, "--json"];
    let words = words.into_iter().chain(["--record", utf8(&file)?]).chain(faults.iter().copied());
    command(&words.collect::<Vec<_>>())?;
    let out = mapped(folder, scenario, "", &[])?;
    let result = read_tum(&text(&out.join("trajectory.tum"))?)?;
    let truth = true_poses(&file)?;
    let path_m = truth.windows(2).map(|pair| pair[0].1.distance(pair[1].1)).sum();
    let of_age = |age_s: f64| errors(&pairs(&truth, &result, age_s));
    let stamped = of_age(0.0);
    ensure!(stamped.place.count * 100 > result.len() * 99, "poses without a true one");
    let ages = AGES_S.map(|step| f64::from(step) * AGE_STEP_S).map(|age_s| (age_s, of_age(age_s)));
    let aged = ages.min_by(|a, b| a.1.place.rmse.total_cmp(&b.1.place.rmse)).context("no age")?;
    Ok(Driven { path_m, stamped, aged })
}

/// The robot as the simulator had it, over time.
fn true_poses(file: &Path) -> anyhow::Result<Vec<(f64, Se2)>> {
    let mut poses = Vec::new();
    for message in Recording::new(BufReader::new(File::open(file)?)) {
        let message = message?;
        if &*message.topic == TRUE_ODOMETRY {
            let truth = odometry(&message.data).context("a damaged true pose")?;
            poses.push((truth.header.stamp.as_micros() as f64 * 1.0e-6, Se2::from(truth.pose)));
        }
    }
    Ok(poses)
}

/// Each pose beside the true one of its time, of scans that are younger by `age_s` than their stamps say.
fn pairs(truth: &[(f64, Se2)], result: &[TimedPose], age_s: f64) -> Vec<PosePair> {
    let pair = |pose: &TimedPose| {
        let time_s = pose.time_s + age_s;
        let after = truth.partition_point(|(other_s, _)| *other_s < time_s);
        let ((from_s, from), (to_s, to)) = (truth.get(after.checked_sub(1)?)?, truth.get(after)?);
        let share = (time_s - from_s) / (to_s - from_s);
        let place = from.compose(from.between(*to).scaled(share));
        Some(PosePair { truth: on_floor(time_s, place), result: *pose })
    };
    result.iter().filter_map(pair).collect()
}

fn on_floor(time_s: f64, pose: Se2) -> TimedPose {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), pose.heading_rad);
    TimedPose { time_s, place_m: Vector3::new(pose.x_m, pose.y_m, 0.0), rotation }
}

/// After the best rigid motion.
fn errors(pairs: &[PosePair]) -> Errors {
    let mut turns: Vec<f64> = pairs
        .iter()
        .map(|pair| {
            Se2::new(0.0, 0.0, pair.result.flat().heading_rad - pair.truth.flat().heading_rad).heading_rad
        })
        .collect();
    turns.sort_by(f64::total_cmp);
    let middle = turns.get(turns.len() / 2).copied().unwrap_or(0.0);
    let square: f64 = turns.iter().map(|turn| (turn - middle) * (turn - middle)).sum();
    Errors {
        place: ErrorStatistics::of(&absolute_errors(pairs)),
        heading_rad: (square / turns.len().max(1) as f64).sqrt(),
    }
}
