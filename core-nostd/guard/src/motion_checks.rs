//! Does the robot move as it should, and do its sensors agree about it?

use crate::protection::{Cause, CauseRecord, Creep, GuardConfig, Motion, Persistence, Source, Unit};
use floorguard_types::time::Stamp;

/// Share by which the measured speed may exceed the permitted one (book, Guard: Motion checks).
const OVERSPEED_SHARE: f32 = 1.1;
/// Speeds below this are not overspeed: encoders creep, m/s.
const OVERSPEED_FLOOR_MPS: f32 = 0.05;
/// Slip is called after this long, microseconds (book, Guard: Motion checks).
const SLIP_US: u64 = 200_000;

/// What is remembered between checks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionChecks {
    /// What the fastest point of the body may still do, m/s.
    pub(super) envelope_mps: f32,
    pub(super) checked_at: Stamp,
    pub(super) falling: Persistence,
    pub(super) overspeed: Persistence,
    pub(super) speed: Persistence,
    pub(super) turn: Persistence,
    pub(super) steering: Persistence,
    /// Stop and hold is in force, and nothing is permitted.
    pub(super) is_held: bool,
    pub(super) creep_by_wheels: Creep,
    pub(super) creep_by_drive: Creep,
}

impl MotionChecks {
    /// Nothing to remember.
    pub const NONE: Self = Self {
        envelope_mps: 0.0,
        checked_at: Stamp::ZERO,
        falling: Persistence::NEVER,
        overspeed: Persistence::NEVER,
        speed: Persistence::NEVER,
        turn: Persistence::NEVER,
        steering: Persistence::NEVER,
        is_held: false,
        creep_by_wheels: Creep::NONE,
        creep_by_drive: Creep::NONE,
    };

    /// The braking envelope: what the fastest point of the body may still do while the robot obeys `permitted_mps`, given
    /// for that point, too. After the response time it falls with the braking that is always reached; a robot above it
    /// does not obey (FG-REQ-050).
    pub fn follow(&mut self, permitted_mps: f32, (braking_mps2, response_us): (f32, u64), now: Stamp) {
        let step_s = now.seconds_since(self.checked_at).clamp(0.0, 0.1);
        self.checked_at = now;
        let falls = self.falling.check(permitted_mps < self.envelope_mps, (response_us, now));
        let fallen_mps = if falls { self.envelope_mps - braking_mps2 * step_s } else { self.envelope_mps };
        self.envelope_mps = fallen_mps.max(permitted_mps);
    }

    /// Every disagreement that has lasted too long (FG-REQ-050, FG-REQ-051, FG-REQ-052, FG-REQ-053).
    pub fn check(&mut self, motion: &Motion, config: &GuardConfig, now: Stamp) -> [Option<CauseRecord>; 4] {
        let speed_mps = motion.fastest_mps();
        let (limits, turn) = (&config.thresholds, motion.wheels.angular_radps);
        let overspeed_mps = OVERSPEED_SHARE * self.envelope_mps + OVERSPEED_FLOOR_MPS;
        let speed_gap = (motion.wheels.linear_mps - motion.drive.linear_mps).abs();
        let gyro_gap = if config.rules(Source::Imu).fitted { (turn - motion.gyro_radps).abs() } else { 0.0 };
        let steering_gap = (turn - motion.drive.angular_radps).abs();
        let (mps, radps) = (limits.speed_disagreement_mps, limits.turn_disagreement_radps);
        let hold = (limits.disagreement_us, now);
        let judge = |wrong: bool, cause: Cause, (measured, limit, unit): (f32, f32, Unit)| {
            wrong.then(|| CauseRecord::new(cause, now).measured(measured, limit, unit))
        };
        [
            judge(
                self.overspeed.check(speed_mps > overspeed_mps, (limits.overspeed_us, now)),
                Cause::Overspeed,
                (speed_mps, overspeed_mps, Unit::MetresPerSecond),
            ),
            judge(
                self.speed.check(speed_gap > mps, hold),
                Cause::SpeedDisagreement,
                (speed_gap, mps, Unit::MetresPerSecond),
            ),
            judge(
                self.turn.check(gyro_gap > radps, hold),
                Cause::TurnDisagreement,
                (gyro_gap, radps, Unit::RadiansPerSecond),
            ),
            judge(
                self.steering.check(steering_gap > radps, (SLIP_US, now)),
                Cause::SteeringDisagreement,
                (steering_gap, radps, Unit::RadiansPerSecond),
            ),
        ]
    }
}
