//! The end of a path: near enough, the robot turns on the spot to the last heading, then stands.

use floorguard_types::geometry::{Point2, Pose2, Twist2, wrap_angle};
use floorguard_types::motion::Waypoint;

use super::contract::{LocalCommand, LocalVerdict};

/// When and how to arrive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// The goal counts as reached within, metres.
    pub within_m: f32,
    /// And within, radians; π or more: any heading.
    pub within_rad: f32,
    /// Turning on the spot: slowest and fastest, rad/s.
    pub turn_min_radps: f32,
    /// See `turn_min_radps`.
    pub turn_max_radps: f32,
}

impl Arrival {
    /// What to do at a pose; `None`: the goal is still to be driven to.
    #[must_use]
    pub fn command(&self, pose_in_map: Pose2, goal: &Waypoint) -> Option<LocalCommand> {
        let here = Point2::new(pose_in_map.x_m, pose_in_map.y_m);
        if goal.place_in_map().distance(here) > self.within_m {
            return None;
        }
        let turn_rad = wrap_angle(goal.pose_in_map.heading_rad - pose_in_map.heading_rad);
        if libm::fabsf(turn_rad) <= self.within_rad {
            return Some(LocalCommand::stand(LocalVerdict::Arrived));
        }
        let rate_radps = (2.0 * libm::fabsf(turn_rad)).clamp(self.turn_min_radps, self.turn_max_radps);
        let twist = Twist2 { linear_mps: 0.0, angular_radps: libm::copysignf(rate_radps, turn_rad) };
        Some(LocalCommand { twist, verdict: LocalVerdict::Driving })
    }
}
