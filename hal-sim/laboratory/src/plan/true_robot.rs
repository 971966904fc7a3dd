//! The simulated robot that a robot's file describes: its outline becomes a body, its sensors sit where they are mounted.

use floorguard_drivers::motor_drives::{MotorDrivesConfiguration, MotorProtocol};
use floorguard_drivers::ouster::{Beams, DataFormat};
use floorguard_perception::people::hangs;
use floorguard_runtime::configuration::{
    DriveTrain, ImuModel, LidarConfiguration, LidarModel, Mounting, RangingModel, RobotConfiguration,
    ScannerConfiguration, ScannerModel,
};
use floorguard_sim::motors::{MotorKind, MotorParameters};
use floorguard_sim::robot::{
    BodyPrism, BridgedScans, HokuyoModel, ImuDevice, LidarDevice, NodeIds, OusterDevice, OusterFormat,
    RobotParameters, RplidarModel, ScannerDevice, SensorMount, SickModel, Train,
};
use floorguard_types::geometry::{Point2, Point3};

/// What slows wheels without torque and without brakes, m/s².
const ROLLING_MPS2: f32 = 0.1;
/// How high the body is where the lidar does not say: this much below its mast, metres.
const MAST_M: f32 = 0.05;
/// A bumper strip reaches so far into the body and beyond it, metres.
const BUMPER_M: [f32; 2] = [0.05, 0.005];
/// The floor is felt for so far within the ends, metres.
const SWITCH_M: f32 = 0.02;

/// Everything that is fixed about a robot.
pub(super) fn true_robot(robot: &RobotConfiguration) -> RobotParameters {
    let default = RobotParameters::default();
    let (train, wheelbase_m, track_m) = wheels(robot);
    let can = &robot.can;
    let on_bus = |node: u8, default: u8| if node == 0 { default } else { node };
    let nodes = NodeIds {
        traction: on_bus(can.drive_node, default.nodes.traction),
        steering: on_bus(can.steering_node, default.nodes.steering),
        left_encoder: on_bus(can.left_encoder_node, default.nodes.left_encoder),
        right_encoder: on_bus(can.right_encoder_node, default.nodes.right_encoder),
        wheels: can.wheel_nodes,
        gateway: if robot.motors.is_some() {
            can.inputs_node
        } else {
            on_bus(can.inputs_node, default.nodes.gateway)
        },
        dirt_sensor: can.dirt_sensor_node.unwrap_or(default.nodes.dirt_sensor),
    };
    let ticks_per_m = match train {
        // The robot's file counts both wheels of a side together.
        Train::FourMecanum => 0.5 * robot.geometry.ticks_per_m,
        _ => robot.geometry.ticks_per_m,
    };
    let fitted = RobotParameters {
        lidar_device: lidar_device(&robot.lidar),
        lidar: if robot.has_lidar { mount(&robot.lidar.mounting) } else { default.lidar },
        scanner: mount(&robot.scanner.mounting),
        scanner_device: scanner_device(robot.scanner.model),
        rear_scanner: robot.rear_scanner.map(|scanner| mount(&scanner.mounting)),
        imu: robot.imu.map_or(default.imu, |imu| mount(&imu.mounting)),
        imu_device: match robot.imu.unwrap_or_default().model {
            ImuModel::XsensMti => ImuDevice::XsensMti,
            ImuModel::VectorNav => ImuDevice::VectorNav,
            ImuModel::Bridged => ImuDevice::Bridged,
        },
        train,
        wheelbase_m,
        track_m,
        ticks_per_m,
        steering_max_rad: match robot.train {
            DriveTrain::Ackermann { steering_max_rad } => steering_max_rad,
            _ => default.steering_max_rad,
        },
        nodes,
        motors: robot.motors.map(|motors| true_motors(&motors, robot.geometry.ticks_per_m)),
        // Rolling friction alone where nothing grips without power.
        brake_mps2: match robot.motors {
            Some(motors) if !motors.has_brakes => ROLLING_MPS2,
            _ => default.brake_mps2,
        },
        ..default
    };
    if fitted.footprint.as_slice() == robot.geometry.footprint.as_slice() {
        return fitted;
    }
    with_body(fitted, &robot.geometry.footprint)
}

