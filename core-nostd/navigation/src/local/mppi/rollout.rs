//! One sample played on the model: what it costs.

use floorguard_types::geometry::{Point2, Pose2, Twist2, wrap_angle};
use floorguard_types::motion::{Footprint, PermittedMotion, PlannedMotion};
use floorguard_types::number::nearest_f32;

use super::config::{MPPI_STEPS, MppiConfig};
use super::forecast::{Forecast, Place};
use super::path_left::PathLeft;
use crate::costmap::{CostmapView, Costs, Placement, outline_cost};

/// Nearer than this the true outline counts, metres.
const NEAR_M: f32 = 0.3;

/// A body of which nothing moves faster than this stands: people who walk into it do so by themselves, m/s.
const MOVES_MPS: f32 = 0.05;

/// What does not change from sample to sample.
pub(super) struct Stage<'a, P> {
    pub(super) config: &'a MppiConfig,
    pub(super) footprint: &'a Footprint,
    pub(super) costmap: CostmapView<'a>,
    pub(super) guard: &'a P,
    pub(super) path: PathLeft,
    pub(super) people: Forecast,
    pub(super) pose: Pose2,
    pub(super) twist: Twist2,
    pub(super) speed_limit_mps: f32,
}

/// What a sample came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Outcome {
    /// Seconds.
    pub(super) cost_s: f32,
    /// It touches nothing.
    pub(super) is_free: bool,
}

/// The robot of the model.
#[derive(Clone, Copy)]
struct Model {
    at: Placement,
    heading_rad: f32,
    twist: Twist2,
    /// The guard holds it for so long, seconds.
    held_s: f32,
}

impl Model {
    /// One step at a constant velocity: half the turn before the way, half after it.
    #[inline]
    fn step(&mut self, step_s: f32) {
        let half_rad = 0.5 * self.twist.angular_radps * step_s;
        let path_m = self.twist.linear_mps * step_s;
        let (sin, cos) = small_sincos(half_rad);
        let middle_sin = self.at.sin * cos + self.at.cos * sin;
        let middle_cos = self.at.cos * cos - self.at.sin * sin;
        self.at.x_m += path_m * middle_cos;
        self.at.y_m += path_m * middle_sin;
        self.at.sin = middle_sin * cos + middle_cos * sin;
        self.at.cos = middle_cos * cos - middle_sin * sin;
        self.heading_rad += 2.0 * half_rad;
    }
}

/// Sine and cosine by their series: exact to the last bit of a turn for angles up to 0.3.
#[inline]
fn small_sincos(angle_rad: f32) -> (f32, f32) {
    if libm::fabsf(angle_rad) > 0.3 {
        return libm::sincosf(angle_rad);
    }
    let square = angle_rad * angle_rad;
    let sin = angle_rad * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)));
    let cos = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)));
    (sin, cos)
}

