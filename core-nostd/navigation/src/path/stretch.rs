//! Follows a path of straight stretches: the wanted command, which the guard still has to permit.
//!
//! Turns on the spot towards the next corner (a front-wheel-driven tricycle can, about the middle of its rear axle),
//! then drives straight and steers the remaining error away.

use floorguard_types::geometry::{Point2, Pose2, Twist2, wrap_angle};

/// Limits and gains of the follower.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowConfig {
    /// Speed on a straight stretch, m/s, > 0.
    pub speed_mps: f32,
    /// Turning rate on the spot, rad/s, > 0.
    pub turn_radps: f32,
    /// Heading error above which the robot stops and turns, radians.
    pub turn_first_rad: f32,
    /// Distance at which a corner counts as reached, metres.
    pub arrived_m: f32,
}

impl FollowConfig {
    /// The published robot (book, Cleaning: Published protocol).
    pub const ROOMBA: Self = Self { speed_mps: 0.1, turn_radps: 0.6, turn_first_rad: 0.15, arrived_m: 0.012 };
}

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Following {
    /// Drive like this.
    Drive(Twist2),
    /// The corner is reached, or lies behind.
    Arrived,
}

/// A straight stretch of a path, map frame, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Where it begins.
    pub from: Point2,
    /// Where it ends.
    pub to: Point2,
}

/// The wanted command from a pose towards the end of a stretch, all in the map frame. `period_s` is
/// the time for which the command will hold, > 0: it keeps the robot from overshooting.
///
/// ```
/// use floorguard_navigation::{FollowConfig, Following, Stretch, follow};
/// use floorguard_types::geometry::{Point2, Pose2};
///
/// let stretch = Stretch { from: Point2::new(0.0, 0.0), to: Point2::new(1.0, 0.0) };
/// let command = |pose| follow(pose, stretch, &FollowConfig::ROOMBA, 0.1);
/// let Following::Drive(twist) = command(Pose2::default()) else { panic!("a command") };
/// assert_eq!((twist.linear_mps, twist.angular_radps), (0.1, 0.0));
/// let Following::Drive(turn) = command(Pose2::new(0.0, 0.0, 2.0)) else { panic!("a command") };
/// assert_eq!((turn.linear_mps, turn.angular_radps), (0.0, -0.6));
/// assert_eq!(command(Pose2::new(1.0, 0.0, 0.0)), Following::Arrived);
/// ```
#[must_use]
pub fn follow(pose_in_map: Pose2, stretch: Stretch, config: &FollowConfig, period_s: f32) -> Following {
    let Stretch { from, to } = stretch;
    let here = Point2::new(pose_in_map.x_m, pose_in_map.y_m);
    let left_m = here.distance(to);
    let length_m = from.distance(to).max(1e-6);
    let (ux, uy) = ((to.x_m - from.x_m) / length_m, (to.y_m - from.y_m) / length_m);
    let along_m = (to.x_m - here.x_m) * ux + (to.y_m - here.y_m) * uy;
    let is_behind = along_m <= config.arrived_m && left_m < 0.1;
    if left_m <= config.arrived_m || is_behind || !left_m.is_finite() {
        return Following::Arrived;
    }
    let period_s = period_s.max(1e-3);
    // Aim at a point of the line a little ahead, so that the robot comes back to the line and not only to its end.
    let ahead_m = (along_m - 0.15).max(0.0);
    let aim = Point2::new(to.x_m - ux * ahead_m, to.y_m - uy * ahead_m);
    let bearing = libm::atan2f(aim.y_m - here.y_m, aim.x_m - here.x_m);
    let error = wrap_angle(bearing - pose_in_map.heading_rad);
    let limit = config.turn_radps;
    if libm::fabsf(error) > config.turn_first_rad {
        let rate = (error / period_s).clamp(-limit, limit);
        return Following::Drive(Twist2 { linear_mps: 0.0, angular_radps: rate });
    }
    Following::Drive(Twist2 {
        linear_mps: config.speed_mps.min(left_m / period_s),
        angular_radps: (2.0 * error).clamp(-limit, limit),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drives_a_corner_and_arrives() {
        let corners = [Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(1.0, 0.8)];
        let mut pose = Pose2::new(0.0, 0.02, 2.0);
        let mut corner = 0;
        for _ in 0..600 {
            let stretch = Stretch { from: corners[corner], to: corners[corner + 1] };
            match follow(pose, stretch, &FollowConfig::ROOMBA, 0.1) {
                Following::Drive(twist) => {
                    assert!(twist.linear_mps <= 0.1 + 1e-6 && twist.angular_radps.abs() <= 0.6 + 1e-6);
                    pose = pose.compose(Pose2::new(twist.linear_mps * 0.1, 0.0, twist.angular_radps * 0.1));
                }
                Following::Arrived => {
                    corner += 1;
                    if corner == 2 {
                        break;
                    }
                }
            }
        }
        assert_eq!(corner, 2);
        assert!(Point2::new(pose.x_m, pose.y_m).distance(corners[2]) < 0.03);
    }

    #[test]
    fn an_undefined_target_does_not_move_the_robot() {
        let stretch = Stretch { from: Point2::default(), to: Point2::new(f32::NAN, 0.0) };
        assert_eq!(follow(Pose2::default(), stretch, &FollowConfig::ROOMBA, 0.1), Following::Arrived);
    }
}
