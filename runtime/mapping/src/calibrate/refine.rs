//! The mounting with the least squares of reprojection, by Gauss and Newton with damping (Levenberg 1944).

use nalgebra::{Isometry3, Matrix6, Translation3, UnitQuaternion, Vector2, Vector3, Vector6};

use super::camera::CameraIntrinsics;
use super::pairs::PickedPair;

/// Rounds at most.
const ROUNDS: usize = 20;
/// A smaller step ends the search: radians and metres.
const STEP_LEAST: f64 = 1.0e-10;
/// Step of the differences: radians and metres.
const DIFFERENCE: f64 = 1.0e-6;

/// Where the search ended.
pub struct Refined {
    /// From the lidar's frame to the camera's.
    pub camera_from_lidar: Isometry3<f64>,
    /// Picked minus projected, pixels.
    pub residuals_px: Vec<Vector2<f64>>,
    /// Jᵀ J of the residuals: rotation (radians about the camera's axes), translation (metres).
    pub information: Matrix6<f64>,
}

/// `None` where a point comes to lie behind the camera.
pub fn residuals(
    camera: &CameraIntrinsics,
    mounting: &Isometry3<f64>,
    pairs: &[PickedPair],
) -> Option<Vec<Vector2<f64>>> {
    let each = |pair: &PickedPair| {
        let point = mounting.rotation * pair.point_in_lidar + mounting.translation.vector;
        Some(pair.pixel - camera.project(&point)?)
    };
    pairs.iter().map(each).collect()
}

/// Sum of squares.
pub fn cost(residuals: &[Vector2<f64>]) -> f64 {
    residuals.iter().map(Vector2::norm_squared).sum()
}

fn stepped(mounting: &Isometry3<f64>, step: &Vector6<f64>) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(step[0], step[1], step[2]));
    let shift = Vector3::new(step[3], step[4], step[5]);
    Isometry3::from_parts(Translation3::from(mounting.translation.vector + shift), turn * mounting.rotation)
}

/// From a first guess; `None` if points lie behind the camera there.
pub fn refine(camera: &CameraIntrinsics, start: Isometry3<f64>, pairs: &[PickedPair]) -> Option<Refined> {
    let mut mounting = start;
    let mut now = residuals(camera, &mounting, pairs)?;
    let mut damping = 1.0e-6;
    for _ in 0..ROUNDS {
        let (information, gradient) = linearised(camera, &mounting, pairs, &now)?;
        let mut is_better = false;
        for _ in 0..8 {
            let damped = information + Matrix6::from_diagonal(&(information.diagonal() * damping));
            let Some(step) = damped.cholesky().map(|factor| factor.solve(&gradient)) else { break };
            let next = stepped(&mounting, &step);
            let tried = residuals(camera, &next, pairs).filter(|tried| cost(tried) < cost(&now));
            if let Some(tried) = tried {
                (mounting, now, is_better) = (next, tried, step.norm() > STEP_LEAST);
                damping = (damping * 0.1).max(1.0e-12);
                break;
            }
            damping *= 10.0;
        }
        if !is_better {
            break;
        }
    }
    let (information, _) = linearised(camera, &mounting, pairs, &now)?;
    Some(Refined { camera_from_lidar: mounting, residuals_px: now, information })
}

fn linearised(
    camera: &CameraIntrinsics,
    mounting: &Isometry3<f64>,
    pairs: &[PickedPair],
    now: &[Vector2<f64>],
) -> Option<(Matrix6<f64>, Vector6<f64>)> {
    let mut columns: Vec<[Vector2<f64>; 6]> = vec![[Vector2::zeros(); 6]; pairs.len()];
    for axis in 0..6 {
        let mut step = Vector6::zeros();
        step[axis] = DIFFERENCE;
        let ahead = residuals(camera, &stepped(mounting, &step), pairs)?;
        let behind = residuals(camera, &stepped(mounting, &-step), pairs)?;
        for (column, (ahead, behind)) in columns.iter_mut().zip(ahead.iter().zip(&behind)) {
            column[axis] = (behind - ahead) / (2.0 * DIFFERENCE);
        }
    }
    let (mut information, mut gradient) = (Matrix6::zeros(), Vector6::zeros());
    for (column, residual) in columns.iter().zip(now) {
        for row in 0..6 {
            gradient[row] += column[row].dot(residual);
            for other in 0..6 {
                information[(row, other)] += column[row].dot(&column[other]);
            }
        }
    }
    Some((information, gradient))
}
