//! Poses with covariance: how doubt adds up along a path (Smith et al. 1990).

use nalgebra::{Matrix3, Vector3};

use super::edge::Edge;
use crate::se2::Se2;

/// A pose whose error has this covariance, of x, y (metres) and heading (radians) in the frame of the pose itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UncertainPose {
    /// The pose.
    pub pose: Se2,
    /// Of its error.
    pub covariance: Matrix3<f64>,
}

/// How a small motion in the frame of a pose looks from the frame in which the pose is given.
fn adjoint(pose: Se2) -> Matrix3<f64> {
    let (sin, cos) = libm::sincos(pose.heading_rad);
    Matrix3::new(cos, -sin, pose.y_m, sin, cos, -pose.x_m, 0.0, 0.0, 1.0)
}

impl UncertainPose {
    /// No motion, no doubt.
    #[must_use]
    pub fn identity() -> Self {
        Self { pose: Se2::default(), covariance: Matrix3::zeros() }
    }

    /// What an edge measured; `None` without a full information.
    #[must_use]
    pub fn of(edge: &Edge) -> Option<Self> {
        Some(Self { pose: edge.measured, covariance: edge.information.try_inverse()? })
    }

    /// `self` followed by `inner`, whose errors are independent.
    #[must_use]
    pub fn compose(self, inner: Self) -> Self {
        let carried = adjoint(inner.pose.inverse());
        let covariance = carried * self.covariance * carried.transpose() + inner.covariance;
        Self { pose: self.pose.compose(inner.pose), covariance }
    }

    /// The way back.
    #[must_use]
    pub fn inverse(self) -> Self {
        let carried = adjoint(self.pose);
        Self { pose: self.pose.inverse(), covariance: carried * self.covariance * carried.transpose() }
    }

    /// Weighed squared difference of two measurements of one pose; infinite where it cannot be weighed.
    #[must_use]
    pub fn squared_difference(self, other: Self) -> f64 {
        let away = self.pose.between(other.pose);
        let error = Vector3::new(away.x_m, away.y_m, away.heading_rad);
        let factor = (self.covariance + other.covariance).cholesky();
        factor.map_or(f64::INFINITY, |factor| error.dot(&factor.solve(&error)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the spread of composed samples (the covariance by its definition).
    #[test]
    fn covariance_is_the_spread_of_samples() {
        let diagonal = |x: f64, y: f64, turn: f64| Matrix3::from_diagonal(&Vector3::new(x, y, turn));
        let first = UncertainPose { pose: Se2::new(2.0, 1.0, 0.7), covariance: diagonal(4e-6, 1e-6, 9e-6) };
        let second =
            UncertainPose { pose: Se2::new(1.5, -0.5, -0.4), covariance: diagonal(1e-6, 4e-6, 1e-6) };
        // Three values with mean 0 and variance 1: exact for what is linear.
        let parts = [-(1.5_f64.sqrt()), 0.0, 1.5_f64.sqrt()];
        let mut samples = vec![Vector3::zeros()];
        let samples_of = |pose: UncertainPose| {
            let mut all = Vec::new();
            for x in parts {
                for y in parts {
                    for turn in parts {
                        let size = pose.covariance.diagonal().map(f64::sqrt);
                        let error = Se2::new(size.x * x, size.y * y, size.z * turn);
                        all.push(pose.pose.compose(error));
                    }
                }
            }
            all
        };
        samples.clear();
        let whole = first.compose(second);
        for a in samples_of(first) {
            for b in samples_of(second) {
                let away = whole.pose.between(a.compose(b));
                samples.push(Vector3::new(away.x_m, away.y_m, away.heading_rad));
            }
        }
        let sum: Matrix3<f64> = samples.iter().map(|e| e * e.transpose()).sum();
        let spread = sum / samples.len() as f64;
        assert!((spread - whole.covariance).norm() < 1e-3 * spread.norm(), "{spread} {}", whole.covariance);
        let back = whole.inverse().inverse();
        assert!((back.covariance - whole.covariance).norm() < 1e-12);
        assert!(whole.inverse().compose(whole).pose.distance(Se2::default()) < 1e-12);
    }
}
