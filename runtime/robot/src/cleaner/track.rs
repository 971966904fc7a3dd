//! Drives a path of the lattice: forward pieces by pure pursuit, turns on the spot, backwards pieces straight.

use floorguard_navigation::global::Pace;
use floorguard_navigation::path::{Backing, FollowLimits, FollowState, PathFollower};
use floorguard_types::geometry::Pose2;
use floorguard_types::motion::Waypoint;

/// A path being driven.
#[derive(Clone, Debug, Default)]
pub struct Track {
    path: Vec<Waypoint>,
    follower: PathFollower,
}

impl Track {
    /// A path from its first waypoint, where the robot is.
    pub fn new(path: Vec<Waypoint>) -> Self {
        Self { follower: PathFollower::new(&path), path }
    }

    /// Nothing is left to drive.
    pub fn is_over(&self) -> bool {
        self.follower.is_over(&self.path)
    }

    /// What is still to be driven.
    pub fn rest(&self) -> &[Waypoint] {
        self.path.get(self.follower.next()..).unwrap_or(&[])
    }

    /// What to do from a pose in the map frame.
    pub fn follow(&mut self, pose: Pose2, pace: &Pace) -> FollowState {
        let limits = FollowLimits {
            speed_mps: pace.speed_mps,
            reverse_mps: pace.reverse_mps,
            turn_radps: pace.turn_radps,
            backing: Backing::Heading,
            ..FollowLimits::DEFAULT
        };
        self.follower.follow(&self.path, pose, &limits)
    }
}
