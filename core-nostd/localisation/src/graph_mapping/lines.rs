//! A scan laid onto the surfaces of kept ones: points to lines (Censi 2008).
//!
//! A field of 10 cm cells leaves a scan free by half a cell, and where odometry turns too little at each step it would do so at each match.

use floorguard_types::geometry::{Point2, Pose2};
use nalgebra::{Matrix3, Vector3};

use super::kept::KeptScan;
use crate::scan_matching::{Guess, Refined};

/// Distance within which a return belongs to a line, metres, for each step.
const NEAR_M: [f32; 4] = [0.3, 0.2, 0.15, 0.12];
/// A return so near to a line shows nothing new, metres.
const KNOWN_M: f32 = 0.2;
/// Deviation of a return from its line, metres: noise, and what a line between two returns leaves out.
const DEVIATION_M: f32 = 0.03;
/// Distance at which a return counts half (Cauchy's weight), metres.
const OUTLIER_M: f32 = 0.06;
/// Neighbours err alike: the share of the information that counts.
const INFORMATION_SHARE: f32 = 0.1;

/// The line nearest to a return so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    squared: f32,
    normal: Point2,
    offset: f32,
}

impl Nearest {
    pub(super) const NONE: Self = Self { squared: f32::INFINITY, normal: Point2::new(0.0, 0.0), offset: 0.0 };
}

/// Lays a scan onto lines. `scans` gives the kept scans in the wanted frame. The score is the share of the returns that show nothing new. Cost: 4 × returns × lines.
pub(super) fn onto_lines<'a, const POINTS: usize>(
    (points, nearest): (&[Point2], &mut [Nearest]),
    guess: &Guess,
    scans: impl Iterator<Item = (Pose2, &'a KeptScan<POINTS>)> + Clone,
) -> Refined {
    let mut pose = guess.start;
    let mut refined = Refined::none();
    for near_m in NEAR_M {
        look(points, pose, (nearest, scans.clone()));
        let normal = sum(points, pose, (nearest, near_m));
        let away = pose_less(pose, guess.expected);
        let matrix = normal.matrix + guess.information;
        let vector = normal.vector + guess.information * away;
        let Some(factor) = (matrix + Matrix3::from_diagonal_element(1.0e-3)).cholesky() else { break };
        let step = -factor.solve(&vector);
        let length = step.norm();
        let step = if length > near_m { step * (near_m / length) } else { step };
        pose = Pose2::new(pose.x_m + step.x, pose.y_m + step.y, pose.heading_rad + step.z);
        refined = Refined {
            pose,
            score: normal.share,
            information: normal.matrix * INFORMATION_SHARE,
            steps: refined.steps.saturating_add(1),
        };
    }
    refined
}

fn pose_less(a: Pose2, b: Pose2) -> Vector3<f32> {
    let turn = Pose2::new(0.0, 0.0, a.heading_rad - b.heading_rad).heading_rad;
    Vector3::new(a.x_m - b.x_m, a.y_m - b.y_m, turn)
}

/// The nearest line of each return.
fn look<'a, const POINTS: usize>(
    points: &[Point2],
    pose: Pose2,
    (nearest, scans): (&mut [Nearest], impl Iterator<Item = (Pose2, &'a KeptScan<POINTS>)>),
) {
    nearest.fill(Nearest::NONE);
    for (scan_pose, scan) in scans {
        // The returns of the new scan as the kept one has them: its lines are not moved.
        let (sin, cos) = libm::sincosf(scan_pose.heading_rad);
        let seen = scan_pose.inverse().compose(pose);
        let (seen_sin, seen_cos) = libm::sincosf(seen.heading_rad);
        for (point, best) in points.iter().zip(nearest.iter_mut()) {
            let place = Point2::new(
                seen.x_m + seen_cos * point.x_m - seen_sin * point.y_m,
                seen.y_m + seen_sin * point.x_m + seen_cos * point.y_m,
            );
            for [from, to] in scan.lines() {
                let (along_x, along_y) = (to.x_m - from.x_m, to.y_m - from.y_m);
                let (x, y) = (place.x_m - from.x_m, place.y_m - from.y_m);
                let length_squared = (along_x * along_x + along_y * along_y).max(1.0e-6);
                let share = ((x * along_x + y * along_y) / length_squared).clamp(0.0, 1.0);
                let (off_x, off_y) = (x - share * along_x, y - share * along_y);
                let squared = off_x * off_x + off_y * off_y;
                if squared < best.squared {
                    let length = libm::sqrtf(length_squared);
                    let normal = Point2::new(-along_y / length, along_x / length);
                    let turned =
                        Point2::new(cos * normal.x_m - sin * normal.y_m, sin * normal.x_m + cos * normal.y_m);
                    let offset = x * normal.x_m + y * normal.y_m;
                    *best = Nearest { squared, normal: turned, offset };
                }
            }
        }
    }
}

struct Normal {
    matrix: Matrix3<f32>,
    vector: Vector3<f32>,
    share: f32,
}

/// The normal equations of the returns that have a line near.
fn sum(points: &[Point2], pose: Pose2, (nearest, near_m): (&[Nearest], f32)) -> Normal {
    let (sin, cos) = libm::sincosf(pose.heading_rad);
    let mut normal = Normal { matrix: Matrix3::zeros(), vector: Vector3::zeros(), share: 0.0 };
    let (mut met, mut all) = (0.0_f32, 0.0_f32);
    for (point, line) in points.iter().zip(nearest) {
        all += 1.0;
        met += if line.squared < KNOWN_M * KNOWN_M { 1.0 } else { 0.0 };
        if line.squared > near_m * near_m {
            continue;
        }
        let (x, y) = (cos * point.x_m - sin * point.y_m, sin * point.x_m + cos * point.y_m);
        let by = Vector3::new(line.normal.x_m, line.normal.y_m, line.normal.y_m * x - line.normal.x_m * y);
        let off = line.offset / OUTLIER_M;
        let weight = 1.0 / (DEVIATION_M * DEVIATION_M * (1.0 + off * off));
        normal.matrix += by * by.transpose() * weight;
        normal.vector += by * (weight * line.offset);
    }
    normal.share = met / all.max(1.0);
    normal
}
