//! The contract of all local planners.

use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::motion::{AlwaysPermitted, MovingPerson, PermittedMotion, Waypoint};

use crate::costmap::CostmapView;

/// What a local planner plans from.
#[derive(Clone, Copy, Debug)]
pub struct LocalSituation<'a, P = AlwaysPermitted> {
    /// Where the robot is, in the frame of the costmap.
    pub pose_in_map: Pose2,
    /// How it moves.
    pub twist: Twist2,
    /// What it costs to drive where.
    pub costmap: CostmapView<'a>,
    /// The rest of the path, in the same frame; the last waypoint is the goal.
    pub path: &'a [Waypoint],
    /// People near, at this moment.
    pub people: &'a [MovingPerson],
    /// What the guard would permit.
    pub guard: &'a P,
    /// Highest speed allowed here, m/s, by zones or by the task.
    pub speed_limit_mps: f32,
}

/// Why the command is what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocalVerdict {
    /// Along the path.
    Driving,
    /// The goal is reached within the tolerances; the command is to stand.
    Arrived,
    /// No velocity is free of collisions; the command is to stand.
    Blocked,
    /// There is no path, or the robot is not on the costmap; the command is to stand.
    NoPath,
}

/// What to request from the guard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalCommand {
    /// The requested velocity.
    pub twist: Twist2,
    /// Why.
    pub verdict: LocalVerdict,
}

impl LocalCommand {
    /// Standing, for a reason.
    #[must_use]
    pub const fn stand(verdict: LocalVerdict) -> Self {
        Self { twist: Twist2::ZERO, verdict }
    }
}

/// Chooses velocities.
pub trait LocalPlanner<P: PermittedMotion = AlwaysPermitted> {
    /// The velocity for the next period.
    fn command(&mut self, situation: &LocalSituation<'_, P>) -> LocalCommand;
}
