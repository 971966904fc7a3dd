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
const WALL_MAX_M: f64 = 0.03;
/// How old a scan is when it comes is known to some milliseconds only (20 to 45 ms within the scanner). The command finds it from the
/// drive; ages beyond that are tried to see what is left.
const AGES_S: std::ops::RangeInclusive<i32> = -24..=24;
const AGE_STEP_S: f64 = 0.001;
/// The lidar on the robot, and the limits of its maps in space: drift of the lidar alone as a share of the way, and place with loops
/// closed.
const LIDAR_IN_ROBOT: [f64; 3] = [0.5, 0.0, 0.0];
const DRIFT_MAX: f64 = 0.002;
const CLOSED_MAX_M: f64 = 0.02;
/// Ways of mapping in space.
const ALONE: [&str; 2] = ["--lidar-alone", "--without-loops"];
const CLOSED: [&str; 1] = ["--lidar-alone"];
/// Cells of the map whose walls are measured, metres.
const FINE_CELL: &str = "0.01";

/// What a drive showed.
struct Driven {
    /// Metres.
    path_m: f64,
    /// With the times of the command, and with those that fit best.
    as_mapped: Errors,
    aged: (f64, Errors),
}

#[derive(Clone, Copy)]
struct Errors {
    place: ErrorStatistics,
    heading_rad: f64,
}

/// The maps of a drive.
struct Measured {
    whole: Driven,
    lossy: Driven,
    walls_m: f64,
    /// In space: the lidar alone, with loops closed, with wheels and gyroscope, and alone with losses.
    alone: InSpace,
    closed: InSpace,
    aided: InSpace,
    lossy_alone: InSpace,
}

/// A map in space.
#[derive(Clone, Copy)]
struct InSpace {
    place: ErrorStatistics,
    /// How far off the last pose is when the first one lies on the truth, metres.
    drift_m: f64,
    /// The command says that the map is doubtful.
    is_doubted: bool,
}

/// Drives, maps, and prints the tables. True if no drive is beyond a limit.
///
/// # Errors
/// A file that cannot be read or written, or a drive that cannot be mapped.
pub fn slam_beside_truth(folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let mut flat = String::from(
        "| drive | path, m | place, cm | largest, cm | heading, ° | times still early by, ms | then place, cm | heading, ° | with losses, cm | walls, cm |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut in_space = String::from(
        "| drive, lidar in space | alone, cm | drift at the end, cm | alone with losses, cm | with loops closed, cm | with wheels and gyroscope, cm |\n\
         |---|---|---|---|---|---|\n",
    );
    let mut holds = true;
    for (scenario, seed) in DRIVES {
        let measured = measure(folder, (scenario, seed))?;
        holds &= measured.holds();
        measured.rows(scenario, (&mut flat, &mut in_space));
    }
    let tables = [flat, in_space].join("\n");
    println!("{tables}");
    std::fs::write(folder.join("slam-truth.md"), &tables)?;
    Ok((tables, holds))
}

fn measure(folder: &Path, (scenario, seed): (&str, u64)) -> anyhow::Result<Measured> {
    let whole = drive(folder, (scenario, seed), &[])?;
    let widths_m = wall_widths_m(&mapped(folder, scenario, "-fine", &["--cell-m", FINE_CELL])?)?;
    let alone = space_errors(folder, scenario, &ALONE)?;
    let closed = space_errors(folder, scenario, &CLOSED)?;
    let aided = space_errors(folder, scenario, &[])?;
    let lossy = drive(folder, (scenario, seed), &LOST)?;
    let lossy_alone = space_errors(folder, scenario, &ALONE)?;
    let walls_m = widths_m.iter().sum::<f64>() / widths_m.len().max(1) as f64;
    Ok(Measured { whole, lossy, walls_m, alone, closed, aided, lossy_alone })
}

