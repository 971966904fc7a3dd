//! What the true path of a body says of it: how far it left its route, and how fast it was.

use floorguard_types::geometry::{Point2, Pose2};

use crate::judge::distance_to_edge_m;
use crate::plan::Plan;
use crate::world::{Observation, PATH_US};

/// Above the greatest speed of its file by this share the body is too fast.
const SPEEDING: f32 = 1.15;
/// Above its warning speed by this it is fast, m/s.
const FAST_MPS: f32 = 0.1;
/// Between two poses of the path, seconds.
const STEP_S: f32 = PATH_US as f32 * 1.0e-6;

/// The farthest that the body came from its route, metres. The route begins where the robot does, in the middle of the hall.
pub fn stray_m(plan: &Plan, seen: &Observation) -> f32 {
    let waypoints = plan.robot.route.waypoints.iter().map(|place| Point2::new(place.x_m, place.y_m));
    let corners: Vec<Point2> = std::iter::once(Point2::default()).chain(waypoints).collect();
    let to_route = |pose: &Pose2| {
        let place = Point2::new(pose.x_m, pose.y_m);
        let legs = corners.windows(2).map(|leg| distance_to_edge_m(place, leg[0], leg[1]));
        legs.fold(f32::INFINITY, f32::min)
    };
    seen.robot_path.iter().map(to_route).fold(0.0, f32::max)
}

/// How long the body was faster than its file permits at all, seconds.
pub fn too_fast_s(plan: &Plan, seen: &Observation) -> f32 {
    let limit_m = SPEEDING * plan.robot.limits.speed_mps * STEP_S;
    let steps =
        seen.robot_path.windows(2).map(|pair| (pair[1].x_m - pair[0].x_m).hypot(pair[1].y_m - pair[0].y_m));
    steps.filter(|step_m| *step_m > limit_m).count() as f32 * STEP_S
}

/// How far along the hall the body was still faster than in its warning field, metres.
pub fn fast_until_m(plan: &Plan, seen: &Observation) -> f32 {
    let limit_m = (plan.robot.thresholds.warning_speed_mps + FAST_MPS) * STEP_S;
    let fast = seen.robot_path.windows(2).filter(|pair| (pair[1].x_m - pair[0].x_m).abs() > limit_m);
    fast.map(|pair| pair[1].x_m).fold(f32::NEG_INFINITY, f32::max)
}
