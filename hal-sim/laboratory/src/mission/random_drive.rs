//! Driving at random: straight on until there is an obstacle, then in any other direction.

use floorguard_navigation::FollowConfig;
use floorguard_types::geometry::{Point2, Pose2, Twist2, wrap_angle};
use floorguard_types::random::Pcg32;

use floorguard_robot::site::Floor;

/// The strategy without a map.
pub struct RandomDrive {
    config: FollowConfig,
    random: Pcg32,
    heading_rad: f32,
}

impl RandomDrive {
    /// Straight on along x first.
    pub const fn new(config: FollowConfig, random: Pcg32) -> Self {
        Self { config, random, heading_rad: 0.0 }
    }

    /// What to do from a pose in the map frame for a period.
    pub fn twist(&mut self, floor: &Floor, pose: Pose2, period_s: f32) -> Twist2 {
        let error = wrap_angle(self.heading_rad - pose.heading_rad);
        if error.abs() > 0.05 {
            let rate = (error / period_s).clamp(-self.config.turn_radps, self.config.turn_radps);
            return Twist2 { linear_mps: 0.0, angular_radps: rate };
        }
        let ahead = |angle: f32| {
            let point = Point2::new(pose.x_m + 0.02 * angle.cos(), pose.y_m + 0.02 * angle.sin());
            floor.clearance.clearance_m(point)
        };
        let here = floor.clearance.clearance_m(Point2::new(pose.x_m, pose.y_m));
        // Stops 0.05 m before an obstacle; where it stands nearer, any escape path is good.
        let limit = floor.robot_radius_m + 0.05;
        let is_open = |angle: f32| ahead(angle) >= limit || ahead(angle) > here;
        if is_open(self.heading_rad) {
            return Twist2 { linear_mps: self.config.speed_mps, angular_radps: 0.0 };
        }
        for _ in 0..32 {
            let angle = self.random.uniform_between(-std::f32::consts::PI, std::f32::consts::PI);
            if is_open(angle) {
                self.heading_rad = angle;
                break;
            }
        }
        Twist2::ZERO
    }
}
