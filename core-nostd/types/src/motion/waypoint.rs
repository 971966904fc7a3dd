//! Poses of a path, and how each is reached.

use crate::geometry::{Point2, Pose2};

/// How a waypoint is reached from the one before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Gear {
    /// Forward, straight or on an arc.
    #[default]
    Ahead,
    /// Turning on the spot.
    Spin,
    /// Backwards.
    Back,
}

/// A pose on a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Waypoint {
    /// In the map frame.
    pub pose_in_map: Pose2,
    /// How it is reached.
    pub gear: Gear,
}

impl Waypoint {
    /// Its place, in the map frame.
    #[must_use]
    pub const fn place_in_map(&self) -> Point2 {
        Point2::new(self.pose_in_map.x_m, self.pose_in_map.y_m)
    }
}
