//! The sensors and the drive: model, mounting, and identifiers on the wire.
//!
//! Addresses of carriers (ports, device files) are the board's business and not part of this.

use floorguard_drivers::flexisoft::InputMap;
use floorguard_drivers::inertial::AnyInertialSensor;
use floorguard_drivers::livox::TURN_US;
use floorguard_drivers::ouster::Beams;
use floorguard_drivers::{imu_link, vectornav, xsens};
use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::units::radians;

use super::ranging::RangingModel;

/// Where a sensor sits on the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mounting {
    /// Forward of the rear axle, left, above the floor, metres.
    pub position: Point3,
    /// Roll about x, radians.
    pub roll_rad: f32,
    /// Pitch about y, radians, nose down is positive.
    pub pitch_rad: f32,
    /// Yaw about z, radians, counter-clockwise.
    pub yaw_rad: f32,
}

impl Mounting {
    /// Sensor frame to robot frame.
    #[must_use]
    pub fn transform(&self) -> Transform3 {
        Transform3::from_mounting(self.position, self.roll_rad, self.pitch_rad, self.yaw_rad)
    }
}

/// Which three-dimensional lidar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LidarModel {
    /// Tell from the packets.
    #[default]
    Auto,
    /// VLP-16 or Puck LITE.
    Vlp16,
    /// Puck Hi-Res.
    PuckHiRes,
    /// VLP-32C.
    Vlp32c,
    /// HDL-32E.
    Hdl32e,
    /// Hesai PandarXT-16.
    PandarXt16,
    /// Hesai PandarXT-32, of which every second ring is used: those of a PandarXT-16. In the others people are looked for once
    /// more.
    PandarXt32,
    /// Ouster OS0, OS1 or OS2, as its metadata say: hosted programs only. They live as long as the program.
    Ouster(&'static Beams),
    /// Any lidar of 16 rings behind a bridge; elevations in thousandths of a degree, the lowest first. Hosted programs only.
    Bridged(&'static [i32; SWEEP_RINGS]),
    /// Livox Mid-360; elevations of the rings that its points become, in its own frame, thousandths of a degree, the lowest first.
    /// Hosted programs only.
    LivoxMid360(&'static [i32; SWEEP_RINGS]),
}

impl LidarModel {
    /// So much later than a lidar that turns it shows what its beams met, seconds (book, Livox: Columns).
    #[must_use]
    pub fn later_s(self) -> f32 {
        match self {
            Self::LivoxMid360(_) => TURN_US as f32 * 1.0e-6,
            _ => 0.0,
        }
    }
}

/// Three-dimensional lidar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LidarConfiguration {
    /// Model.
    pub model: LidarModel,
    /// Mounting.
    pub mounting: Mounting,
}

/// Which scanner the guard looks through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ScannerModel {
    /// SICK S300 on RS-422.
    #[default]
    S300,
    /// SICK microScan3, outdoorScan3 or nanoScan3 over UDP.
    MicroScan3 {
        /// Beams over its 275°: 2,751 of a microScan3, 1,651 of a nanoScan3, fewer where its output is thinned out.
        beams: u16,
    },
    /// A scanner that is no safety device.
    Ranging(RangingModel),
}

impl ScannerModel {
    /// Field of view, degrees, half of it to either side (book, SICK S300: Line; book, microScan3: Test message), of a safety scanner.
    const fn sector_deg(self) -> f32 {
        match self {
            Self::MicroScan3 { .. } => 275.0,
            _ => 270.0,
        }
    }

    /// It sends datagrams by itself; the others have a line or a connection.
    #[must_use]
    pub const fn sends_datagrams(self) -> bool {
        match self {
            Self::S300 => false,
            Self::MicroScan3 { .. } => true,
            Self::Ranging(model) => model.sends_datagrams(),
        }
    }

    /// Beams of a scan.
    #[must_use]
    pub fn beams(self) -> usize {
        match self {
            Self::S300 => 541,
            Self::MicroScan3 { beams } => usize::from(beams),
            Self::Ranging(model) => usize::from(model.geometry().beams),
        }
    }

    /// Angle of the first beam in the sensor's frame, radians; 0 is straight ahead.
    #[must_use]
    pub fn first_angle_rad(self) -> f32 {
        match self {
            Self::Ranging(model) => radians(model.geometry().first_deg),
            _ => -radians(self.sector_deg() / 2.0),
        }
    }

    /// Angle between two beams, radians.
    #[must_use]
    pub fn step_rad(self) -> f32 {
        match self {
            Self::Ranging(model) => radians(model.geometry().step_deg),
            _ => radians(self.sector_deg() / self.beams().saturating_sub(1).max(1) as f32),
        }
    }
}

/// Safety laser scanner.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScannerConfiguration {
    /// Model.
    pub model: ScannerModel,
    /// Mounting.
    pub mounting: Mounting,
    /// First and last angle in the sensor's frame that the robot's own body does not cover, radians.
    pub sector_rad: [f32; 2],
}

/// Which inertial measurement unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ImuModel {
    /// Xsens MTi-30 and its kin.
    #[default]
    XsensMti,
    /// VectorNav VN-100, VN-200 or VN-300.
    VectorNav,
    /// Any sensor behind a bridge, over UDP or on a line.
    Bridged,
}

impl ImuModel {
    /// Its word in the robot's file.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::XsensMti => "xsens-mti",
            Self::VectorNav => "vectornav",
            Self::Bridged => "bridged",
        }
    }

    /// Its driver, for a line of so many bits per second.
    #[must_use]
    pub fn driver(self, baud: u32) -> AnyInertialSensor {
        match self {
            Self::XsensMti => AnyInertialSensor::Xsens(xsens::Device::new(baud)),
            Self::VectorNav => AnyInertialSensor::VectorNav(vectornav::Device::new(baud)),
            Self::Bridged => AnyInertialSensor::Bridged(imu_link::Device::default()),
        }
    }
}

/// Inertial measurement unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImuConfiguration {
    /// Model.
    pub model: ImuModel,
    /// Mounting.
    pub mounting: Mounting,
}

/// CANopen nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CanConfiguration {
    /// The drives of the wheels (CiA 402) of a base without a steered wheel, 1…127: left and right, or front left, front right, rear
    /// left and rear right; 0 where there is none.
    pub wheel_nodes: [u8; 4],
    /// The traction drive (CiA 402), 1…127.
    pub drive_node: u8,
    /// The steering drive (CiA 402), 1…127.
    pub steering_node: u8,
    /// The left rear encoder (CiA 406), 1…127.
    pub left_encoder_node: u8,
    /// The right rear encoder (CiA 406), 1…127.
    pub right_encoder_node: u8,
    /// The gateway of the safety controller, 1…127.
    pub inputs_node: u8,
    /// Node of the dirt sensor; a robot can do without.
    pub dirt_sensor_node: Option<u8>,
    /// What its process image means.
    pub inputs: InputMap,
    /// Which of its bits are the operator's buttons.
    pub buttons: OperatorButtons,
}

/// Push buttons of the operator in the safety controller's image, 1 = pressed; they act when they are released.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OperatorButtons {
    /// Asks for a reset.
    pub reset_bit: Option<u8>,
    /// Gives the start command.
    pub start_bit: Option<u8>,
}
