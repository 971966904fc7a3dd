//! What is known about a pair of poses in space.

use floorguard_mapping::lidar_odometry::{Pose3, cross_matrix};
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

use crate::pose_graph::EdgeKind;

/// The second pose as it was measured from the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceEdge {
    /// Index of the first pose.
    pub from: usize,
    /// Index of the second.
    pub to: usize,
    /// The second in the frame of the first.
    pub measured: Pose3,
    /// Inverse covariance of rotation (radians) and place (metres) in the frame of the measured pose.
    pub information: Matrix6<f64>,
    /// How far it is believed.
    pub kind: EdgeKind,
}

/// Derivatives of the error by the first and by the second pose, each turned and moved in its own axes.
pub(super) struct Derivatives {
    pub(super) first: Matrix6<f64>,
    pub(super) second: Matrix6<f64>,
}

impl SpaceEdge {
    /// Rotation vector and place of the second pose, seen from where it was measured.
    #[must_use]
    pub fn error(&self, from: &Pose3, to: &Pose3) -> Vector6<f64> {
        let off = self.off(from, to);
        let mut error = Vector6::zeros();
        error.fixed_rows_mut::<3>(0).copy_from(&off.rotation_vector());
        error.fixed_rows_mut::<3>(3).copy_from(&off.place_m);
        error
    }

    /// Squared error, weighed.
    #[must_use]
    pub fn chi2(&self, from: &Pose3, to: &Pose3) -> f64 {
        let error = self.error(from, to);
        error.dot(&(self.information * error))
    }

    fn off(&self, from: &Pose3, to: &Pose3) -> Pose3 {
        self.measured.inverse().compose(&from.inverse().compose(to))
    }

    pub(super) fn derivatives(&self, from: &Pose3, to: &Pose3) -> Derivatives {
        let between = from.inverse().compose(to);
        let off = self.off(from, to);
        let mut second = Matrix6::zeros();
        second.fixed_view_mut::<3, 3>(0, 0).copy_from(&inverse_right_jacobian(&off.rotation_vector()));
        second.fixed_view_mut::<3, 3>(3, 3).copy_from(&off.rotation);
        // A motion of the first pose is the opposite one of the second, seen from there.
        let back = between.rotation.transpose();
        let mut seen = Matrix6::zeros();
        seen.fixed_view_mut::<3, 3>(0, 0).copy_from(&(-back));
        seen.fixed_view_mut::<3, 3>(3, 3).copy_from(&(-back));
        seen.fixed_view_mut::<3, 3>(3, 0).copy_from(&(back * cross_matrix(&between.place_m)));
        Derivatives { first: second * seen, second }
    }
}

/// How the rotation vector `v` of a rotation changes with a small turn in the inner axes (Solà et al. 2018, equation 144).
fn inverse_right_jacobian(v: &Vector3<f64>) -> Matrix3<f64> {
    let cross = cross_matrix(v);
    let square = v.norm_squared();
    let angle = libm::sqrt(square);
    let factor = if angle < 1.0e-3 {
        1.0 / 12.0
    } else {
        1.0 / square - (1.0 + libm::cos(angle)) / (2.0 * angle * libm::sin(angle)).max(1.0e-9)
    };
    Matrix3::identity() + cross * 0.5 + cross * cross * factor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_small_motions() {
        let pose = |turn: [f64; 3], step: [f64; 3]| {
            Pose3::identity().moved(Vector3::from(turn), Vector3::from(step))
        };
        let from = pose([0.1, -0.2, 0.9], [3.0, -1.0, 0.4]);
        let to = pose([-0.05, 0.1, 1.6], [4.0, 2.0, 0.1]);
        let measured = pose([0.02, 0.2, 0.5], [2.5, 1.5, -0.2]);
        let edge =
            SpaceEdge { from: 0, to: 1, measured, information: Matrix6::identity(), kind: EdgeKind::Loop };
        let exact = edge.derivatives(&from, &to);
        for column in 0..6 {
            let mut step = Vector6::zeros();
            step[column] = 1.0e-6;
            let (turn, place) = (step.fixed_rows::<3>(0).into_owned(), step.fixed_rows::<3>(3).into_owned());
            let first =
                edge.error(&from.moved(turn, place), &to) - edge.error(&from.moved(-turn, -place), &to);
            let second =
                edge.error(&from, &to.moved(turn, place)) - edge.error(&from, &to.moved(-turn, -place));
            assert!((first / 2.0e-6 - exact.first.column(column)).norm() < 1.0e-5, "first {column}");
            assert!((second / 2.0e-6 - exact.second.column(column)).norm() < 1.0e-5, "second {column}");
        }
    }
}
