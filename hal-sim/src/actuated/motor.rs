//! The motor under the lidar: a CiA 402 drive in profile velocity with an encoder.

use crate::can::{CanFrame, Drive, DriveKind, MeasuredMotion};

/// Counts of the encoder for a turn of the motor, and turns of the motor for one of the lidar.
const COUNTS: f64 = 2_048.0;
const GEAR: f64 = 100.0;

/// A motor with its drive.
#[derive(Clone, Debug)]
pub struct TurningMotor {
    drive: Drive,
    /// Of the lidar, radians.
    angle_rad: f64,
    /// Something holds it.
    pub is_blocked: bool,
}

impl TurningMotor {
    /// A drive that has just been powered; the lidar looks straight ahead.
    #[must_use]
    pub fn new(node: u8) -> Self {
        Self { drive: Drive::new(node, DriveKind::Traction), angle_rad: 0.0, is_blocked: false }
    }

    /// Where the lidar looks, radians, left positive.
    #[must_use]
    pub const fn angle_rad(&self) -> f64 {
        self.angle_rad
    }

    /// Takes a frame from the bus; answers are appended.
    pub fn receive(&mut self, frame: &CanFrame, now_us: u64, out: &mut Vec<CanFrame>) {
        self.drive.receive(frame, now_us, out);
    }

    /// One step: ramps, shaft, encoder. The drive's own unit of speed is a thousandth of `demand_mps`: here a turn a minute.
    pub fn tick(&mut self, now_us: u64, step_s: f32, out: &mut Vec<CanFrame>) {
        let demanded_rpm = f64::from(self.drive.demand_mps()) * 1.0e3;
        let rpm = if self.is_blocked || !self.drive.powered() { 0.0 } else { demanded_rpm };
        self.angle_rad += rpm / 60.0 / GEAR * std::f64::consts::TAU * f64::from(step_s);
        let counts = (self.angle_rad / std::f64::consts::TAU * GEAR * COUNTS).round() as i32;
        self.drive.node.objects.set(0x6064, 0, counts as u32);
        let measured = MeasuredMotion { speed_mps: (rpm * 1.0e-3) as f32, angle_rad: 0.0, counts: 0 };
        self.drive.tick(now_us, step_s, measured, out);
    }
}
