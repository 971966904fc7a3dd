//! From microseconds since the top of the sensor's hour to the robot's clock. Source: book, Velodyne: Clock.
//!
//! Without PPS the sensor's clock runs free, tens of minutes off, so only its differences are used: the smallest
//! difference between arrival and sensor time seen so far is the offset (a datagram can only be late), and it may
//! creep up by the drift that a crystal can have.
//!
//! Hazard: packets that queued somewhere look like a sensor whose clock was set back. Taking them for fresh would show
//! the guard the past as the present, so a stream that falls behind stays old; only a step that no delay can explain,
//! or a silence long enough for a restart of the sensor, starts the mapping anew.
//!
//! Limit: a sensor's clock that is set back by less than half a second looks like a delay of that length, and its stamps
//! stay that much too old, healing by 200 microseconds a second. That errs to the safe side; a restart of the decoder
//! cures it.

use floorguard_types::time::Stamp;

const HOUR_US: i64 = 3_600_000_000;
/// Crystals drift by less than 200 ppm (book, Odometry: Sensor clocks): nanoseconds of creep per millisecond.
const DRIFT_NS_PER_MS: i64 = 200;
/// A sensor stamp that runs ahead of the arrivals by more than this, or falls back by more than this, is a clock that
/// was set (PPS locked or lost).
const JUMP_US: i64 = 500_000;
/// After this silence the sensor may have been restarted, and nothing that queued before is still on its way.
const RESTART_SILENCE_US: i64 = 5_000_000;

/// Maps the stamps of one sensor.
///
/// ```
/// use floorguard_drivers::velodyne::HourClock;
/// use floorguard_types::time::Stamp;
///
/// // The sensor's counter starts over at the full hour; the robot's clock knows no such step.
/// let mut clock = HourClock::default();
/// let first = clock.stamp(3_599_999_000, Stamp::from_micros(10_000_000));
/// let second = clock.stamp(327, Stamp::from_micros(10_001_327));
/// assert_eq!(second.as_micros() - first.as_micros(), 1_327);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct HourClock {
    state: Option<State>,
    restarts: u32,
}

#[derive(Clone, Copy, Debug)]
struct State {
    /// Unrolled over the hours.
    last_sensor_us: i64,
    last_arrival_us: i64,
    /// Arrival minus unrolled sensor time, lower envelope, nanoseconds: the creep within one packet is less than a
    /// microsecond.
    offset_ns: i64,
}

impl HourClock {
    /// The moment of measurement on the robot's clock: never later than the arrival.
    pub fn stamp(&mut self, sensor_us: u32, arrival: Stamp) -> Stamp {
        let arrival_us = i64::try_from(arrival.as_micros()).unwrap_or(i64::MAX);
        let state = match self.state {
            None => State::start(sensor_us, arrival_us),
            Some(state) => state.follow(sensor_us, arrival_us).unwrap_or_else(|| {
                self.restarts = self.restarts.saturating_add(1);
                State::start(sensor_us, arrival_us)
            }),
        };
        self.state = Some(state);
        let measured_us = state.last_sensor_us.saturating_add(state.offset_ns / 1_000).min(arrival_us);
        Stamp::from_micros(u64::try_from(measured_us).unwrap_or(0))
    }

    /// How often the mapping started anew because the sensor's clock was set.
    #[must_use]
    pub const fn restarts(&self) -> u32 {
        self.restarts
    }
}

impl State {
    fn start(sensor_us: u32, arrival_us: i64) -> Self {
        let sensor_us = i64::from(sensor_us);
        Self {
            last_sensor_us: sensor_us,
            last_arrival_us: arrival_us,
            offset_ns: arrival_us.saturating_sub(sensor_us).saturating_mul(1_000),
        }
    }

    /// `None` if the sensor's clock was set.
    fn follow(self, sensor_us: u32, arrival_us: i64) -> Option<Self> {
        // The step within the hour, brought to ±30 minutes: the roll-over is a small step forwards.
        let hour_us = i64::from(sensor_us).saturating_sub(self.last_sensor_us).rem_euclid(HOUR_US);
        let step_us = if hour_us > HOUR_US / 2 { hour_us.saturating_sub(HOUR_US) } else { hour_us };
        let elapsed_us = arrival_us.saturating_sub(self.last_arrival_us);
        let ran_ahead =
            step_us.saturating_sub(elapsed_us) > JUMP_US && !self.is_catching_up(step_us, arrival_us);
        let fell_back = step_us < -JUMP_US;
        if ran_ahead || fell_back || elapsed_us > RESTART_SILENCE_US {
            return None;
        }
        let last_sensor_us = self.last_sensor_us.saturating_add(step_us);
        let seen_ns = arrival_us.saturating_sub(last_sensor_us).saturating_mul(1_000);
        let creep_ns = elapsed_us.max(0).saturating_mul(DRIFT_NS_PER_MS) / 1_000;
        let allowed_ns = self.offset_ns.saturating_add(creep_ns);
        Some(Self { last_sensor_us, last_arrival_us: arrival_us, offset_ns: seen_ns.min(allowed_ns) })
    }