impl Measured {
    fn holds(&self) -> bool {
        let mapped = self.whole.as_mapped;
        let lost_m = self.lossy.as_mapped.place.rmse - mapped.place.rmse;
        let alone = self.alone;
        let is_near = alone.drift_m <= DRIFT_MAX * self.whole.path_m
            && self.lossy_alone.place.rmse - alone.place.rmse <= LOSS_MAX_M;
        // Of a smooth corridor a lidar alone may doubt its map, and must where it is wrong.
        mapped.place.rmse <= PLACE_MAX_M
            && mapped.heading_rad <= HEADING_MAX_RAD
            && lost_m <= LOSS_MAX_M
            && self.walls_m <= WALL_MAX_M
            && (is_near || alone.is_doubted && self.lossy_alone.is_doubted)
            && (self.closed.place.rmse <= CLOSED_MAX_M || self.closed.is_doubted)
            && self.aided.place.rmse <= CLOSED_MAX_M
            && !self.aided.is_doubted
    }

    fn rows(&self, scenario: &str, (flat, in_space): (&mut String, &mut String)) {
        let (mapped, (age_s, best)) = (self.whole.as_mapped, self.whole.aged);
        let cm = |metres: f64| 100.0 * metres;
        // Writing to a string cannot fail.
        let _ = writeln!(
            flat,
            "| {scenario} | {:.0} | {:.2} | {:.1} | {:.3} | {:.0} | {:.2} | {:.3} | {:.2} | {:.1} |",
            self.whole.path_m,
            cm(mapped.place.rmse),
            cm(mapped.place.most),
            mapped.heading_rad.to_degrees(),
            1.0e3 * age_s,
            cm(best.place.rmse),
            best.heading_rad.to_degrees(),
            cm(self.lossy.as_mapped.place.rmse),
            cm(self.walls_m)
        );
        let shown = |map: &InSpace| {
            format!("{:.2}{}", cm(map.place.rmse), if map.is_doubted { " (doubted)" } else { "" })
        };
        let [alone, lossy, closed, aided] =
            [&self.alone, &self.lossy_alone, &self.closed, &self.aided].map(shown);
        let drift_cm = cm(self.alone.drift_m);
        let _ = writeln!(in_space, "| {scenario} | {alone} | {drift_cm:.1} | {lossy} | {closed} | {aided} |");
    }
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
    let as_mapped = of_age(0.0);
    ensure!(as_mapped.place.count * 100 > result.len() * 99, "poses without a true one");
    let ages = AGES_S.map(|step| f64::from(step) * AGE_STEP_S).map(|age_s| (age_s, of_age(age_s)));
    let aged = ages.min_by(|a, b| a.1.place.rmse.total_cmp(&b.1.place.rmse)).context("no age")?;
    Ok(Driven { path_m, as_mapped, aged })
}

/// Maps the lidar's sweeps in space.
fn space_errors(folder: &Path, scenario: &str, how: &[&str]) -> anyhow::Result<InSpace> {
    let (file, out) = (folder.join(format!("{scenario}.mcap")), folder.join(format!("{scenario}-space")));
    command(&[&["map3d", utf8(&file)?, "--out", utf8(&out)?], how].concat())?;
    let result = read_tum(&text(&out.join("trajectory.tum"))?)?;
    let [x_m, y_m, heading_rad] = LIDAR_IN_ROBOT;
    let lidar = Se2::new(x_m, y_m, heading_rad);
    let truth: Vec<(f64, Se2)> =
        true_poses(&file)?.into_iter().map(|(time_s, robot)| (time_s, robot.compose(lidar))).collect();
    let pairs = pairs(&truth, &result, 0.0);
    ensure!(pairs.len() * 100 > result.len() * 99, "poses without a true one");
    let (first, last) = pairs.first().zip(pairs.last()).context("no pose")?;
    let motion = |of: fn(&PosePair) -> Se2| of(first).between(of(last));
    let (true_motion, own_motion) = (motion(|pair| pair.truth.flat()), motion(|pair| pair.result.flat()));
    let summary: serde_json::Value = serde_json::from_str(&text(&out.join("map3d.json"))?)?;
    Ok(InSpace {
        place: ErrorStatistics::of(&absolute_errors(&pairs)),
        drift_m: true_motion.distance(own_motion),
        is_doubted: summary["verdict"] == "doubtful",
    })
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

/// Each pose beside the true one of its time, of scans that are younger by `age_s` than their times say.
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
