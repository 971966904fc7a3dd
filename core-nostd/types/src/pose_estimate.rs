//! Where the robot believes it is, with its doubt, and in which edition of the map.

use crate::geometry::Pose2;

/// A pose in the map with its doubt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseEstimate {
    /// The robot in the map frame.
    pub pose: Pose2,
    /// Covariance of x, y (metres) and heading (radians), in the map frame; symmetric, row by row.
    pub covariance: [[f32; 3]; 3],
    /// Counts the corrections of the map. Two poses of different revisions must not be subtracted: the map between
    /// them has moved.
    pub map_revision: u32,
}
