//! From pairs to a mounting that can be trusted, or to the reason why not.

use nalgebra::{Isometry3, Matrix6, Vector2};

use super::camera::CameraIntrinsics;
use super::pairs::PickedPair;
use super::refine::{Refined, cost, refine};
use super::start::{Spread, from_plane, from_space};

/// Pairs on a plane that are needed.
const PLANE_PAIRS: usize = 4;
/// Pairs in space that are needed.
const SPACE_PAIRS: usize = 6;
/// Points whose second extent is below this share of their first lie on a line.
const LINE_SHARE: f64 = 0.02;
/// Points whose third extent is below this share of their first may lie on a plane: returns scatter by centimetres.
const PLANE_SHARE: f64 = 0.1;
/// Points whose third extent is below this share of their first do lie on one.
const SURELY_PLANE_SHARE: f64 = 0.005;
/// Larger errors are wrong picks, pixels.
const RMS_MAX_PX: f64 = 3.0;
/// Nobody picks better, pixels.
const PICKING_PX: f64 = 0.5;
/// More uncertain mountings are refused: standard deviations in degrees and metres.
const TURN_MAX_DEG: f64 = 2.0;
const SHIFT_MAX_M: f64 = 0.3;

/// A mounting with what it is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedMounting {
    /// From the lidar's frame to the camera's (x right, y down, z forward).
    pub camera_from_lidar: Isometry3<f64>,
    /// Root mean square of the distances between picked and projected pixels.
    pub rms_px: f64,
    /// Picked minus projected, pixels, in the order of the pairs.
    pub residuals_px: Vec<Vector2<f64>>,
    /// Standard deviation of the turn about the camera's axes, degrees: the largest.
    pub turn_sigma_deg: f64,
    /// Standard deviation of the translation, metres: the largest.
    pub shift_sigma_m: f64,
}

/// Why pairs give no mounting.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MountingError {
    /// Not enough pairs.
    #[error("{is} pairs: {needed} are needed ({})", if *needed == PLANE_PAIRS { "4 on a plane or 6 in space" } else { "6, because they do not lie on a plane" })]
    TooFew {
        /// Given.
        is: usize,
        /// Needed.
        needed: usize,
    },
    /// All points on a line: the camera could be anywhere around it.
    #[error("the points lie on a line: pick some beside it")]
    OnALine,
    /// No mounting sees all points before the camera.
    #[error(
        "no mounting sees all points before the camera: are columns and rows swapped, or the axes of the lidar others?"
    )]
    Behind,
    /// The errors are too large.
    #[error(
        "the pairs do not fit together: root mean square {rms_px:.1} px (at most {RMS_MAX_PX} px); pair {worst} is off by {worst_px:.1} px"
    )]
    NoFit {
        /// Of all pairs.
        rms_px: f64,
        /// Number of the pair with the largest error, from 1.
        worst: usize,
        /// Its error.
        worst_px: f64,
    },
    /// Another mounting would fit nearly as well.
    #[error(
        "the pairs do not hold the mounting: it is uncertain by {turn_deg:.1}° and {shift_m:.2} m; pick points farther apart, at other distances"
    )]
    Loose {
        /// Standard deviation, degrees.
        turn_deg: f64,
        /// Standard deviation, metres.
        shift_m: f64,
    },
}

/// The mounting of a camera by picked pairs: a linear guess for points in space and one for points on a plane, as far as there
/// are such, then least squares of reprojection; the better one counts.
///
/// # Errors
/// See [`MountingError`].
pub fn solve_mounting(
    camera: &CameraIntrinsics,
    pairs: &[PickedPair],
) -> Result<SolvedMounting, MountingError> {
    let is = pairs.len();
    if is < PLANE_PAIRS {
        return Err(MountingError::TooFew { is, needed: PLANE_PAIRS });
    }
    let spread = Spread::of(pairs);
    let [first, second, third] = spread.lengths;
    // Also true for numbers that are not finite.
    let is_wide = second > LINE_SHARE * first;
    if !is_wide {
        return Err(MountingError::OnALine);
    }
    let may_be_plane = third < PLANE_SHARE * first;
    if is < SPACE_PAIRS && !may_be_plane {
        return Err(MountingError::TooFew { is, needed: SPACE_PAIRS });
    }
    let rays: Vec<Vector2<f64>> = pairs.iter().map(|pair| camera.undistorted(pair.pixel)).collect();
    let in_space = is >= SPACE_PAIRS && third > SURELY_PLANE_SHARE * first;
    let starts = [
        in_space.then(|| from_space(pairs, &rays, &spread)).flatten(),
        may_be_plane.then(|| from_plane(pairs, &rays, &spread)).flatten(),
    ];
    let refined = starts.into_iter().flatten().filter_map(|start| refine(camera, start, pairs));
    let best = refined.min_by(|a, b| cost(&a.residuals_px).total_cmp(&cost(&b.residuals_px)));
    judged(best.ok_or(MountingError::Behind)?)
}

fn judged(refined: Refined) -> Result<SolvedMounting, MountingError> {
    let count = refined.residuals_px.len().max(1) as f64;
    let rms_px = (cost(&refined.residuals_px) / count).sqrt();
    let errors = refined.residuals_px.iter().map(Vector2::norm).enumerate();
    let (worst, worst_px) = errors.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
    let fits = rms_px <= RMS_MAX_PX;
    if !fits {
        return Err(MountingError::NoFit { rms_px, worst: worst + 1, worst_px });
    }
    let per_axis_px = rms_px.max(PICKING_PX) * (2.0 * count / (2.0 * count - 6.0).max(1.0) / 2.0).sqrt();
    let covariance = refined.information.try_inverse().unwrap_or(Matrix6::identity() * f64::INFINITY);
    let sigma = |from: usize| {
        let axis = |axis: usize| covariance[(axis, axis)].max(0.0).sqrt() * per_axis_px;
        axis(from).max(axis(from + 1)).max(axis(from + 2))
    };
    let (turn_deg, shift_m) = (sigma(0).to_degrees(), sigma(3));
    let is_held = turn_deg <= TURN_MAX_DEG && shift_m <= SHIFT_MAX_M;
    if !is_held {
        return Err(MountingError::Loose { turn_deg, shift_m });
    }
    Ok(SolvedMounting {
        camera_from_lidar: refined.camera_from_lidar,
        rms_px,
        residuals_px: refined.residuals_px,
        turn_sigma_deg: turn_deg,
        shift_sigma_m: shift_m,
    })
}
