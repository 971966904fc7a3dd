//! Where the robot is, how doubtful that is, and on which state of the map it rests.

use crate::geometry::Pose2;

/// Covariance of a pose: the upper triangle of a symmetric 3 × 3 matrix over x, y, heading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PoseCovariance {
    /// Variance along x, m².
    pub xx_m2: f32,
    /// Covariance of x and y, m².
    pub xy_m2: f32,
    /// Covariance of x and heading, m·rad.
    pub x_heading_m_rad: f32,
    /// Variance along y, m².
    pub yy_m2: f32,
    /// Covariance of y and heading, m·rad.
    pub y_heading_m_rad: f32,
    /// Variance of the heading, rad².
    pub heading_rad2: f32,
}

impl PoseCovariance {
    /// Standard deviation of the position along its worst direction, metres: the root of the largest eigenvalue of the
    /// position's 2 × 2 block. Infinite where the covariance is not finite.
    #[must_use]
    pub fn position_deviation_m(&self) -> f32 {
        let mean = 0.5 * (self.xx_m2 + self.yy_m2);
        let half = 0.5 * (self.xx_m2 - self.yy_m2);
        let largest = mean + libm::sqrtf(half * half + self.xy_m2 * self.xy_m2);
        if largest.is_finite() { libm::sqrtf(largest.max(0.0)) } else { f32::INFINITY }
    }
}

/// An estimate of the robot's pose in the map frame.
///
/// A loop closure moves the map: places that were stored under another `map_revision` must be transformed again before
/// they are compared with this pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PoseEstimate {
    /// Most likely pose.
    pub pose_in_map: Pose2,
    /// Its doubt.
    pub covariance: PoseCovariance,
    /// Counts every change of the map that moves places already mapped.
    pub map_revision: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worst_direction_of_a_tilted_ellipse() {
        // Eigenvalues of [[5, 4], [4, 5]] are 9 and 1.
        let covariance = PoseCovariance { xx_m2: 5.0, xy_m2: 4.0, yy_m2: 5.0, ..PoseCovariance::default() };
        assert!((covariance.position_deviation_m() - 3.0).abs() < 1e-6);
        let broken = PoseCovariance { xx_m2: f32::NAN, ..covariance };
        assert_eq!(broken.position_deviation_m(), f32::INFINITY);
    }
}
