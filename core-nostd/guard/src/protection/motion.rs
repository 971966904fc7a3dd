//! How the robot moves, by each sensor that measures it.

use super::config::GuardConfig;
use super::sweep::{NEARER_M, fastest_mps};
use floorguard_types::geometry::{Point2, Twist2};

/// Motion as each sensor tells it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Encoders of the rear wheels.
    pub wheels: Twist2,
    /// Gyroscope, rad/s.
    pub gyro_radps: f32,
    /// What the driven wheel and its steering angle make of the robot's motion.
    pub drive: Twist2,
    /// Speed of the fastest point of the body by the encoders, m/s.
    pub wheels_fastest_mps: f32,
    /// The same by the drive, m/s.
    pub drive_fastest_mps: f32,
}

impl Motion {
    /// Nothing moves.
    pub const STILL: Self = Self {
        wheels: Twist2::ZERO,
        gyro_radps: 0.0,
        drive: Twist2::ZERO,
        wheels_fastest_mps: 0.0,
        drive_fastest_mps: 0.0,
    };

    /// The encoders measured.
    pub fn hear_wheels(&mut self, measured: Twist2, outline: &[Point2]) {
        self.wheels = measured;
        self.wheels_fastest_mps = fastest_mps(outline, measured);
    }

    /// The drive reported a speed of its wheel over ground, m/s, and a steering angle, radians. Sine and cosine are
    /// taken here, and not at each decision.
    pub fn hear_drive(&mut self, wheel_mps: f32, steering_rad: f32, config: &GuardConfig) {
        let (sin, cos) = libm::sincosf(steering_rad);
        let angular_radps = wheel_mps * sin / config.drive.wheelbase_m;
        self.drive = Twist2 { linear_mps: wheel_mps * cos, angular_radps };
        self.drive_fastest_mps = fastest_mps(&config.footprint, self.drive);
    }

    /// Motion by the encoders, for the braking distance. A rotation that moves no point of the body sideways by more than 5 mm until
    /// standstill counts as zero: at a crawl one encoder tick of difference between the wheels looks like a curve with a radius of some
    /// metres, which would lead into an object beside the body.
    #[must_use]
    pub fn wheels_until_standstill(&self, config: &GuardConfig) -> Twist2 {
        let (twist, drive) = (self.wheels, &config.drive);
        let stops_s = drive.response_s + self.wheels_fastest_mps / drive.braking_mps2.max(1.0e-3);
        let turns_only = Twist2 { linear_mps: 0.0, ..twist };
        let is_none = fastest_mps(&config.footprint, turns_only) * stops_s <= NEARER_M;
        if is_none { Twist2 { angular_radps: 0.0, ..twist } } else { twist }
    }

    /// Speed of the fastest point of the body, by the source that measures more, m/s.
    #[must_use]
    pub fn fastest_mps(&self) -> f32 {
        self.wheels_fastest_mps.max(self.drive_fastest_mps)
    }
}
