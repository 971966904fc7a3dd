//! How fast the mission drives, and how fast its plans take it to be among people.

use floorguard_navigation::global::Pace;
use floorguard_runtime::configuration::RobotConfiguration;

use super::path_finder::{ARC_M, HASTE, STEP_M};

/// How fast the mission drives: carefully, whatever the robot may do.
pub(super) fn pace_of(robot: &RobotConfiguration) -> Pace {
    Pace {
        speed_mps: robot.route_limits.speed_mps.min(0.7),
        turn_radps: robot.route_limits.turn_radps,
        reverse_mps: robot.limits.reverse_mps.min(0.2),
        change_s: 1.2,
        step_m: STEP_M,
        arc_m: ARC_M,
        haste: HASTE,
    }
}

/// Cost of a path among people: the guard lets the robot go more slowly there, and the fastest point of a body that turns no faster than
/// it lets a robot go near people, or beside a rear that no sensor has seen (FG-REQ-064): half of the turns are of either kind. What is
/// gone back must be gone ahead again before the rear is known.
pub(super) fn among_people(robot: &RobotConfiguration, pace: Pace) -> Pace {
    let slow_mps = robot.thresholds.warning_speed_mps.max(0.05);
    let unknown_mps = robot.unseen.unknown_rear_mps.clamp(0.05, slow_mps);
    let is_unseen = robot.unseen.known_after_m > 0.0;
    let fastest_mps = if is_unseen { 2.0 / (1.0 / slow_mps + 1.0 / unknown_mps) } else { slow_mps };
    let corners = robot.geometry.footprint.iter().map(|corner| corner.norm());
    let back_s_per_m = 1.0 / pace.reverse_mps.max(0.05) + 1.0 / robot.unseen.unknown_rear_mps.max(0.05);
    Pace {
        speed_mps: pace.speed_mps.min(2.0 * slow_mps),
        turn_radps: pace.turn_radps.min(fastest_mps / corners.fold(0.1, f32::max)),
        reverse_mps: 1.0 / back_s_per_m,
        ..pace
    }
}
