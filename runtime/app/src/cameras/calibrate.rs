//! `floorguard calibrate camera-lidar`: where a camera is mounted, from points picked in its picture and in the cloud.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use floorguard_host::outcome::{BadInput, VerdictFailed};
use floorguard_host::words::counted;
use floorguard_mapping_host::calibrate::{
    MountingError, ResidualPicture, SolvedMounting, draw_residuals, read_pairs, solve_mounting,
};
use serde::Serialize;

use super::camera_file::CameraFile;
use crate::files::{text, write_whole};

/// What to calibrate.
#[derive(Clone, Debug, Args)]
pub struct CalibrateArguments {
    /// Which sensors.
    #[command(subcommand)]
    pub what: CalibrateWhat,
}

/// Which sensors.
#[derive(Clone, Debug, Subcommand)]
pub enum CalibrateWhat {
    /// Where a camera is mounted beside a lidar.
    CameraLidar(CameraLidarArguments),
}

/// Pairs and camera.
#[derive(Clone, Debug, Args)]
#[command(
    after_help = "Example: floorguard calibrate camera-lidar pairs.csv --camera front.json --out front-mounted.json\n\n\
                  front.json: {\"width\":1280,\"height\":720,\"focal_px\":[610,605],\"centre_px\":[642.5,361.2],\n             \
                  \"distortion\":[k1,k2,p1,p2,k3]}"
)]
pub struct CameraLidarArguments {
    /// Picked pairs: `x,y,z,column,row` a line, metres in the lidar's frame and pixels; six in space or four on a plane.
    pub pairs: PathBuf,
    /// Size, intrinsics and lens of the camera (JSON).
    #[arg(long, value_name = "FILE.json")]
    pub camera: PathBuf,
    /// The camera's file with its mounting, for `clean-map --camera`; a picture of the residuals (.svg) is put beside it.
    #[arg(long, value_name = "FILE.json")]
    pub out: PathBuf,
    /// The photograph in which the pixels were picked (PNG or JPEG): the residuals are drawn upon it.
    #[arg(long, value_name = "FILE")]
    pub photograph: Option<PathBuf>,
    /// The result as one JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

/// Field names say the units.
#[derive(Serialize)]
struct Row {
    pairs: usize,
    rms_px: f64,
    /// Picked minus projected.
    residuals_px: Vec<[f64; 2]>,
    turn_sigma_deg: f64,
    shift_sigma_m: f64,
    camera_from_lidar: [[f64; 4]; 4],
}

/// Runs the command.
///
/// # Errors
/// Bad input; pairs that hold no mounting end with 1 and write nothing.
pub fn run(arguments: &CalibrateArguments) -> anyhow::Result<()> {
    let CalibrateWhat::CameraLidar(arguments) = &arguments.what;
    let mut camera = CameraFile::read(&arguments.camera)?;
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", arguments.pairs.display()));
    let pairs = read_pairs(&text(&arguments.pairs)?).map_err(|error| bad(&error))?;
    let size = [camera.width, camera.height];
    let is_inside = |column: f64, row: f64| {
        (0.0..=f64::from(size[0])).contains(&column) && (0.0..=f64::from(size[1])).contains(&row)
    };
    if let Some(outside) = pairs.iter().position(|pair| !is_inside(pair.pixel.x, pair.pixel.y)) {
        let [width, height] = size;
        return Err(
            bad(&format!("the pixel of pair {} lies outside of {width}×{height}", outside + 1)).into()
        );
    }
    let photograph = match &arguments.photograph {
        Some(path) => {
            Some(std::fs::read(path).map_err(|error| BadInput(format!("{}: {error}", path.display())))?)
        }
        None => None,
    };
    let solved = solve_mounting(&camera.intrinsics(), &pairs).map_err(|error| refused(error, &bad))?;
    let matrix = matrix(&solved);
    camera.camera_from_lidar = Some(matrix);
    // What a robot loads is single precision: it must pass its check.
    camera.mounted(&arguments.out)?;
    let picture = draw_residuals(&ResidualPicture {
        size,
        pairs: &pairs,
        residuals_px: &solved.residuals_px,
        photograph: photograph.as_deref(),
    });
    write_whole(&arguments.out, (serde_json::to_string_pretty(&camera)? + "\n").as_bytes())?;
    let beside = arguments.out.with_extension("svg");
    write_whole(&beside, picture.as_bytes())?;
    report(arguments, &solved, matrix)
}

/// Pairs that fit to nothing are a verdict; too few or wrong ones are bad input.
fn refused(error: MountingError, bad: &dyn Fn(&dyn std::fmt::Display) -> BadInput) -> anyhow::Error {
    match error {
        MountingError::NoFit { .. } | MountingError::Loose { .. } => VerdictFailed(error.to_string()).into(),
        other => bad(&other).into(),
    }
}

fn matrix(solved: &SolvedMounting) -> [[f64; 4]; 4] {
    let matrix = solved.camera_from_lidar.to_homogeneous();
    [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| matrix[(row, column)]))
}

fn report(
    arguments: &CameraLidarArguments,
    solved: &SolvedMounting,
    camera_from_lidar: [[f64; 4]; 4],
) -> anyhow::Result<()> {
    let residuals_px: Vec<[f64; 2]> = solved.residuals_px.iter().map(|each| [each.x, each.y]).collect();
    if arguments.json {
        let row = Row {
            pairs: residuals_px.len(),
            rms_px: solved.rms_px,
            residuals_px,
            turn_sigma_deg: solved.turn_sigma_deg,
            shift_sigma_m: solved.shift_sigma_m,
            camera_from_lidar,
        };
        return Ok(tell!("{}", serde_json::to_string(&row)?)?);
    }
    let (turn_deg, shift_m) = (solved.turn_sigma_deg, solved.shift_sigma_m);
    say!("calibrated: {} ({})", arguments.out.display(), counted(residuals_px.len() as u64, "pair"));
    say!("  root mean square {:.2} px; uncertain by {turn_deg:.2}° and {shift_m:.3} m", solved.rms_px);
    for (index, [column, row]) in residuals_px.iter().enumerate() {
        say!("  pair {}: {:.2} px ({column:+.2}, {row:+.2})", index + 1, column.hypot(*row));
    }
    say!("  look at {}", arguments.out.with_extension("svg").display());
    Ok(())
}
