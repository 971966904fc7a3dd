//! `floorguard eval ground`: the floor in a point cloud.

use std::io::{BufWriter, Write as _};
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::cloud_file;
use super::find::{Ground, ground};
use super::truth::{Agreement, compare};
use crate::recordings::arguments::{Tilt, tilt};
use crate::recordings::replay::Point;
use floorguard_host::outcome::BadInput;

/// Which cloud.
#[derive(Clone, Debug, Args)]
pub struct GroundArguments {
    /// One turn of a lidar of any number of rings: PLY, PCD, or KITTI's .bin; packed or not.
    pub file: PathBuf,
    /// How the lidar is tilted, roll and pitch in degrees, where that is more than some ten degrees.
    #[arg(long, value_name = "ROLL,PITCH", allow_hyphen_values = true, value_parser = tilt, default_value = "0,0")]
    pub tilt: Tilt,
    /// What others say is floor: SemanticKITTI's labels, or one bit a point, highest first.
    #[arg(long)]
    pub truth: Option<PathBuf>,
    /// Write the cloud as PLY, the floor green and the rest grey.
    #[arg(long, value_name = "FILE.ply")]
    pub out: Option<PathBuf>,
}

/// What was found.
#[derive(Debug, Serialize)]
struct Report {
    points: usize,
    floor_points: usize,
    /// Of the sensor above the floor.
    height_m: f32,
    /// Unit normal of the floor, upwards, in the frame of the cloud.
    normal: [f32; 3],
    /// Between that normal and the z axis of the cloud.
    tilt_deg: f32,
    /// Mean distance of the floor within 15 m from its plane.
    residual_m: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    agreement: Option<Agreement>,
}

/// Runs the command.
///
/// # Errors
/// Bad input.
pub fn run(arguments: &GroundArguments, json: bool) -> anyhow::Result<()> {
    let bad = |error: anyhow::Error| BadInput(format!("{error:#}"));
    let points = cloud_file::read(&arguments.file).map_err(bad)?;
    let found = ground(&points, arguments.tilt).ok_or_else(|| {
        let name = arguments.file.display();
        BadInput(format!("{name}: {} points, and no floor below the sensor among them", points.len()))
    })?;
    let truth = arguments.truth.as_deref();
    let agreement = truth.map(|path| compare(path, &found.is_floor)).transpose().map_err(bad)?;
    if let Some(path) = &arguments.out {
        draw(path, &points, &found)
            .map_err(|error| BadInput(format!("{}: cannot be written ({error})", path.display())))?;
    }
    let [.., up] = found.normal;
    let report = Report {
        points: points.len(),
        floor_points: found.is_floor.iter().filter(|is_floor| **is_floor).count(),
        height_m: found.height_m,
        normal: found.normal,
        tilt_deg: libm::acosf(up.clamp(-1.0, 1.0)).to_degrees(),
        residual_m: found.residual_m,
        agreement,
    };
    if json {
        tell!("{}", serde_json::to_string(&report)?)?;
        return Ok(());
    }
    let Report { points, floor_points, height_m, tilt_deg, residual_m, .. } = &report;
    tell!(
        "{floor_points} of {points} points are floor, {height_m:.3} m below the sensor, which is tilted by {tilt_deg:.1}°"
    )?;
    tell!("  on average {:.1} cm from its plane within 15 m", residual_m * 100.0)?;
    if let Some(Agreement { points, precision, recall }) = report.agreement {
        tell!("  of {points} points of the truth: precision {precision:.3}, recall {recall:.3}")?;
    }
    Ok(())
}

fn draw(path: &std::path::Path, points: &[Point], found: &Ground) -> std::io::Result<()> {
    let mut out = BufWriter::new(std::fs::File::create(path)?);
    writeln!(out, "ply\nformat ascii 1.0\nelement vertex {}", points.len())?;
    ["x", "y", "z"].iter().try_for_each(|name| writeln!(out, "property float {name}"))?;
    ["red", "green", "blue"].iter().try_for_each(|name| writeln!(out, "property uchar {name}"))?;
    writeln!(out, "end_header")?;
    for (point, is_floor) in points.iter().zip(&found.is_floor) {
        let [x, y, z] = point.position_m;
        let colour = if *is_floor { "60 170 80" } else { "150 150 150" };
        writeln!(out, "{x} {y} {z} {colour}")?;
    }
    out.flush()
}
