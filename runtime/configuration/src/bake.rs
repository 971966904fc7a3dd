//! The checked configuration as Rust source, for boards that have no file system: their build script writes it to a
//! file that the firmware includes.

use std::fmt::Write;

use floorguard_drivers::flexisoft::InputBits;
use floorguard_guard::{Action, Thresholds};
use floorguard_runtime::configuration::{DriveTrain, FieldPair, LidarModel, Mounting, RobotConfiguration};
use floorguard_types::geometry::Point2;

/// A function `robot()` that gives the same configuration. Numbers are written with all their digits.
#[must_use]
pub fn bake(robot: &RobotConfiguration) -> String {
    let mut code =
        String::from("/// The robot that `robot.toml` describes.\npub fn robot() -> RobotConfiguration {\n");
    code.push_str("    RobotConfiguration {\n");
    let mut line = |name: &str, value: String| {
        let _ = writeln!(code, "        {name}: {value},");
    };
    let geometry = &robot.geometry;
    line(
        "geometry",
        format!(
            "Geometry {{ footprint: {}, wheelbase_m: {:?}, track_m: {:?}, ticks_per_m: {:?}, wheel_lever_m: {:?} }}",
            points(&geometry.footprint),
            geometry.wheelbase_m,
            geometry.track_m,
            geometry.ticks_per_m,
            geometry.wheel_lever_m
        ),
    );
    // These print as valid Rust by themselves: structures of numbers and plain variants.
    line("limits", format!("{:?}", robot.limits));
    line("deadlines", format!("{:?}", robot.deadlines));
    line("base", format!("BaseKind::{:?}", robot.base));
    line("train", train(robot).to_owned());
    line("has_lidar", robot.has_lidar.to_string());
    line(
        "lidar",
        format!(
            "LidarConfiguration {{ model: {}, mounting: {} }}",
            lidar_model(robot.lidar.model),
            mounting(&robot.lidar.mounting)
        ),
    );
    line(
        "scanner",
        format!(
            "ScannerConfiguration {{ model: ScannerModel::{:?}, mounting: {}, sector_rad: {:?} }}",
            robot.scanner.model,
            mounting(&robot.scanner.mounting),
            robot.scanner.sector_rad
        ),
    );
    line("rear_scanner", rear_scanner(robot).to_owned());
    line("imu", imu(robot));
    // Motor controllers other than CiA 402 drives belong to bases that a board refuses.
    line("motors", "None".to_owned());
    line("can", can(robot));
    let fields: Vec<String> = robot.fields.iter().map(field).collect();
    line("fields", format!("list(&[{}])", fields.join(", ")));
    let route = &robot.route;
    line("route", format!("Route {{ waypoints: {}, repeat: {} }}", points(&route.waypoints), route.repeat));
    line("route_limits", format!("{:?}", robot.route_limits));
    line("thresholds", thresholds(&robot.thresholds));
    line("unseen", format!("{:?}", robot.unseen));
    code.push_str("    }\n}\n");
    code
}

/// A board decodes the lidars of the Velodyne family.
fn lidar_model(model: LidarModel) -> String {
    match model {
        LidarModel::PandarXt16
        | LidarModel::PandarXt32
        | LidarModel::Ouster(_)
        | LidarModel::Bridged(_)
        | LidarModel::LivoxMid360(_) => {
            "compile_error!(\"[lidar]: a microcontroller decodes lidars of the Velodyne family alone\")"
                .to_owned()
        }
        model => format!("LidarModel::{model:?}"),
    }
}

/// The inertial sensor.
fn imu(robot: &RobotConfiguration) -> String {
    robot.imu.map_or("None".to_owned(), |imu| {
        format!(
            "Some(ImuConfiguration {{ model: ImuModel::{:?}, mounting: {} }})",
            imu.model,
            mounting(&imu.mounting)
        )
    })
}

/// A program for a board is not compiled with a second one: the memory for its table is missing.
fn rear_scanner(robot: &RobotConfiguration) -> &'static str {
    match robot.rear_scanner {
        Some(_) => {
            "compile_error!(\"[rear_scanner]: a microcontroller lacks the memory for a second safety scanner\")"
        }
        None => "None",
    }
}

/// The tasks of a board are those of a tricycle.
fn train(robot: &RobotConfiguration) -> &'static str {
    match robot.train {
        DriveTrain::Tricycle => "DriveTrain::Tricycle",
        _ => {
            "compile_error!(\"[base]: a microcontroller drives a tricycle; every other base needs a Linux computer\")"
        }
    }
}

fn points(points: &[Point2]) -> String {
    let corners: Vec<String> =
        points.iter().map(|point| format!("Point2::new({:?}, {:?})", point.x_m, point.y_m)).collect();
    format!("list(&[{}])", corners.join(", "))
}

fn mounting(mounting: &Mounting) -> String {
    format!("{mounting:?}")
}

fn field(field: &FieldPair) -> String {
    format!(
        "FieldPair {{ direction: DirectionOfTravel::{:?}, speed_max_mps: {:?}, protective: {}, warning: {} }}",
        field.direction,
        field.speed_max_mps,
        points(&field.protective),
        points(&field.warning)
    )
}

fn can(robot: &RobotConfiguration) -> String {
    let can = &robot.can;
    let bits = |bits: InputBits| format!("{bits:?}");
    let fitted =
        |input: Option<InputBits>| input.map_or("None".to_owned(), |input| format!("Some({})", bits(input)));
    format!(
        "CanConfiguration {{ wheel_nodes: {:?}, drive_node: {}, steering_node: {}, left_encoder_node: {}, right_encoder_node: {}, \
         inputs_node: {}, dirt_sensor_node: {:?}, inputs: InputMap {{ emergency_stop: {}, bumper_front: {}, bumper_rear: {}, cliff_front: {}, \
         cliff_rear: {}, discrepancy_us: {} }}, buttons: {:?} }}",
        can.wheel_nodes,
        can.drive_node,
        can.steering_node,
        can.left_encoder_node,
        can.right_encoder_node,
        can.inputs_node,
        can.dirt_sensor_node,
        bits(can.inputs.emergency_stop),
        bits(can.inputs.bumper_front),
        fitted(can.inputs.bumper_rear),
        fitted(can.inputs.cliff_front),
        fitted(can.inputs.cliff_rear),
        can.inputs.discrepancy_us,
        can.buttons
    )
}

fn thresholds(thresholds: &Thresholds) -> String {
    let action = match thresholds.emergency_action {
        Action::Category1 => "Category1",
        _ => "Category0",
    };
    let text = format!("{thresholds:?}");
    text.replace(&format!("emergency_action: {action}"), &format!("emergency_action: Action::{action}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    #[test]
    fn example_numbers_come_from_the_source() {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let source = bake(&robot);
        for text in ["speed_mps: 1.0", "braking_mps2: 0.8", "Point2::new(", "Action::Category0"] {
            assert!(source.contains(text), "{text} is missing in\n{source}");
        }
    }
}
