//! What the robot feels of its own motion.

use crate::time::Stamp;

/// Inertial measurement in the robot's axes (x forward, y left, z up).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ImuSample {
    /// When it was measured.
    pub stamp: Stamp,
    /// The device's own packet counter.
    pub sequence: u16,
    /// Rate of turn, rad/s.
    pub angular_radps: [f32; 3],
    /// Acceleration including gravity, m/s².
    pub linear_mps2: [f32; 3],
    /// The device's own orientation, unit quaternion w, x, y, z, where it sends one.
    pub orientation: Option<[f32; 4]>,
    /// The device reports clipping or a failed self-test.
    pub suspect: bool,
}

/// Positions of the two rear wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WheelSample {
    /// When the positions were latched.
    pub stamp: Stamp,
    /// Left encoder, ticks, wraps at 32 bits.
    pub left_ticks: i32,
    /// Right encoder, ticks, wraps at 32 bits.
    pub right_ticks: i32,
}

/// The drive's state as the guard needs it (CiA 402 condensed).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DriveState {
    /// Nothing is known yet.
    #[default]
    Unknown,
    /// Torque is off and nothing is wrong.
    Disabled,
    /// Torque is on; velocity commands are followed.
    Enabled,
    /// Ramping down after a quick stop.
    QuickStop,
    /// The drive reports a fault; the code of object 0x603F.
    Fault(u16),
}

/// What the drive reports.
///
/// ```
/// use floorguard_types::sensing::{DriveFeedback, DriveState};
///
/// assert_eq!(DriveFeedback::default().state, DriveState::Unknown);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DriveFeedback {
    /// When the report arrived.
    pub stamp: Stamp,
    /// State machine of the drive.
    pub state: DriveState,
    /// Measured speed of the driven wheel over ground, m/s.
    pub wheel_speed_mps: f32,
    /// Measured steering angle, radians, counter-clockwise.
    pub steering_rad: f32,
}
