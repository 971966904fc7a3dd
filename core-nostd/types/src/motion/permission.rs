//! What a planner may ask the guard beforehand: would it permit this motion at this place?
//!
//! Planners plan what the guard will permit, without knowing the guard. The guard's own side implements the contract
//! from its fields and times. An answer never changes what the guard decides later.

use crate::geometry::{Pose2, Twist2};

/// A motion that a planner considers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PlannedMotion {
    /// Where the robot would be, in the map frame.
    pub pose_in_map: Pose2,
    /// How fast it would be there.
    pub twist: Twist2,
    /// How long from now, seconds, ≥ 0.
    pub in_s: f32,
}

/// What the guard would do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Permission {
    /// Share of the motion that it would permit on the same curve, 0…1; 0 is a stop.
    pub share: f32,
    /// How long a stop here would hold the robot, seconds, ≥ 0; 0 where it would not stop.
    pub held_s: f32,
}

impl Permission {
    /// No limit.
    pub const FREE: Self = Self { share: 1.0, held_s: 0.0 };

    /// A stop that holds the robot for a time, seconds.
    #[must_use]
    pub const fn stop(held_s: f32) -> Self {
        Self { share: 0.0, held_s }
    }
}

/// Answers for planners; total, without side effects, at a cost that the implementation states.
pub trait PermittedMotion {
    /// What the guard would do with this motion by what is known now.
    fn permission(&self, motion: PlannedMotion) -> Permission;
}

/// A guard that limits nothing: for planning without one, as in published benchmarks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AlwaysPermitted;

impl PermittedMotion for AlwaysPermitted {
    fn permission(&self, _motion: PlannedMotion) -> Permission {
        Permission::FREE
    }
}