    /// A late stream loses its delay in one step: by what is known of the clock, it is still not from the future.
    fn is_catching_up(self, step_us: i64, arrival_us: i64) -> bool {
        let measured_us = self.last_sensor_us.saturating_add(step_us).saturating_add(self.offset_ns / 1_000);
        measured_us <= arrival_us.saturating_add(JUMP_US)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rolls_over_the_hour_without_a_step() {
        let mut clock = HourClock::default();
        let first = clock.stamp(3_599_999_000, Stamp::from_micros(10_000_000));
        let second = clock.stamp(327, Stamp::from_micros(10_001_327));
        assert_eq!(second.as_micros() - first.as_micros(), 1_327);
        assert_eq!(clock.restarts(), 0);
    }

    #[test]
    fn a_late_datagram_keeps_its_moment_of_measurement() {
        let mut clock = HourClock::default();
        clock.stamp(1_000_000, Stamp::from_micros(50_000_000));
        let late = clock.stamp(1_010_000, Stamp::from_micros(50_018_000));
        assert!(late.as_micros() <= 50_010_010, "{late:?}");
    }

    /// The mapped time of each sensor time, and whether the mapping restarted.
    fn restarts_after(sensor_us: i64, elapsed_us: i64) -> u32 {
        let mut clock = HourClock::default();
        clock.stamp(1_000_000_000, Stamp::from_micros(5_000_000_000));
        let arrival_us = u64::try_from(5_000_000_000 + elapsed_us).unwrap();
        clock.stamp(u32::try_from(1_000_000_000 + sensor_us).unwrap(), Stamp::from_micros(arrival_us));
        clock.restarts()
    }

    #[test]
    fn small_clock_steps_are_followed_large_restart() {
        assert_eq!(restarts_after(-500, 1_000), 0, "a packet that was overtaken");
        assert_eq!(restarts_after(-JUMP_US, 1_000), 0);
        assert_eq!(restarts_after(-JUMP_US - 1, 1_000), 1);
        assert_eq!(restarts_after(JUMP_US + 1_000, 1_000), 0);
        assert_eq!(restarts_after(JUMP_US + 1_001, 1_000), 1);
        assert_eq!(restarts_after(RESTART_SILENCE_US, RESTART_SILENCE_US), 0);
        assert_eq!(restarts_after(RESTART_SILENCE_US + 1, RESTART_SILENCE_US + 1), 1);
        assert_eq!(restarts_after(30_000_000, 1_327), 1, "from the future by what is known of the clock");
    }

    #[test]
    fn a_jump_of_the_sensor_restarts() {
        let mut clock = HourClock::default();
        clock.stamp(1_000_000, Stamp::from_micros(50_000_000));
        let locked = clock.stamp(900_000_000, Stamp::from_micros(50_001_327));
        assert_eq!(locked.as_micros(), 50_001_327);
        assert_eq!(clock.restarts(), 1);
    }

    #[test]
    fn packets_that_queued_for_two_seconds_stay_old() {
        let mut clock = HourClock::default();
        clock.stamp(1_000_000, Stamp::from_micros(50_000_000));
        let queued = clock.stamp(1_001_327, Stamp::from_micros(52_000_000));
        assert!(queued.as_micros() <= 50_001_327 + 400 + 1, "{queued:?}");
        // For as long as it lasts, but for the drift of a crystal: 200 us a second.
        let mut last = queued;
        for packet in 1..=1_000_u32 {
            let passed_us = 1_327 * packet;
            let arrival = Stamp::from_micros(52_000_000 + u64::from(passed_us));
            last = clock.stamp(1_001_327 + passed_us, arrival);
        }
        assert!(last.as_micros() <= 51_328_327 + 700, "{last:?}");
        // And what arrives in time again is fresh at once.
        let fresh = clock.stamp(1_000_000 + 4_000_000, Stamp::from_micros(54_000_000));
        assert!(fresh.as_micros().abs_diff(54_000_000) < 1_000, "{fresh:?}");
        assert_eq!(clock.restarts(), 0);
    }

    #[test]
    fn a_sensor_that_was_restarted_is_believed_again() {
        let mut clock = HourClock::default();
        clock.stamp(10_000_000, Stamp::from_micros(50_000_000));
        let again = clock.stamp(11_000_000, Stamp::from_micros(70_000_000));
        assert_eq!(again.as_micros(), 70_000_000);
        assert_eq!(clock.restarts(), 1);
    }

    #[test]
    fn a_drifting_sensor_is_followed() {
        let mut clock = HourClock::default();
        // 100 ppm slow for ten minutes: 60 ms in all, of which almost nothing may show.
        let mut error_us = 0;
        for second in 0..600_u64 {
            for packet in 0..10_u64 {
                let true_us = second * 1_000_000 + packet * 100_000;
                let sensor_us = (true_us - true_us / 10_000) as u32;
                let stamp = clock.stamp(sensor_us, Stamp::from_micros(true_us + 200));
                error_us = error_us.max(stamp.as_micros().abs_diff(true_us));
            }
        }
        assert!(error_us <= 210, "{error_us}");
    }
}
