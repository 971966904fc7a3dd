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

/// Cost of a path among people: the guard lets the robot go more slowly there, and its front wheel no faster than in
/// the slowest fields while it turns on the spot. What is gone back must be gone ahead again before the guard lets the
/// robot turn faster than beside a rear that no sensor has seen (FG-REQ-064).
pub(super) fn among_people(robot: &RobotConfiguration, pace: Pace) -> Pace {
    let slow_mps = robot.thresholds.warning_speed_mps;
    let back_s_per_m = 1.0 / pace.reverse_mps.max(0.05) + 1.0 / robot.unseen.unknown_rear_mps.max(0.05);
    Pace {
        speed_mps: pace.speed_mps.min(2.0 * slow_mps),
        turn_radps: pace.turn_radps.min(slow_mps / robot.geometry.wheelbase_m),
        reverse_mps: 1.0 / back_s_per_m,
        ..pace
    }
}
