//! The path of the sensor during one sweep: constant velocity up to the pose at its end.

use floorguard_types::number::{count_f32, nearest_f32_of_f64, nearest_f64, saturating_usize};
use nalgebra::{Matrix3, Vector3};

use super::motion::{Pose3, Twist3};

/// Pieces of a sweep within which the motion is taken as straight.
pub(super) const PIECES: usize = 64;

/// Pose at the middle of a piece, and velocity there, in the map.
#[derive(Clone, Copy, Debug)]
struct Piece {
    rotation: Matrix3<f32>,
    place: Vector3<f32>,
    /// Of the sensor over the piece.
    step: Vector3<f32>,
}

/// Places returns of a sweep in the map.
#[derive(Clone, Debug)]
pub struct SweepMotion {
    pieces: [Piece; PIECES],
    /// Of the body, over one piece.
    turn: Vector3<f32>,
    duration_s: f32,
}

impl SweepMotion {
    /// A sweep of this duration that ends at a pose with a velocity.
    #[must_use]
    pub fn new(end: &Pose3, twist: &Twist3, duration_s: f64) -> Self {
        let short = nearest_f32_of_f64;
        let step_s = duration_s / nearest_f64(PIECES);
        let step = twist.over(-step_s);
        let mut pose = end.compose(&twist.over(-0.5 * step_s));
        let none = Piece { rotation: Matrix3::zeros(), place: Vector3::zeros(), step: Vector3::zeros() };
        let mut pieces = [none; PIECES];
        for piece in pieces.iter_mut().rev() {
            *piece = Piece {
                rotation: pose.rotation.map(short),
                place: pose.place_m.map(short),
                step: (pose.rotation * twist.linear_mps * step_s).map(short),
            };
            pose = pose.compose(&step);
        }
        Self { pieces, turn: (twist.angular_radps * step_s).map(short), duration_s: short(duration_s) }
    }

    /// A return in the map, metres.
    #[inline]
    #[must_use]
    pub fn transform(&self, point_in_sensor: &Vector3<f32>, time_share: f32) -> Vector3<f32> {
        let at = time_share * count_f32(PIECES);
        let index = saturating_usize(at).min(PIECES - 1);
        let Some(piece) = self.pieces.get(index) else { return *point_in_sensor };
        let rest = at - count_f32(index) - 0.5;
        // Within a piece the rotation is small: its first order is exact to a few micrometres.
        let turned = point_in_sensor + self.turn.cross(point_in_sensor) * rest;
        piece.rotation * turned + (piece.place + piece.step * rest)
    }

    /// Seconds before the end of the sweep, as a negative number.
    #[inline]
    #[must_use]
    pub(super) fn time_s(&self, time_share: f32) -> f32 {
        (time_share - 1.0) * self.duration_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn follows_the_exact_motion() {
        let twist =
            Twist3 { angular_radps: Vector3::new(0.1, -0.1, 1.5), linear_mps: Vector3::new(0.8, 0.1, 0.0) };
        let end = Pose3::identity().moved(Vector3::new(0.1, 0.2, 0.3), Vector3::new(3.0, -2.0, 0.5));
        let motion = SweepMotion::new(&end, &twist, 0.1);
        let point = Vector3::new(8.0_f32, -3.0, 1.0);
        for share in [0.0_f32, 0.003, 0.4, 0.77, 1.0] {
            let exact =
                end.compose(&twist.over((f64::from(share) - 1.0) * 0.1)).transform(&point.map(f64::from));
            let found = motion.transform(&point, share).map(f64::from);
            assert!((found - exact).norm() < 2.0e-5, "{share}: {found} {exact}");
        }
    }
}