/// The scanner that a robot's file names.
const fn scanner_device(model: ScannerModel) -> ScannerDevice {
    match model {
        ScannerModel::S300 => ScannerDevice::S300,
        ScannerModel::MicroScan3 { beams } => ScannerDevice::MicroScan3(beams),
        ScannerModel::Ranging(ranging) => match ranging {
            RangingModel::HokuyoUst => ScannerDevice::Hokuyo(HokuyoModel::Ust),
            RangingModel::HokuyoUrg04lx => ScannerDevice::Hokuyo(HokuyoModel::Urg04lx),
            RangingModel::SickTim5xx => ScannerDevice::Sick(SickModel::Tim5xx),
            RangingModel::SickLms1xx => ScannerDevice::Sick(SickModel::Lms1xx),
            RangingModel::RplidarA => ScannerDevice::Rplidar(RplidarModel::A),
            RangingModel::RplidarS => ScannerDevice::Rplidar(RplidarModel::S),
            RangingModel::Bridged(shape) => ScannerDevice::Bridged(BridgedScans {
                beams: shape.beams,
                first_udeg: shape.first_udeg,
                step_udeg: shape.step_udeg,
                period_us: shape.period_us,
                range_mm: shape.range_mm,
            }),
        },
    }
}

/// The lidar that a robot's file names.
fn lidar_device(lidar: &LidarConfiguration) -> LidarDevice {
    match lidar.model {
        LidarModel::PandarXt16 => LidarDevice::PandarXt16,
        LidarModel::PandarXt32 => LidarDevice::PandarXt32,
        LidarModel::Ouster(beams) => LidarDevice::Ouster(ouster(beams)),
        LidarModel::Bridged(elevations) => LidarDevice::Bridged(elevations),
        LidarModel::LivoxMid360(_) => LidarDevice::LivoxMid360 { hangs: hangs(&lidar.mounting.transform()) },
        _ => LidarDevice::Vlp16,
    }
}

/// The controllers that a robot's file describes, with the watchdogs that it asks for.
fn true_motors(motors: &MotorDrivesConfiguration, ticks_per_m: f32) -> MotorParameters {
    let kind = match motors.protocol {
        MotorProtocol::Odrive => MotorKind::Odrive,
        MotorProtocol::Vesc => MotorKind::Vesc,
        MotorProtocol::Roboteq => MotorKind::Roboteq,
        MotorProtocol::RoboteqCan => MotorKind::RoboteqCan,
        MotorProtocol::WheelLine => MotorKind::WheelLine,
    };
    MotorParameters {
        kind,
        wheels: motors.wheel_count(),
        nodes: motors.nodes,
        metres_per_turn: motors.metres_per_turn,
        counts_per_turn: match kind {
            // There a metre is a turn, and a robot's file counts both wheels of a side together.
            MotorKind::WheelLine if motors.wheels > 2 => 0.5 * ticks_per_m,
            MotorKind::WheelLine => ticks_per_m,
            _ => motors.counts_per_turn,
        },
        pole_pairs: motors.pole_pairs,
        watchdog_ms: u32::from(motors.watchdog_ms),
    }
}

/// The sensor that metadata describe, as the simulator has it.
fn ouster(beams: &'static Beams) -> OusterDevice {
    let used = |angles: &'static [i32]| &angles[..usize::from(beams.channels).min(angles.len())];
    OusterDevice {
        format: match beams.format {
            DataFormat::Legacy => OusterFormat::Legacy,
            DataFormat::Single => OusterFormat::Single,
            DataFormat::Dual => OusterFormat::Dual,
            DataFormat::LowRate => OusterFormat::LowRate,
        },
        columns_per_turn: beams.columns_per_turn,
        columns_per_packet: beams.columns_per_packet,
        altitude_mdeg: used(&beams.altitude_mdeg),
        azimuth_mdeg: used(&beams.azimuth_mdeg),
        beam_origin_um: beams.beam_origin_um,
    }
}

/// What the body rolls on, and between which points. A base that takes velocities and does not say how rolls as the example does.
fn wheels(robot: &RobotConfiguration) -> (Train, f32, f32) {
    let geometry = &robot.geometry;
    match robot.train {
        DriveTrain::Tricycle => (Train::FrontWheel, geometry.wheelbase_m, geometry.track_m),
        DriveTrain::Differential => (Train::TwoWheels, geometry.wheelbase_m, geometry.track_m),
        DriveTrain::Ackermann { .. } => (Train::RearAxle, geometry.wheelbase_m, geometry.track_m),
        DriveTrain::Omnidirectional { wheelbase_m, track_m } => (Train::FourMecanum, wheelbase_m, track_m),
    }
}

