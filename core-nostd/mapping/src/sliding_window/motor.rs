//! The motor that turns the lidar: its angle at the time of a beam, and whether it follows its command.

use floorguard_types::time::{Age, Stamp};
use heapless::Deque;

use super::error::{MotorError, ScanError};

/// Samples that are kept: 0.3 s at 200 Hz.
const SAMPLES: usize = 64;
/// An angle farther from a beam in time than this does not belong to it: at 0.3 rad/s the lidar turns by 0.34° meanwhile.
pub const ANGLE_GAP_MAX_US: u64 = 20_000;
/// A motor that has not followed for so long has stalled: longer than it takes to reverse.
const STALL_US: u64 = 300_000;
const STALL_S: f32 = 0.3;
/// It follows if it has turned by this share of what was commanded; a blocked gear still gives way a little.
const FOLLOWING_SHARE: f32 = 0.25;
/// Slower commands are standing still, rad/s.
const COMMAND_MIN_RADPS: f32 = 0.02;

/// What the motor's controller reports.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorSample {
    /// When the angle was measured.
    pub stamp: Stamp,
    /// Angle about the vertical axis, radians, left positive; 0 is straight ahead.
    pub angle_rad: f32,
    /// Speed that is commanded, rad/s.
    pub commanded_radps: f32,
}

/// The newest angles of the motor. Invariant: stamps rise.
///
/// ```
/// use floorguard_mapping::sliding_window::{MotorSample, MotorTrack};
/// use floorguard_types::time::Stamp;
///
/// let mut motor = MotorTrack::new();
/// for (millis, angle_rad) in [(0, 0.1), (10, 0.2)] {
///     let stamp = Stamp::from_micros(millis * 1_000);
///     motor.push(MotorSample { stamp, angle_rad, commanded_radps: 10.0 })?;
/// }
/// let between = motor.angle_at(Stamp::from_micros(5_000)).unwrap();
/// assert!((between - 0.15).abs() < 1.0e-6);
/// # Ok::<(), floorguard_mapping::sliding_window::MotorError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct MotorTrack {
    samples: Deque<MotorSample, SAMPLES>,
    /// Where it last was seen to follow its command.
    followed: Option<MotorSample>,
}

impl MotorTrack {
    /// Without any angle.
    #[must_use]
    pub const fn new() -> Self {
        Self { samples: Deque::new(), followed: None }
    }

    /// Takes the next sample; the oldest one is dropped for it. Constant time.
    ///
    /// # Errors
    /// A sample that is not newer than the one before, or not finite: it is left out.
    pub fn push(&mut self, sample: MotorSample) -> Result<(), MotorError> {
        if !(sample.angle_rad.is_finite() && sample.commanded_radps.is_finite()) {
            return Err(MotorError::NotFinite);
        }
        if let Some(newest) = self.samples.back()
            && sample.stamp <= newest.stamp
        {
            return Err(MotorError::OutOfOrder { behind_us: sample.stamp.past_us(newest.stamp) });
        }
        if self.samples.is_full() {
            let _oldest = self.samples.pop_front();
        }
        // A place was made above.
        let _full = self.samples.push_back(sample);
        self.watch(sample);
        Ok(())
    }

    /// Notes whether the angle follows the command.
    fn watch(&mut self, sample: MotorSample) {
        let Some(since) = self.followed else {
            self.followed = Some(sample);
            return;
        };
        let command = sample.commanded_radps;
        let stands = libm::fabsf(command) < COMMAND_MIN_RADPS;
        let reverses = command * since.commanded_radps <= 0.0;
        // What it would turn by within the time after which it counts as stalled.
        let expected_rad = libm::fabsf(command) * STALL_S;
        let turned_rad = libm::fabsf(sample.angle_rad - since.angle_rad);
        if stands || reverses || turned_rad >= FOLLOWING_SHARE * expected_rad {
            self.followed = Some(sample);
        }
    }

    /// How long the motor has stood although it is commanded to turn, microseconds; `None` while it follows.
    #[must_use]
    pub fn stalled_us(&self) -> Option<u64> {
        let standing_us = self.followed?.stamp.past_us(self.samples.back()?.stamp);
        (standing_us >= STALL_US).then_some(standing_us)
    }

