//! Follows a route of places by pure pursuit: corners are cut, and a place counts as met from half a metre.
//!
//! The steering law is that of [`PathFollower`](crate::path::PathFollower) (Coulter 1992): drive the arc that leads through a point on
//! the route at the look-ahead distance, curvature = 2·y/L². It knows no headings, no gears and no end of a piece, so that it
//! neither slows down nor gives up. A point far to the side is met by turning on a short arc first, because a
//! three-wheeled base with a steered front wheel can nearly pivot about its rear axle.

use floorguard_types::geometry::{Point2, Pose2, Twist2};
use heapless::Vec;

/// Waypoints of a route: a demo lap or a test drive; the cleaning planner feeds longer tours piece by piece.
pub const ROUTE_WAYPOINTS_MAX: usize = 64;

/// Waypoints in the odometry frame, metres.
#[derive(Clone, Debug, Default)]
pub struct Route {
    /// The points, in driving order.
    pub waypoints: Vec<Point2, ROUTE_WAYPOINTS_MAX>,
    /// Start over after the last one.
    pub repeat: bool,
}

/// How the route is driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RouteLimits {
    /// Cruising speed, m/s, > 0.
    pub speed_mps: f32,
    /// Greatest turning rate, rad/s, > 0.
    pub turn_radps: f32,
    /// Look-ahead distance, metres, > 0.
    pub look_ahead_m: f32,
    /// A waypoint counts as reached within this distance, metres.
    pub reached_m: f32,
}

impl Default for RouteLimits {
    /// A walking pace that leaves a scrubber's brake some reserve.
    fn default() -> Self {
        Self { speed_mps: 0.8, turn_radps: 0.6, look_ahead_m: 1.2, reached_m: 0.5 }
    }
}

/// Drives along a route.
#[derive(Clone, Debug)]
pub struct RouteFollower {
    route: Route,
    limits: RouteLimits,
    next: usize,
    previous: Option<Point2>,
}

impl RouteFollower {
    /// At the beginning of a route.
    #[must_use]
    pub const fn new(route: Route, limits: RouteLimits) -> Self {
        Self { route, limits, next: 0, previous: None }
    }

    /// The last waypoint was reached and the route does not repeat.
    #[must_use]
    pub fn finished(&self) -> bool {
        self.next >= self.route.waypoints.len()
    }

    /// The wanted command at a pose in the odometry frame; standing still when finished.
    pub fn wanted(&mut self, pose_in_odometry: Pose2) -> Twist2 {
        let Some(target) = self.advance(pose_in_odometry) else { return Twist2::ZERO };
        let aim = self.aim_point(pose_in_odometry, target);
        let in_robot = pose_in_odometry.inverse().transform(aim);
        let distance_m = in_robot.norm().max(0.05);
        let bearing_rad = libm::atan2f(in_robot.y_m, in_robot.x_m);
        if libm::fabsf(bearing_rad) > 0.9 {
            // The point lies far to the side: creep around it rather than on a wide arc.
            return Twist2 {
                linear_mps: 0.15,
                angular_radps: libm::copysignf(self.limits.turn_radps, bearing_rad),
            };
        }
        let curvature_per_m = 2.0 * in_robot.y_m / (distance_m * distance_m);
        Twist2::on_arc(curvature_per_m, self.limits.speed_mps, self.limits.turn_radps)
    }

    /// Skips waypoints that are reached; at most one full round per call.
    fn advance(&mut self, pose: Pose2) -> Option<Point2> {
        let here = Point2::new(pose.x_m, pose.y_m);
        for _ in 0..ROUTE_WAYPOINTS_MAX {
            let target = *self.route.waypoints.get(self.next)?;
            if here.distance(target) > self.limits.reached_m {
                self.previous.get_or_insert(here);
                return Some(target);
            }
            self.previous = Some(target);
            self.next = self.next.saturating_add(1);
            if self.route.repeat && self.next >= self.route.waypoints.len() {
                self.next = 0;
            }
        }
        None
    }

    /// The point on the leg to `target` that lies one look-ahead in front of the robot's foot point on that leg.
    fn aim_point(&self, pose: Pose2, target: Point2) -> Point2 {
        let start = self.previous.unwrap_or(Point2::new(pose.x_m, pose.y_m));
        let (dx_m, dy_m) = (target.x_m - start.x_m, target.y_m - start.y_m);
        let length_m = start.distance(target);
        if length_m < 0.05 {
            return target;
        }
        let (ux, uy) = (dx_m / length_m, dy_m / length_m);
        let along_m = (pose.x_m - start.x_m) * ux + (pose.y_m - start.y_m) * uy;
        let aim_m = (along_m.max(0.0) + self.limits.look_ahead_m).min(length_m);
        Point2::new(start.x_m + ux * aim_m, start.y_m + uy * aim_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn route(points: &[(f32, f32)], repeat: bool) -> Route {
        Route { waypoints: points.iter().map(|(x_m, y_m)| Point2::new(*x_m, *y_m)).collect(), repeat }
    }

    /// Integrates a perfect unicycle for `seconds` and gives where it ends.
    fn drive(follower: &mut RouteFollower, seconds: f32) -> Pose2 {
        let mut pose = Pose2::default();
        for _ in 0..(seconds / 0.05) as usize {
            let command = follower.wanted(pose);
            pose = pose.compose(Pose2::new(command.linear_mps * 0.05, 0.0, command.angular_radps * 0.05));
        }
        pose
    }

    #[test]
    fn reaches_end_of_square_and_stands() {
        let mut follower =
            RouteFollower::new(route(&[(5.0, 0.0), (5.0, 5.0), (0.0, 5.0)], false), RouteLimits::default());
        let pose = drive(&mut follower, 60.0);
        assert!(follower.finished());
        assert!(Point2::new(pose.x_m, pose.y_m).distance(Point2::new(0.0, 5.0)) < 0.6);
        assert_eq!(follower.wanted(pose), Twist2::ZERO);
    }

    #[test]
    fn empty_route_requests_nothing() {
        let mut follower = RouteFollower::new(route(&[], true), RouteLimits::default());
        assert_eq!(follower.wanted(Pose2::default()), Twist2::ZERO);
    }

    #[test]
    fn commands_stay_within_the_limits() {
        let limits = RouteLimits::default();
        let mut follower = RouteFollower::new(route(&[(-3.0, 0.1), (4.0, 4.0)], true), limits);
        let mut pose = Pose2::default();
        for _ in 0..2_000 {
            let command = follower.wanted(pose);
            assert!(command.linear_mps >= 0.0 && command.linear_mps <= limits.speed_mps);
            assert!(command.angular_radps.abs() <= limits.turn_radps + 1.0e-5);
            pose = pose.compose(Pose2::new(command.linear_mps * 0.05, 0.0, command.angular_radps * 0.05));
        }
    }
}
