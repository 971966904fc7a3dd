//! How sure a search is: the spread of the poses that fit nearly as well as the best.

use floorguard_mapping::match_field::FieldLevel;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::nearest_f32;
use nalgebra::{Matrix3, Vector3};

/// A small lattice of poses around the best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScoreSurface {
    /// The best pose, in the field's frame.
    pub best: Pose2,
    /// Steps to each side, in every direction; at most 8.
    pub half_steps: i32,
    /// A step of the place, metres.
    pub step_m: f32,
    /// A step of the heading, radians.
    pub step_rad: f32,
}

/// Scores less than the best by more than this do not count (Olson 2009; karto counts the same).
const SCORE_SPAN: f32 = 0.1;

/// Covariance of x, y and heading in the field's frame: second moments of the poses of the lattice, weighed by how much
/// of the span their score has left. Never smaller than a quarter of a step squared. Cost: points × (2 steps + 1)³.
#[must_use]
pub fn score_covariance(level: &FieldLevel<'_>, points: &[Point2], surface: &ScoreSurface) -> Matrix3<f32> {
    let half = surface.half_steps.clamp(1, 8);
    let best = score(level, points, surface.best);
    let mut moments = Matrix3::zeros();
    let mut weight_sum = 0.0_f32;
    for turn in -half..=half {
        for row in -half..=half {
            for column in -half..=half {
                let away = Vector3::new(
                    nearest_f32(column) * surface.step_m,
                    nearest_f32(row) * surface.step_m,
                    nearest_f32(turn) * surface.step_rad,
                );
                let pose = Pose2::new(
                    surface.best.x_m + away.x,
                    surface.best.y_m + away.y,
                    surface.best.heading_rad + away.z,
                );
                let weight = (score(level, points, pose) - best + SCORE_SPAN).clamp(0.0, SCORE_SPAN);
                moments += away * away.transpose() * weight;
                weight_sum += weight;
            }
        }
    }
    let least = Vector3::new(surface.step_m, surface.step_m, surface.step_rad) * 0.5;
    moments / weight_sum.max(1.0e-6) + Matrix3::from_diagonal(&least.component_mul(&least))
}

fn score(level: &FieldLevel<'_>, points: &[Point2], pose: Pose2) -> f32 {
    let (sin, cos) = libm::sincosf(pose.heading_rad);
    let mut sum = 0.0_f32;
    for point in points {
        let x = pose.x_m + cos * point.x_m - sin * point.y_m;
        let y = pose.y_m + sin * point.x_m + cos * point.y_m;
        sum += level.sample(Point2::new(x, y)).value;
    }
    sum / nearest_f32(points.len().max(1))
}
