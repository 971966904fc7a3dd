//! What is known about a pair of poses.

use nalgebra::{Matrix3, Vector3};

use super::block_system::PairTerms;
use crate::se2::{Se2, wrap};

/// How far an edge is believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeKind {
    /// From odometry or from scan to scan: never doubted.
    Sequence,
    /// A place that was recognised: may be wrong.
    Loop,
}

/// The second pose as it was measured from the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Index of the first pose.
    pub from: usize,
    /// Index of the second.
    pub to: usize,
    /// The second in the frame of the first.
    pub measured: Se2,
    /// Inverse covariance of x, y (metres) and heading (radians) in the frame of the measured pose.
    pub information: Matrix3<f64>,
    /// How far it is believed.
    pub kind: EdgeKind,
}

impl Edge {
    /// Measured pose against the poses, in the measured pose's frame.
    #[must_use]
    pub fn error(&self, from: Se2, to: Se2) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(from.heading_rad);
        let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
        let x = cos * dx + sin * dy - self.measured.x_m;
        let y = cos * dy - sin * dx - self.measured.y_m;
        let (sin, cos) = libm::sincos(self.measured.heading_rad);
        let turn = wrap(to.heading_rad - from.heading_rad - self.measured.heading_rad);
        Vector3::new(cos * x + sin * y, cos * y - sin * x, turn)
    }

    /// Squared error, weighed.
    #[must_use]
    pub fn chi2(&self, from: Se2, to: Se2) -> f64 {
        let error = self.error(from, to);
        error.dot(&(self.information * error))
    }

    /// Change of the error with the first and with the second pose, along x, y and heading in the graph's frame.
    #[must_use]
    pub fn derivatives(&self, from: Se2, to: Se2) -> [Matrix3<f64>; 2] {
        let (sin, cos) = libm::sincos(from.heading_rad + self.measured.heading_rad);
        let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
        // Turning the first pose moves the second one sideways in the first one's frame.
        let turned = [cos * dy - sin * dx, -(sin * dy + cos * dx)];
        let second = Matrix3::new(cos, sin, 0.0, -sin, cos, 0.0, 0.0, 0.0, 1.0);
        let first = Matrix3::new(-cos, -sin, turned[0], sin, -cos, turned[1], 0.0, 0.0, -1.0);
        [first, second]
    }

    /// The terms of the normal equations, by derivatives along x, y and heading in the graph's frame. `weight` scales
    /// the information.
    #[must_use]
    pub fn terms(&self, from: Se2, to: Se2, weight: f64) -> PairTerms {
        let error = self.error(from, to);
        let [first, second] = self.derivatives(from, to);
        let information = self.information * weight;
        let (weighed_first, weighed_second) =
            (first.transpose() * information, second.transpose() * information);
        PairTerms {
            first: weighed_first * first,
            second: weighed_second * second,
            mixed: weighed_first * second,
            first_gradient: weighed_first * error,
            second_gradient: weighed_second * error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The derivatives against differences.
    #[test]
    fn terms_are_the_derivatives() {
        let edge = Edge {
            from: 0,
            to: 1,
            measured: Se2::new(0.7, -0.2, 0.9),
            information: Matrix3::new(3.0, 0.2, 0.1, 0.2, 2.0, -0.3, 0.1, -0.3, 5.0),
            kind: EdgeKind::Sequence,
        };
        let (a, b) = (Se2::new(1.0, 2.0, 0.4), Se2::new(1.9, 1.7, 1.6));
        let terms = edge.terms(a, b, 1.0);
        let moved = |pose: Se2, axis: usize, by: f64| {
            let mut step = [0.0; 3];
            step[axis] = by;
            Se2::new(pose.x_m + step[0], pose.y_m + step[1], pose.heading_rad + step[2])
        };
        for axis in 0..3 {
            let first = (edge.chi2(moved(a, axis, 1e-6), b) - edge.chi2(moved(a, axis, -1e-6), b)) / 4e-6;
            let second = (edge.chi2(a, moved(b, axis, 1e-6)) - edge.chi2(a, moved(b, axis, -1e-6))) / 4e-6;
            assert!((first - terms.first_gradient[axis]).abs() < 1e-6, "{axis}");
            assert!((second - terms.second_gradient[axis]).abs() < 1e-6, "{axis}");
        }
    }
}
