//! The 3-D odometry on simulated sweeps of real floor plans, beside other programs. The simulator is a ray caster that shares
//! nothing with this project: its source is compiled here.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufReader, Read as _};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context as _, ensure};
use floorguard_mapping::lidar_odometry::{MotionAid, SweepReturn};
use floorguard_mapping_host::lidar3d::{Mapper3, Mapper3Config, SweepRecord};
use floorguard_mapping_host::metrics::{ErrorStatistics, absolute_errors, associate, read_tum};
use floorguard_types::geometry::Point3;

use super::logs::text;
use crate::data::recording;

/// A drive and what others reached on it.
struct Plan {
    name: &'static str,
    /// Noise of the ranges in metres, seed, people that walk along.
    simulated: [&'static str; 3],
    /// Absolute errors of small_gicp 1.0.1 (scan to model, 0.25 m), kiss-icp 1.3.0 (0.5 m), rko_lio 0.4.0 with IMU, metres.
    peers_m: [f64; 3],
    /// Must not be exceeded, metres.
    limit_m: f64,
}

const PLANS: [Plan; 3] = [
    Plan { name: "fr101", simulated: ["0.015", "1", "0"], peers_m: [0.049, 0.138, 0.040], limit_m: 0.035 },
    Plan { name: "fr101", simulated: ["0.015", "2", "4"], peers_m: [0.046, 0.212, 0.087], limit_m: 0.035 },
    Plan { name: "intel", simulated: ["0.015", "1", "0"], peers_m: [0.304, 0.099, 0.082], limit_m: 0.06 },
];
/// A sweep of the simulator: 1,808 firings of 55.296 µs.
const PERIOD_S: f64 = 1_808.0 * 55.296e-6;

/// Simulates the drives in `folder` (2 GB for the larger one), maps them with one set of values, and prints the table. True
/// if none is beyond its limit, and a constant velocity in place of the returns is beyond all of them. Without the data or a
/// compiler there is nothing to show, and a line says so.
///
/// # Errors
/// A file that cannot be read or written, or a simulator that does not run.
pub fn slam_in_space(folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let folder = folder.canonicalize()?;
    let mut table = String::from(
        "| drive | people | ours, cm | constant velocity, cm | ms a sweep | small_gicp | kiss-icp | rko_lio |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let mut holds = true;
    for plan in &PLANS {
        if !simulate(plan, &folder)? {
            println!("skipped: sim3d or g++ is absent");
            return Ok((table, true));
        }
        let ours = drive(&folder, Mapper3Config::default())?;
        let mut config = Mapper3Config::default();
        config.odometry.align.matched_least = u32::MAX;
        let blind = drive(&folder, config)?;
        holds &= ours.error_m <= plan.limit_m && blind.error_m > 10.0 * plan.limit_m;
        let [_, _, people] = plan.simulated;
        // Writing to a string cannot fail.
        let _ = write!(
            table,
            "| {} | {people} | {:.2} | {:.0} | {:.2} |",
            plan.name,
            100.0 * ours.error_m,
            100.0 * blind.error_m,
            ours.ms_per_sweep
        );
        plan.peers_m.iter().for_each(|peer_m| table += &format!(" {:.1} |", 100.0 * peer_m));
        table.push('\n');
    }
    println!("{table}");
    std::fs::write(folder.join("slam3d.md"), &table)?;
    let _ = std::fs::remove_file(folder.join("sweeps.bin"));
    Ok((table, holds))
}

/// Writes `sweeps.bin` and `sweeps.truth`; false without the data or a compiler.
fn simulate(plan: &Plan, folder: &Path) -> anyhow::Result<bool> {
    let Some(source) = recording("sim3d/simvlp.cpp") else { return Ok(false) };
    let program = folder.join("simvlp");
    let compiled = Command::new("g++").arg("-O2").arg(&source).arg("-o").arg(&program).status();
    if !compiled.is_ok_and(|status| status.success()) {
        return Ok(false);
    }
    for part in ["grid", "traj"] {
        let name = format!("{}.{part}", plan.name);
        let Some(packed) = recording(&format!("sim3d/{name}.gz")) else { return Ok(false) };
        let mut bytes = Vec::new();
        floorguard_host::packing::unpacked(File::open(&packed)?)?.read_to_end(&mut bytes)?;
        std::fs::write(folder.join(name), bytes)?;
    }
    let status = Command::new(&program)
        .current_dir(folder)
        .args([plan.name, "sweeps"])
        .args(plan.simulated)
        .status()?;
    ensure!(status.success(), "the simulator failed");
    Ok(true)
}

struct Driven {
    error_m: f64,
    ms_per_sweep: f64,
}

fn drive(folder: &Path, config: Mapper3Config) -> anyhow::Result<Driven> {
    let truth = read_tum(&truth_as_tum(&text(&folder.join("sweeps.truth"))?))?;
    let mut input = BufReader::new(File::open(folder.join("sweeps.bin"))?);
    // The cloud is not judged: a single cube takes all.
    let mut mapper = Mapper3::new(Mapper3Config { cloud_m: 1.0e4, ..config });
    let mut worked_s = 0.0;
    for pose in &truth {
        let record = SweepRecord {
            end_s: pose.time_s,
            duration_s: PERIOD_S,
            returns: sweep(&mut input)?,
            reflectivity: Vec::new(),
        };
        let began = Instant::now();
        mapper.push(record, &MotionAid::default())?.context("times that do not grow")?;
        worked_s += began.elapsed().as_secs_f64();
    }
    mapper.finish()?;
    let errors = ErrorStatistics::of(&absolute_errors(&associate(&truth, &mapper.trajectory(), 0.01)));
    ensure!(errors.count == truth.len(), "{} of {} sweeps have a pose", errors.count, truth.len());
    Ok(Driven { error_m: errors.rmse, ms_per_sweep: 1.0e3 * worked_s / truth.len() as f64 })
}

/// A count and as many returns of six floats: x, y, z, share of the time, elevation in degrees, label.
fn sweep(input: &mut impl std::io::Read) -> anyhow::Result<Vec<SweepReturn>> {
    let mut count = [0; 4];
    input.read_exact(&mut count)?;
    let mut bytes = vec![0; 24 * u32::from_le_bytes(count) as usize];
    input.read_exact(&mut bytes)?;
    let returns = bytes.chunks_exact(24).map(|cells| {
        let number = |index: usize| f32::from_le_bytes([0, 1, 2, 3].map(|byte| cells[4 * index + byte]));
        let ring = ((number(4) + 15.0) / 2.0).round() as u8;
        SweepReturn::new(Point3::new(number(0), number(1), number(2)), number(3), ring)
    });
    Ok(returns.collect())
}

/// Lines of the pose at the start and at the end of a sweep (time, x, y, yaw, roll, pitch each): the latter as TUM.
fn truth_as_tum(lines: &str) -> String {
    let mut tum = String::new();
    for line in lines.lines() {
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let [.., time_s, x, y, yaw, roll, pitch] = numbers[..] else { continue };
        let [(sy, cy), (sr, cr), (sp, cp)] = [yaw, roll, pitch].map(|angle| (0.5 * angle).sin_cos());
        let quaternion = [
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        ];
        let [qx, qy, qz, qw] = quaternion;
        // Writing to a string cannot fail.
        let _ = writeln!(tum, "{time_s} {x} {y} 0.8 {qx} {qy} {qz} {qw}");
    }
    tum
}