    /// The angle at a time, interpolated between the samples around it. Cost: one pass over at most 64 samples.
    ///
    /// # Errors
    /// [`ScanError::AngleMissing`] unless a sample lies within 20 ms before it and another within 20 ms after it.
    pub fn angle_at(&self, stamp: Stamp) -> Result<f32, ScanError> {
        let (mut before, mut after) = (None::<MotorSample>, None::<MotorSample>);
        // From the newest one: a scan has just been measured.
        for sample in self.samples.iter().rev().take(SAMPLES) {
            match sample.stamp.age(stamp) {
                Age::Past(_) => {
                    before = Some(*sample);
                    break;
                }
                Age::Future(_) => after = Some(*sample),
            }
        }
        let gap = |sample: Option<MotorSample>| {
            sample.map_or(u64::MAX, |sample| sample.stamp.past_us(stamp).max(stamp.past_us(sample.stamp)))
        };
        // A sample at that very time needs no other one.
        if let Some(before) = before
            && before.stamp == stamp
        {
            return Ok(before.angle_rad);
        }
        let gap_us = gap(before).max(gap(after));
        let (Some(before), Some(after)) = (before, after) else {
            return Err(ScanError::AngleMissing { gap_us: gap(before).min(gap(after)) });
        };
        if gap_us > ANGLE_GAP_MAX_US {
            return Err(ScanError::AngleMissing { gap_us });
        }
        // The samples differ by at least a microsecond: one is before the time, the other after it.
        let part = stamp.seconds_since(before.stamp) / after.stamp.seconds_since(before.stamp);
        Ok(before.angle_rad + part * (after.angle_rad - before.angle_rad))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(millis: u64, angle_rad: f32, commanded_radps: f32) -> MotorSample {
        MotorSample { stamp: Stamp::from_micros(1_000 * millis), angle_rad, commanded_radps }
    }

    #[test]
    fn angles_need_samples_on_both_sides() {
        let mut motor = MotorTrack::new();
        let missing = |gap_us| Err(ScanError::AngleMissing { gap_us });
        assert_eq!(motor.angle_at(Stamp::ZERO), missing(u64::MAX));
        for step in 0..100_u16 {
            motor.push(sample(10 * u64::from(step), 0.003 * f32::from(step), 0.3)).unwrap();
        }
        // Only the newest 64 are kept: from 360 ms on.
        assert!((motor.angle_at(Stamp::from_micros(365_000)).unwrap() - 0.1095).abs() < 1e-6);
        assert_eq!(motor.angle_at(Stamp::from_micros(340_000)), missing(20_000));
        assert_eq!(motor.angle_at(Stamp::from_micros(1_010_000)), missing(20_000));
        motor.push(sample(1_031, 0.31, 0.3)).unwrap();
        assert_eq!(motor.angle_at(Stamp::from_micros(1_000_000)), missing(31_000));
        assert!(motor.angle_at(Stamp::from_micros(990_000)).is_ok());
    }

    #[test]
    fn stalls_only_while_commanded() {
        let mut motor = MotorTrack::new();
        let mut angle_rad = 0.0;
        for step in 0..400_u16 {
            // Back and forth, with encoder noise; blocked from 2 s to 3 s; then without command.
            let command = if step >= 300 {
                0.0
            } else if (step / 50) % 2 == 0 {
                0.3
            } else {
                -0.3
            };
            if !(200..300).contains(&step) {
                angle_rad += 0.01 * command;
            }
            let noise = if step % 2 == 0 { 0.0017 } else { -0.0017 };
            motor.push(sample(10 * u64::from(step), angle_rad + noise, command)).unwrap();
            // Reported 0.3 s after it blocked, and 0.3 s after it was commanded the other direction.
            let is_stalled = motor.stalled_us().is_some();
            assert!(
                is_stalled || !((231..=249).contains(&step) || (281..=299).contains(&step)),
                "step {step}"
            );
            assert!(!is_stalled || (215..300).contains(&step), "step {step}");
        }
    }

    #[test]
    fn samples_in_disorder_are_left_out() {
        let mut motor = MotorTrack::new();
        motor.push(sample(10, 0.0, 0.3)).unwrap();
        assert_eq!(motor.push(sample(10, 0.0, 0.3)), Err(MotorError::OutOfOrder { behind_us: 0 }));
        assert_eq!(motor.push(sample(7, 0.0, 0.3)), Err(MotorError::OutOfOrder { behind_us: 3_000 }));
        assert_eq!(motor.push(sample(20, f32::NAN, 0.3)), Err(MotorError::NotFinite));
        assert_eq!(motor.samples.len(), 1);
    }
}
