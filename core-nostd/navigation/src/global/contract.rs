//! The contract of all global planners.

use floorguard_types::geometry::Pose2;
use floorguard_types::motion::Waypoint;

use crate::costmap::CostmapView;

/// From where to where, on which costs.
#[derive(Clone, Copy, Debug)]
pub struct PlanRequest<'a> {
    /// What it costs to drive where.
    pub costmap: CostmapView<'a>,
    /// Where the robot is.
    pub start_in_map: Pose2,
    /// Where it shall be. Planners that know no headings ignore this one's.
    pub goal_in_map: Pose2,
    /// If the goal cannot be reached, a place at most this far from it will do, metres.
    pub tolerance_m: f32,
}

/// A path that was found; its waypoints are in the caller's buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// How many waypoints were written.
    pub waypoints: usize,
    /// What it costs, in the planner's own unit.
    pub cost: f32,
    /// Revision of the costmap that it rests on.
    pub costmap_revision: u32,
}

/// Why there is no path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanFailure {
    /// The start lies outside the costmap, or farther than 0.3 m from every place where the robot can stand.
    StartBlocked,
    /// No place within the tolerance of the goal can be stood on.
    GoalBlocked,
    /// Start and goal are not connected.
    Unreachable,
    /// The caller's buffer has room for fewer waypoints than the path has: this many.
    PathTooLong(usize),
    /// The planner's own storage was too small for this costmap or this search.
    OutOfRoom,
}

impl core::fmt::Display for PlanFailure {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::StartBlocked => {
                write!(formatter, "the robot stands within an obstacle or outside of the map")
            }
            Self::GoalBlocked => write!(formatter, "the goal lies within an obstacle or outside of the map"),
            Self::Unreachable => write!(formatter, "no path leads to the goal"),
            Self::PathTooLong(waypoints) => {
                write!(formatter, "the path has {waypoints} waypoints, beyond the capacity")
            }
            Self::OutOfRoom => {
                write!(formatter, "the map or the search is larger than the planner's storage")
            }
        }
    }
}

impl core::error::Error for PlanFailure {}

/// Finds paths.
pub trait GlobalPlanner {
    /// Writes a path from start to goal into `path`, first waypoint at the start.
    ///
    /// # Errors
    /// See [`PlanFailure`]. What `path` holds then is not a path.
    fn plan(&mut self, request: &PlanRequest<'_>, path: &mut [Waypoint]) -> Result<Plan, PlanFailure>;
}
