//! Where nothing is free any more: back out along the way the robot came, and think that place more expensive from
//! then on.

use floorguard_navigation::path::{FollowLimits, FollowState, PathFollower};
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::motion::{Gear, MovingPerson, Waypoint};

/// The way is kept so finely, metres.
const SPACING_M: f32 = 0.05;
/// The robot backs out so far, waypoints: half a metre.
const BACK: usize = 10;
/// Cycles in a row without a free velocity before it backs out.
const PATIENCE: u32 = 10;

/// The way the robot came, and how it backs out.
#[derive(Default)]
pub(super) struct Recovery {
    trail: Vec<Pose2>,
    blocked: u32,
    backing: Option<(Vec<Waypoint>, PathFollower)>,
    /// Places where it was stuck; as hills of cost.
    pub(super) stuck: Vec<MovingPerson>,
}

impl Recovery {
    /// The robot is here.
    pub(super) fn note(&mut self, pose: Pose2) {
        let is_new = self.trail.last().is_none_or(|last| {
            let (dx, dy) = (pose.x_m - last.x_m, pose.y_m - last.y_m);
            dx.hypot(dy) > SPACING_M
        });
        if is_new && self.backing.is_none() {
            self.trail.push(pose);
        }
    }

    /// The local planner found a velocity.
    pub(super) const fn free(&mut self) {
        self.blocked = 0;
    }

    /// It found none: stand, and after some cycles begin to back out.
    pub(super) fn blocked(&mut self, pose: Pose2) -> Twist2 {
        self.blocked += 1;
        if self.blocked > PATIENCE && self.trail.len() > 1 {
            self.blocked = 0;
            self.stuck.push(MovingPerson {
                position_in_map: floorguard_types::geometry::Point2::new(pose.x_m, pose.y_m),
                ..MovingPerson::default()
            });
            let back = self.trail.iter().rev().take(BACK + 1);
            let path = std::iter::once(&pose).chain(back);
            let path: Vec<Waypoint> =
                path.map(|at| Waypoint { pose_in_map: *at, gear: Gear::Back }).collect();
            let follower = PathFollower::new(&path);
            self.trail.truncate(self.trail.len().saturating_sub(BACK));
            self.backing = Some((path, follower));
        }
        Twist2::ZERO
    }

    /// While it backs out: the velocity.
    pub(super) fn backing(&mut self, pose: Pose2) -> Option<Twist2> {
        let (path, follower) = self.backing.as_mut()?;
        let limits =
            FollowLimits { look_ahead_m: 0.2, reached_m: 0.06, turn_radps: 1.0, ..FollowLimits::DEFAULT };
        if let FollowState::Drive(twist) = follower.follow(path, pose, &limits) {
            return Some(twist);
        }
        self.backing = None;
        None
    }
}
