//! The device's sample time on the robot's clock.
//!
//! The arrival of a serial frame jitters by the reading computer's scheduling; the sample time does not. Differences of
//! the sample time are mapped with the same lower envelope as the lidar's clock, with the same hazard in mind: frames
//! that queued somewhere stay old.

use floorguard_types::number::truncating_u32;
use floorguard_types::time::Stamp;

use crate::velodyne::HourClock;

/// Ticks of 100 µs after which the clock of the MTi-10 and MTi-100 series starts over: 24 h (book, Xsens MTi: Data
/// items).
const DAY_TICKS: u32 = 864_000_000;
const HOUR_TICKS: u64 = 36_000_000;
const TICK_US: u32 = 100;

/// Maps sample times of one device, of a series that wraps after a day or at 2³².
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SampleClock {
    last_ticks: u32,
    /// Ticks since the first sample, unrolled over the wraps.
    unrolled: u64,
    mapping: HourClock,
}

impl SampleClock {
    /// The sampling instant: `ticks` by the device, at the latest `sampled` by the arrival on the robot's clock.
    pub fn stamp(&mut self, ticks: u32, sampled: Stamp) -> Stamp {
        // No sample is twelve hours late: a fall by more than half a day is the wrap of the day.
        let fell = self.last_ticks.saturating_sub(ticks);
        let step = if self.last_ticks < DAY_TICKS && fell > DAY_TICKS / 2 {
            DAY_TICKS.saturating_sub(self.last_ticks).saturating_add(ticks)
        } else {
            ticks.wrapping_sub(self.last_ticks)
        };
        self.last_ticks = ticks;
        self.unrolled = self.unrolled.wrapping_add(u64::from(step));
        let in_hour = truncating_u32(self.unrolled % HOUR_TICKS);
        self.mapping.stamp(in_hour.saturating_mul(TICK_US), sampled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worst error of 2,000 samples with jitter, from some ticks on.
    fn worst_us(first: u64, modulus: u64) -> u64 {
        let mut clock = SampleClock::default();
        let mut worst_us = 0;
        for step in 0..2_000_u64 {
            let true_us = 1_000_000 + step * 10_000;
            let jitter_us = (step * 7_919) % 8_000;
            let ticks = ((first + step * 100) % modulus) as u32;
            let stamp = clock.stamp(ticks, Stamp::from_micros(true_us + jitter_us));
            assert!(stamp.as_micros() <= true_us + jitter_us, "later than its arrival");
            if step > 100 {
                worst_us = worst_us.max(stamp.as_micros().abs_diff(true_us));
            }
        }
        worst_us
    }

    #[test]
    fn arrival_jitter_does_not_reach_the_stamp() {
        assert!(worst_us(864_000_000 - 50_000, 864_000_000) < 300);
        assert!(worst_us((1 << 32) - 50_000, 1 << 32) < 300);
        assert!(worst_us(36_000_000 - 50_000, 1 << 32) < 300);
    }

    #[test]
    fn a_restarted_device_is_believed_again() {
        let mut clock = SampleClock::default();
        clock.stamp(50_000, Stamp::from_micros(10_000_000));
        let stamp = clock.stamp(10, Stamp::from_micros(12_000_000));
        assert_eq!(stamp, Stamp::from_micros(12_000_000));
    }

    /// Not even a small step back is followed: a clock that does not count on is a new one, at any time of its day.
    #[test]
    fn backward_clock_is_detected_by_arrival() {
        for fell in [1, 10, 100, 36_000] {
            for first in [50_000, 431_000_000, 863_000_000] {
                let mut clock = SampleClock::default();
                clock.stamp(first, Stamp::from_micros(10_000_000));
                let stamp = clock.stamp(first - fell, Stamp::from_micros(10_010_000));
                assert_eq!(stamp, Stamp::from_micros(10_010_000), "{fell} of {first}");
            }
        }
    }

    #[test]
    fn samples_that_queued_stay_old() {
        let mut clock = SampleClock::default();
        clock.stamp(50_000, Stamp::from_micros(10_000_000));
        for step in 1..=60_u32 {
            let stamp = clock.stamp(50_000 + 100 * step, Stamp::from_micros(10_700_000));
            let true_us = 10_000_000 + u64::from(step) * 10_000;
            assert!(stamp.as_micros() <= true_us + 200, "{step}: {stamp:?}");
        }
    }
}
