//! Sizes, masses and mountings of the simulated robot; by default those of the example `robot.toml`.

use floorguard_types::geometry::Point2;

use super::brush_deck::BrushDeck;
use crate::motors::MotorParameters;
use crate::wire::OusterFormat;

/// Where a sensor sits, robot frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorMount {
    /// Forward, metres.
    pub x_m: f32,
    /// Left, metres.
    pub y_m: f32,
    /// Up, metres.
    pub z_m: f32,
    /// Counter-clockwise, radians.
    pub yaw_rad: f32,
}

/// Node numbers on the CAN bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeIds {
    /// Traction drive.
    pub traction: u8,
    /// Steering drive.
    pub steering: u8,
    /// Encoder of the left rear wheel.
    pub left_encoder: u8,
    /// Encoder of the right rear wheel.
    pub right_encoder: u8,
    /// Drives of the wheels of a base without a steered one: left and right, or front left, front right, rear left, rear right; 0
    /// where there is none.
    pub wheels: [u8; 4],
    /// Gateway of the safety controller; 0: there is none.
    pub gateway: u8,
    /// Dirt sensor.
    pub dirt_sensor: u8,
}

/// A part of the robot's true body: an upright prism.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyPrism {
    /// What it is.
    pub name: &'static str,
    /// Corners of a convex outline, counter-clockwise, robot frame, metres.
    pub outline_m: Vec<[f32; 2]>,
    /// Lower and upper face above the floor, metres.
    pub height_m: [f32; 2],
}

/// Which lidar it carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LidarDevice {
    /// VLP-16: two firings of sixteen lasers each 110.592 µs.
    #[default]
    Vlp16,
    /// PandarXT-16: a firing of sixteen lasers each 50 µs.
    PandarXt16,
    /// PandarXT-32: thirty-two lasers.
    PandarXt32,
    /// An Ouster.
    Ouster(OusterDevice),
    /// Any lidar of sixteen rings behind a bridge; elevations in thousandths of a degree, the lowest first.
    Bridged(&'static [i32; 16]),
    /// Livox Mid-360: points all over its field of view.
    LivoxMid360 {
        /// On its head.
        hangs: bool,
    },
}

/// What an Ouster is: angles in thousandths of a degree, one of each a beam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OusterDevice {
    /// Its packets.
    pub format: OusterFormat,
    /// Columns of a turn.
    pub columns_per_turn: u16,
    /// Columns of a packet.
    pub columns_per_packet: u8,
    /// Elevations.
    pub altitude_mdeg: &'static [i32],
    /// Azimuths from that of the column, clockwise.
    pub azimuth_mdeg: &'static [i32],
    /// From the axis to where the beams leave, micrometres.
    pub beam_origin_um: u32,
}

/// Which Hokuyo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HokuyoModel {
    /// UST-10LX: 1,081 beams.
    Ust,
    /// URG-04LX: 682 beams.
    Urg04lx,
}

/// Which SICK that is no safety scanner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SickModel {
    /// TiM561: 811 beams, 15 turns a second, a third of a degree.
    Tim5xx,
    /// LMS111: 541 beams, 50 turns a second, half a degree.
    Lms1xx,
}

/// Which RPLidar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RplidarModel {
    /// A2: 4,000 samples a second, ten turns.
    A,
    /// S2: 16,000 samples a second, ten turns.
    S,
}

/// Which scanner it carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ScannerDevice {
    /// S300: 541 beams over 270°.
    #[default]
    S300,
    /// microScan3: so many beams over 275°.
    MicroScan3(u16),
    /// A Hokuyo, which is no safety scanner.
    Hokuyo(HokuyoModel),
    /// A TiM or an LMS of SICK, which is none either.
    Sick(SickModel),
    /// An RPLidar, which is none either.
    Rplidar(RplidarModel),
    /// Any scanner behind a bridge, which makes it none either.
    Bridged(BridgedScans),
}

/// What a bridge sends: beams, their angles in millionths of a degree, the period, and the distances that are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BridgedScans {
    /// Beams of a scan.
    pub beams: u16,
    /// Angle of the first one, counter-clockwise from straight ahead.
    pub first_udeg: i32,
    /// From beam to beam.
    pub step_udeg: u32,
    /// From scan to scan, microseconds.
    pub period_us: u32,
    /// Nearest and farthest distance, millimetres.
    pub range_mm: [u16; 2],
}

/// Which inertial sensor it carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ImuDevice {
    /// Xsens MTi-30.
    #[default]
    XsensMti,
    /// VectorNav VN-100.
    VectorNav,
    /// Any sensor behind a bridge.
    Bridged,
}