/// A sensor's place; a simulated one is level.
fn mount(mounting: &Mounting) -> SensorMount {
    let Point3 { x_m, y_m, z_m } = mounting.position;
    SensorMount { x_m, y_m, z_m, yaw_rad: mounting.yaw_rad }
}

/// A body over another outline, up to just below the lidar, which stands on a mast; bumpers and floor switches at its ends.
fn with_body(parameters: RobotParameters, outline: &[Point2]) -> RobotParameters {
    let hull = convex_hull(outline);
    let extent = |value: fn(&[f32; 2]) -> f32| {
        let values = hull.iter().map(value);
        values
            .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
    };
    let ([rear_m, front_m], [right_m, left_m]) = (extent(|[x, _]| *x), extent(|[_, y]| *y));
    let top_m = (parameters.lidar.z_m - MAST_M).max(parameters.scanner.z_m + 0.1);
    let prism = |name, [from_m, to_m]: [f32; 2], [low_m, high_m]: [f32; 2], height_m| BodyPrism {
        name,
        outline_m: vec![[from_m, low_m], [to_m, low_m], [to_m, high_m], [from_m, high_m]],
        height_m,
    };
    let lidar = parameters.lidar;
    let around = |middle_m: f32| [middle_m - 0.06, middle_m + 0.06];
    let mast = prism("lidar mast", around(lidar.x_m), around(lidar.y_m), [top_m, lidar.z_m + 0.08]);
    let [inside_m, outside_m] = BUMPER_M;
    let (across, bumper_m) = ([right_m, left_m], [0.04, 0.40_f32.min(top_m)]);
    let switches = |x_m: f32| [[x_m, 0.75 * left_m], [x_m, 0.75 * right_m]];
    RobotParameters {
        footprint: outline.to_vec(),
        body: vec![BodyPrism { name: "body", outline_m: hull, height_m: [0.02, top_m] }, mast],
        bumpers: [
            prism("front bumper", [front_m - inside_m, front_m + outside_m], across, bumper_m),
            prism("rear bumper", [rear_m - outside_m, rear_m + inside_m], across, bumper_m),
        ],
        floor_switches_m: [switches(front_m - SWITCH_M), switches(rear_m + SWITCH_M)],
        ..parameters
    }
}

/// The corners of the convex outline around points, counter-clockwise (Andrew 1979).
fn convex_hull(points: &[Point2]) -> Vec<[f32; 2]> {
    let mut sorted: Vec<[f32; 2]> = points.iter().map(|point| [point.x_m, point.y_m]).collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turns_left = |a: [f32; 2], b: [f32; 2], c: [f32; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    let half = |points: &mut dyn Iterator<Item = [f32; 2]>| {
        let mut chain: Vec<[f32; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = chain.as_slice()
                && !turns_left(*a, *b, point)
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let lower = half(&mut sorted.iter().copied());
    let upper = half(&mut sorted.iter().rev().copied());
    [lower, upper].concat()
}

fn is_level(scanner: &ScannerConfiguration) -> bool {
    is_upright(&scanner.mounting)
}

fn is_upright(mounting: &Mounting) -> bool {
    (mounting.roll_rad, mounting.pitch_rad) == (0.0, 0.0)
}

/// What no simulated robot has, and what to do.
pub(super) fn unplayable(own: &RobotConfiguration, example: &RobotConfiguration) -> Option<String> {
    let sensors = [
        ("lidar", !own.has_lidar || is_upright(&own.lidar.mounting)),
        ("scanner", is_level(&own.scanner)),
        ("rear_scanner", own.rear_scanner.as_ref().is_none_or(is_level)),
        ("imu", own.imu.is_none_or(|imu| is_upright(&imu.mounting))),
    ];
    if let Some((section, _)) = sensors.iter().find(|(_, is_playable)| !is_playable) {
        return Some(format!(
            "[{section}] is mounted at an angle, and the simulated sensors are level; write roll_deg = 0.0 and pitch_deg = 0.0"
        ));
    }
    let is_on_bus = own.can.inputs_node != 0;
    (is_on_bus && own.can.inputs != example.can.inputs).then(|| {
        "[inputs] is not that of the example robot, and the simulated safety controller has that image; copy [inputs] from robot.toml"
            .to_owned()
    })
}
