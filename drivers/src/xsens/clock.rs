//! The device's clock on the robot's clock.

use floorguard_core::time::Stamp;

/// Ticks of 100 µs after which the clock of the MTi-10 and MTi-100 series starts over: 24 h.
const DAY_TICKS: u32 = 864_000_000;
const TICK_US: u64 = 100;
/// Both clocks together drift less than this: 200 µs per second, so 2 µs per sample at 100 Hz.
const DRIFT_US_PER_SAMPLE: u64 = 2;
/// An arrival this far from what the clock says means that the device has restarted, microseconds.
const RESTART_US: u64 = 500_000;

/// Lower envelope of arrival minus device time (algorithms L.3): the least delayed sample tells the offset.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DeviceClock {
    last_ticks: Option<u32>,
    /// Device time since its first sample, microseconds, plus the offset of that.
    device_us: u64,
    /// Robot time minus device time, microseconds.
    offset_us: u64,
}

impl DeviceClock {
    /// When a sample was taken whose last byte arrived at `arrival`, after at least `least_delay_us`.
    pub fn stamp(&mut self, ticks: u32, arrival: Stamp, least_delay_us: u64) -> Stamp {
        let sent_us = arrival.as_micros().saturating_sub(least_delay_us);
        let Some(last) = self.last_ticks.replace(ticks) else {
            self.device_us = 0;
            self.offset_us = sent_us;
            return Stamp::from_micros(sent_us);
        };
        // 24 h series and 2³² series differ in where they wrap; no sample is 12 h late.
        let step = if ticks >= last {
            ticks - last
        } else if last < DAY_TICKS && last - ticks > DAY_TICKS / 2 {
            (DAY_TICKS - last).saturating_add(ticks)
        } else {
            ticks.wrapping_sub(last)
        };
        self.device_us = self.device_us.saturating_add(u64::from(step).saturating_mul(TICK_US));
        let said_us = self.device_us.saturating_add(self.offset_us);
        if said_us.abs_diff(sent_us) > RESTART_US {
            self.device_us = 0;
            self.offset_us = sent_us;
            return Stamp::from_micros(sent_us);
        }
        let seen_us = sent_us.saturating_sub(self.device_us);
        self.offset_us = seen_us.min(self.offset_us.saturating_add(DRIFT_US_PER_SAMPLE));
        Stamp::from_micros(self.device_us.saturating_add(self.offset_us))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jitter_of_the_arrival_does_not_reach_the_stamp() {
        let mut clock = DeviceClock::default();
        let mut worst_us = 0;
        for step in 0..2_000_u64 {
            let true_us = 1_000_000 + step * 10_000;
            let jitter_us = (step * 7_919) % 8_000;
            let ticks = ((864_000_000 - 50_000) + step * 100) % 864_000_000;
            let stamp = clock.stamp(ticks as u32, Stamp::from_micros(true_us + 6_000 + jitter_us), 6_000);
            if step > 100 {
                worst_us = worst_us.max(stamp.as_micros().abs_diff(true_us));
            }
        }
        assert!(worst_us < 600, "{worst_us}");
    }

    #[test]
    fn a_restart_begins_anew() {
        let mut clock = DeviceClock::default();
        clock.stamp(5_000, Stamp::from_micros(10_000_000), 0);
        let stamp = clock.stamp(10, Stamp::from_micros(12_000_000), 0);
        assert_eq!(stamp, Stamp::from_micros(12_000_000));
    }
}