impl<P: PermittedMotion> Stage<'_, P> {
    /// Plays requested velocities. A sample that touches something ends there, the more expensive the sooner.
    pub(super) fn play(&self, requests: &[Twist2; MPPI_STEPS]) -> Outcome {
        let config = self.config;
        let (sin, cos) = libm::sincosf(self.pose.heading_rad);
        let mut robot = Model {
            at: Placement { x_m: self.pose.x_m, y_m: self.pose.y_m, sin, cos },
            heading_rad: self.pose.heading_rad,
            twist: self.twist,
            held_s: 0.0,
        };
        let (mut cost_s, mut before) = (0.0, self.twist);
        for (step, request) in requests.iter().enumerate() {
            cost_s += self.change_cost(before, *request);
            before = *request;
            cost_s += self.advance(&mut robot, *request, step);
            match self.place_cost(&robot, step) {
                Some(place_s) => cost_s += place_s,
                None => {
                    let late = nearest_f32(step) / nearest_f32(MPPI_STEPS);
                    let hit_s = config.weights.collision * (2.0 - late) + libm::fabsf(robot.twist.linear_mps);
                    return Outcome { cost_s: cost_s + hit_s + self.end_cost(&robot), is_free: false };
                }
            }
        }
        Outcome { cost_s: cost_s + self.end_cost(&robot), is_free: true }
    }

    fn change_cost(&self, before: Twist2, request: Twist2) -> f32 {
        let weights = &self.config.weights;
        let (change_mps, change_radps) =
            (request.linear_mps - before.linear_mps, request.angular_radps - before.angular_radps);
        weights.speed_change * change_mps * change_mps + weights.turn_change * change_radps * change_radps
    }

    /// Moves by what the drive makes of a request and the guard permits of it; gives what that costs beside the time. A robot
    /// that the guard stops stands for as long as it is held.
    #[inline]
    fn advance(&self, robot: &mut Model, request: Twist2, step: usize) -> f32 {
        let config = self.config;
        if robot.held_s > 0.0 {
            robot.held_s -= config.step_s;
            return 0.0;
        }
        let limit_mps = self.speed_limit_mps;
        let request = Twist2 { linear_mps: request.linear_mps.clamp(-limit_mps, limit_mps), ..request };
        robot.twist = config.drive.reachable(robot.twist, request, config.step_s);
        let motion = PlannedMotion {
            pose_in_map: Pose2 { x_m: robot.at.x_m, y_m: robot.at.y_m, heading_rad: robot.heading_rad },
            twist: robot.twist,
            in_s: (nearest_f32(step) + 1.0) * config.step_s,
        };
        let permission = self.guard.permission(motion);
        if permission.held_s > 0.0 {
            (robot.twist, robot.held_s) = (Twist2::ZERO, permission.held_s - config.step_s);
            return config.weights.held;
        }
        if permission.share < 1.0 {
            // The guard keeps the curvature.
            robot.twist.linear_mps *= permission.share;
            robot.twist.angular_radps *= permission.share;
        }
        robot.step(config.step_s);
        if robot.twist.linear_mps < 0.0 { config.weights.reverse * config.step_s } else { 0.0 }
    }

    /// What a place costs; `None`: the robot touches something there.
    #[inline]
    fn place_cost(&self, robot: &Model, step: usize) -> Option<f32> {
        let config = self.config;
        let here = Point2::new(robot.at.x_m, robot.at.y_m);
        let mut cost = self.costmap.cost_at(here);
        if cost >= Costs::INSCRIBED {
            return None;
        }
        if cost >= config.clear_cost {
            cost = cost.max(outline_cost(self.costmap, self.footprint, robot.at).ok()?);
        }
        let mut cost_s = config.weights.nearness * config.step_s * f32::from(cost) / 252.0;
        for person in self.people.at(step) {
            cost_s += self.person_cost(robot, person)?;
        }
        Some(cost_s)
    }

    /// What a person nearby costs; `None`: the outline touches where the person most likely is, while the robot moves.
    #[inline]
    fn person_cost(&self, robot: &Model, person: Place) -> Option<f32> {
        let config = self.config;
        let (dx_m, dy_m) = (person.middle.x_m - robot.at.x_m, person.middle.y_m - robot.at.y_m);
        let spread_m = 0.3 + person.deviation_m;
        let around_m = self.footprint.circumscribed_radius_m() + config.person_radius_m;
        let squared_m2 = dx_m * dx_m + dy_m * dy_m;
        let reach_m = around_m + 2.5 * spread_m;
        if squared_m2 > reach_m * reach_m {
            return Some(0.0);
        }
        // Far from the body the circumscribed disc is near enough; it never says farther than it is.
        let far_m = libm::sqrtf(squared_m2) - around_m;
        let gap_m = if far_m > NEAR_M { far_m } else { self.gap_m(robot, Point2::new(dx_m, dy_m)) };
        // A corner of a long robot that turns on the spot moves as fast as one that drives.
        let rim_mps = libm::fabsf(robot.twist.angular_radps) * self.footprint.circumscribed_radius_m();
        let is_moving = libm::fabsf(robot.twist.linear_mps).max(rim_mps) > MOVES_MPS;
        if gap_m <= 0.0 && is_moving && person.deviation_m < 2.0 * config.person_radius_m {
            return None;
        }
        // The chance that the person is there falls as the doubt spreads over more floor.
        let share = 0.3 / spread_m;
        Some(
            config.weights.person
                * config.step_s
                * share
                * libm::expf(-gap_m * gap_m / (2.0 * spread_m * spread_m)),
        )
    }

    /// From the outline to a person, given relative to the robot in the axes of the map, metres.
    fn gap_m(&self, robot: &Model, relative: Point2) -> f32 {
        let (sin, cos) = (robot.at.sin, robot.at.cos);
        let in_base =
            Point2::new(cos * relative.x_m + sin * relative.y_m, cos * relative.y_m - sin * relative.x_m);
        if self.footprint.contains(in_base) {
            return 0.0;
        }
        (self.footprint.distance_to_edge_m(in_base) - self.config.person_radius_m).max(0.0)
    }

    /// What is left at the end.
    fn end_cost(&self, robot: &Model) -> f32 {
        let config = self.config;
        let left = self.path.from(Point2::new(robot.at.x_m, robot.at.y_m), wrap_angle(robot.heading_rad));
        let speed_mps = config.drive.speed_max_mps.min(self.speed_limit_mps).max(0.05);
        left.along_m / speed_mps
            + config.weights.off_path * left.off_m
            + config.weights.heading * left.turn_rad
    }
}
