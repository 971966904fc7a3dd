//! Why a robot does not come forward, in words.

use crate::global::PlanFailure;

/// Why the robot does not come forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstruction {
    /// The global planner finds no path.
    NoPath(PlanFailure),
    /// The local planner finds no velocity that touches nothing.
    NoVelocity,
    /// The local planner prefers to stand.
    Yields,
    /// The guard permits less than is requested: it holds the robot.
    Held,
    /// The robot does not know where it is.
    Lost,
}

impl core::fmt::Display for Obstruction {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NoPath(failure) => write!(formatter, "{failure}"),
            Self::NoVelocity => write!(formatter, "every motion from here would touch something"),
            Self::Yields => {
                write!(formatter, "a person or an obstacle makes every motion worse than standing")
            }
            Self::Held => write!(formatter, "the guard holds the robot"),
            Self::Lost => write!(formatter, "the robot is looking for its place on the map"),
        }
    }
}
