//! What is forbidden after a change of sign, and what a trajectory adds up to.

use floorguard_types::geometry::{Pose2, Twist2, wrap_angle};

use super::dwa_config::DwaConfig;

/// Costs of one trajectory, before weights; all in cells or cost units, ≥ 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DwaScore {
    /// Highest cost under the outline.
    pub obstacle: f32,
    /// Steps to the path at the last pose.
    pub path: f32,
    /// Steps to the local goal at the last pose.
    pub goal: f32,
    /// Steps to the path at the nose of the last pose.
    pub alignment: f32,
    /// Steps to the local goal at the nose of the last pose.
    pub goal_front: f32,
    /// Turning rate, rad/s.
    pub twirling: f32,
}

impl DwaScore {
    /// The weighted sum, with biases for a cell of this edge.
    #[must_use]
    pub fn total(&self, config: &DwaConfig, resolution_m: f32) -> f32 {
        let (path, goal) = (config.path_bias * resolution_m, config.goal_bias * resolution_m);
        config.obstacle_scale * self.obstacle
            + goal * self.goal_front
            + path * self.alignment
            + path * self.path
            + goal * self.goal
            + config.twirling_scale * self.twirling
    }
}

/// Signs that are forbidden: after a change of sign the old one, until the robot has moved on (`OscillationCostFunction`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Oscillation {
    forward_forbidden: bool,
    backward_forbidden: bool,
    left_forbidden: bool,
    right_forbidden: bool,
    last: Twist2,
    since: Option<Pose2>,
}

impl Oscillation {
    /// The velocity goes against a forbidden sign.
    #[must_use]
    pub fn forbids(&self, twist: Twist2) -> bool {
        (self.forward_forbidden && twist.linear_mps > 0.0)
            || (self.backward_forbidden && twist.linear_mps < 0.0)
            || (self.left_forbidden && twist.angular_radps > 0.0)
            || (self.right_forbidden && twist.angular_radps < 0.0)
    }

    /// Takes note of the velocity that was chosen at a pose.
    pub fn note(&mut self, config: &DwaConfig, twist: Twist2, pose_in_map: Pose2) {
        if let Some(since) = self.since {
            let travel = floorguard_types::geometry::Point2::new(
                pose_in_map.x_m - since.x_m,
                pose_in_map.y_m - since.y_m,
            );
            let turn_rad = wrap_angle(pose_in_map.heading_rad - since.heading_rad);
            if travel.norm() > config.oscillation_reset_m
                || libm::fabsf(turn_rad) > config.oscillation_reset_rad
            {
                *self = Self { last: self.last, ..Self::default() };
            }
        }
        let before = *self;
        let flips = |old: f32, new: f32| old * new < 0.0;
        if flips(self.last.linear_mps, twist.linear_mps) {
            self.forward_forbidden = twist.linear_mps < 0.0;
            self.backward_forbidden = twist.linear_mps > 0.0;
        }
        // Published: turning counts only where the robot does not drive.
        let is_turning = libm::fabsf(twist.linear_mps) <= config.translation_min_mps;
        if is_turning && flips(self.last.angular_radps, twist.angular_radps) {
            self.left_forbidden = twist.angular_radps < 0.0;
            self.right_forbidden = twist.angular_radps > 0.0;
        }
        if *self != before {
            self.since = Some(pose_in_map);
        }
        let keep = |old: f32, new: f32| if new == 0.0 { old } else { new };
        self.last = Twist2 {
            linear_mps: keep(self.last.linear_mps, twist.linear_mps),
            angular_radps: if is_turning { keep(self.last.angular_radps, twist.angular_radps) } else { 0.0 },
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sign_change_forbids_old_sign_until_motion() {
        let config = DwaConfig::PUBLISHED;
        let turn = |angular_radps| Twist2 { linear_mps: 0.0, angular_radps };
        let mut oscillation = Oscillation::default();
        oscillation.note(&config, turn(0.5), Pose2::default());
        assert!(!oscillation.forbids(turn(0.5)) && !oscillation.forbids(turn(-0.5)));
        oscillation.note(&config, turn(-0.5), Pose2::default());
        assert!(oscillation.forbids(turn(0.5)) && !oscillation.forbids(turn(-0.5)));
        oscillation.note(&config, turn(-0.5), Pose2::new(0.0, 0.0, -0.1));
        assert!(oscillation.forbids(turn(0.5)));
        oscillation.note(&config, turn(-0.5), Pose2::new(0.0, 0.0, -0.25));
        assert!(!oscillation.forbids(turn(0.5)));
    }

    #[test]
    fn weights_are_the_published_ones() {
        let score = DwaScore {
            obstacle: 100.0,
            path: 10.0,
            goal: 20.0,
            alignment: 5.0,
            goal_front: 8.0,
            twirling: 1.0,
        };
        // 0.01·100 + 0.05·(0.8·8 + 0.6·5 + 0.6·10 + 0.8·20)
        assert!((score.total(&DwaConfig::PUBLISHED, 0.05) - 2.57).abs() < 1e-5);
    }
}
