//! The robot as a whole: geometry, limits, deadlines, and where its sensors are.

use floorguard_drivers::motor_drives::MotorDrivesConfiguration;
use floorguard_guard::{Thresholds, UnseenLimits};
use floorguard_types::capacities::FIELD_SETS_MAX;
use heapless::Vec;

use super::fields::{FieldPair, Polygon};
use super::sources::{CanConfiguration, ImuConfiguration, LidarConfiguration, ScannerConfiguration};
use crate::mission::{Route, RouteLimits};

/// The body and its wheels. The robot frame lies on the floor in the middle of the rear axle, x forward, y left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Geometry {
    /// Outline, counter-clockwise, metres.
    pub footprint: Polygon,
    /// Rear axle to the steered front wheel, metres; of a base without one, by what a turning rate is a speed.
    pub wheelbase_m: f32,
    /// Distance between the two rear wheels, metres; of Mecanum wheels the distance of the differential base that turns alike.
    pub track_m: f32,
    /// Ticks of a measuring wheel per metre rolled; of two wheels on each side, of both together.
    pub ticks_per_m: f32,
    /// How much faster the outer wheel is than the base point, metres per radian; 0 where one wheel in the middle brakes.
    pub wheel_lever_m: f32,
}

/// What the robot may and can do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Greatest speed forward, m/s.
    pub speed_mps: f32,
    /// Greatest speed backwards, m/s, a positive number.
    pub reverse_mps: f32,
    /// Greatest turning rate, rad/s.
    pub turn_radps: f32,
    /// Greatest acceleration, m/s².
    pub acceleration_mps2: f32,
    /// The braking that is always reached, m/s², worn brakes on a wet floor.
    pub braking_mps2: f32,
    /// From the decision to the brake's full effect, seconds.
    pub response_s: f32,
}

/// How old each source may be before the guard acts, microseconds (book, Guard: Source deadlines).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deadlines {
    /// Safety scanner: stop.
    pub scanner_us: u64,
    /// The second safety scanner: stop.
    pub rear_scanner_us: u64,
    /// Lidar packets: limited speed.
    pub lidar_us: u64,
    /// Wheels: stop.
    pub odometry_us: u64,
    /// Wanted command: stop.
    pub command_us: u64,
}

impl Deadlines {
    /// Those of the example robot.
    pub const DEFAULT: Self = Self {
        scanner_us: 200_000,
        rear_scanner_us: 200_000,
        lidar_us: 300_000,
        odometry_us: 50_000,
        command_us: 200_000,
    };
}

/// How the wheels move the robot (book, Odometry: Bases).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum DriveTrain {
    /// A front wheel that drives and steers, two free rear wheels.
    #[default]
    Tricycle,
    /// Two driven wheels on one axle.
    Differential,
    /// A driven rear axle, and front wheels that are steered as those of a car.
    Ackermann {
        /// To either side, radians.
        steering_max_rad: f32,
    },
    /// Four Mecanum wheels. Sideways it is not driven.
    Omnidirectional {
        /// Between the axles, metres.
        wheelbase_m: f32,
        /// Between the wheels of an axle, metres.
        track_m: f32,
    },
}

/// What drives the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BaseKind {
    /// Drives, encoders and a safety controller on a CAN bus.
    #[default]
    CanBus,
    /// A controller that takes velocities and measures its own.
    Velocity,
}

/// Everything that `robot.toml` says.
#[derive(Clone, Debug)]
pub struct RobotConfiguration {
    /// Body and wheels.
    pub geometry: Geometry,
    /// Speeds and accelerations.
    pub limits: Limits,
    /// Greatest ages.
    pub deadlines: Deadlines,
    /// What drives it; [`Self::can`] is of no use with [`BaseKind::Velocity`].
    pub base: BaseKind,
    /// How its wheels move it.
    pub train: DriveTrain,
    /// It has the three-dimensional lidar.
    pub has_lidar: bool,
    /// Three-dimensional lidar.
    pub lidar: LidarConfiguration,
    /// Safety laser scanner.
    pub scanner: ScannerConfiguration,
    /// A second one, which looks behind; a robot can do without, and a microcontroller lacks the memory for it.
    pub rear_scanner: Option<ScannerConfiguration>,
    /// Inertial measurement unit; a robot can do without.
    pub imu: Option<ImuConfiguration>,
    /// Drive, encoders and inputs.
    pub can: CanConfiguration,
    /// Controllers of the wheels other than CiA 402 drives; then of [`Self::can`] only the gateway counts, if there is one.
    pub motors: Option<MotorDrivesConfiguration>,
    /// Protective and warning fields, by direction and rising speed.
    pub fields: Vec<FieldPair, FIELD_SETS_MAX>,
    /// What to drive when nobody commands; empty: stand still.
    pub route: Route,
    /// How to drive it.
    pub route_limits: RouteLimits,
    /// Thresholds of the guard.
    pub thresholds: Thresholds,
    /// Speeds that the gaps of the sensors leave, by direction.
    pub unseen: UnseenLimits,
}
