//! Sensors that are not where the robot's file says.

use crate::robot::{RobotParameters, SensorMount};
use crate::scenario::{MisplacedFile, Scenario};

fn moved(mount: SensorMount, by: Option<MisplacedFile>) -> SensorMount {
    let by = by.unwrap_or_default();
    SensorMount {
        x_m: mount.x_m + by.x_m,
        y_m: mount.y_m + by.y_m,
        z_m: mount.z_m + by.z_m,
        yaw_rad: mount.yaw_rad + by.yaw_deg.to_radians(),
    }
}

/// The robot as the scenario has it mounted.
pub(super) fn mounted(scenario: &Scenario, parameters: RobotParameters) -> RobotParameters {
    RobotParameters {
        lidar: moved(parameters.lidar, scenario.lidar_misplaced),
        scanner: moved(parameters.scanner, scenario.scanner_misplaced),
        ..parameters
    }
}