/// What the body rolls on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Train {
    /// A front wheel that drives and steers; two free rear wheels with encoders.
    #[default]
    FrontWheel,
    /// Two driven wheels on one axle, and castors.
    TwoWheels,
    /// A driven rear axle with encoders at both wheels, and front wheels that are steered together.
    RearAxle,
    /// Four Mecanum wheels at the corners of a rectangle.
    FourMecanum,
}

/// Everything that is fixed about the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotParameters {
    /// Outline, counter-clockwise, metres, robot frame (origin in the middle of the rear axle).
    pub footprint: Vec<Point2>,
    /// The true body over that outline: how high each part of it reaches. Sensors look through it.
    pub body: Vec<BodyPrism>,
    /// Kilograms with full tanks.
    pub mass_kg: f32,
    /// Bumpers in front and at the rear are there: outline and heights, robot frame.
    pub bumpers: [BodyPrism; 2],
    /// Where the floor is felt for in front and at the rear, robot frame, metres.
    pub floor_switches_m: [[[f32; 2]; 2]; 2],
    /// What it rolls on.
    pub train: Train,
    /// Rear axle to front wheel or front axle, metres.
    pub wheelbase_m: f32,
    /// Between the rear wheels, metres.
    pub track_m: f32,
    /// Encoder counts per metre of a rear wheel.
    pub ticks_per_m: f32,
    /// The front wheel turns at most this fast, rad/s.
    pub steering_rate_radps: f32,
    /// And at most this far, radians.
    pub steering_max_rad: f32,
    /// Friction of the front wheel limits any acceleration of the robot to this, m/s².
    pub grip_mps2: f32,
    /// The mechanical brake, m/s².
    pub brake_mps2: f32,
    /// From the loss of power to the brake's grip, seconds.
    pub brake_delay_s: f32,
    /// Lidar.
    pub lidar: SensorMount,
    /// Its model.
    pub lidar_device: LidarDevice,
    /// Safety scanner.
    pub scanner: SensorMount,
    /// Its model.
    pub scanner_device: ScannerDevice,
    /// A second one, an S300.
    pub rear_scanner: Option<SensorMount>,
    /// Inertial sensor.
    pub imu: SensorMount,
    /// Its model.
    pub imu_device: ImuDevice,
    /// CAN nodes.
    pub nodes: NodeIds,
    /// Controllers of the wheels other than CiA 402 drives.
    pub motors: Option<MotorParameters>,
    /// The scrubbing deck.
    pub brush: BrushDeck,
}

impl Default for RobotParameters {
    fn default() -> Self {
        let mount = |x_m, z_m| SensorMount { x_m, y_m: 0.0, z_m, yaw_rad: 0.0 };
        let prism = |name, x: [f32; 2], y_m: f32, height_m| BodyPrism {
            name,
            outline_m: vec![[x[0], -y_m], [x[1], -y_m], [x[1], y_m], [x[0], y_m]],
            height_m,
        };
        Self {
            footprint: [(-0.45, -0.40), (0.95, -0.40), (0.95, 0.40), (-0.45, 0.40)]
                .map(|(x, y)| Point2::new(x, y))
                .to_vec(),
            body: vec![
                prism("body", [-0.45, 0.95], 0.40, [0.02, 0.75]),
                prism("brushes", [0.10, 0.40], 0.40, [0.005, 0.02]),
                prism("squeegee", [-0.45, -0.35], 0.40, [0.005, 0.02]),
                prism("lidar mast", [0.44, 0.56], 0.06, [0.75, 0.88]),
            ],
            mass_kg: 300.0,
            bumpers: [
                prism("front bumper", [0.90, 0.955], 0.40, [0.04, 0.40]),
                prism("rear bumper", [-0.455, -0.40], 0.40, [0.04, 0.40]),
            ],
            floor_switches_m: [[[0.93, 0.30], [0.93, -0.30]], [[-0.43, 0.30], [-0.43, -0.30]]],
            train: Train::FrontWheel,
            wheelbase_m: 0.80,
            track_m: 0.60,
            ticks_per_m: 20_000.0,
            steering_rate_radps: 1.5,
            steering_max_rad: 1.55,
            grip_mps2: 2.5,
            brake_mps2: 1.5,
            brake_delay_s: 0.05,
            lidar: mount(0.50, 0.80),
            scanner: mount(0.90, 0.15),
            lidar_device: LidarDevice::default(),
            scanner_device: ScannerDevice::default(),
            rear_scanner: None,
            imu: mount(0.30, 0.40),
            imu_device: ImuDevice::default(),
            nodes: NodeIds {
                traction: 1,
                steering: 2,
                wheels: [0; 4],
                left_encoder: 3,
                right_encoder: 4,
                gateway: 5,
                dirt_sensor: 6,
            },
            motors: None,
            brush: BrushDeck { width_m: 0.65, offset_m: 0.25 },
        }
    }
}
