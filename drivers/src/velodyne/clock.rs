//! From microseconds since the top of the sensor's hour to the robot's clock. Wire-formats 1.8.
//!
//! Without PPS the sensor's clock runs free, tens of minutes off, so only its differences are used: the smallest
//! difference between arrival and sensor time seen so far is the offset (a datagram can only be late), and it may
//! creep up by the drift that a crystal can have.

use floorguard_core::time::Stamp;

const HOUR_US: i64 = 3_600_000_000;
/// Crystals drift by less than 200 ppm (algorithms L.3).
const DRIFT_PPM: i64 = 200;
/// A sensor stamp that jumps by more than this against the arrival restarts the filter (PPS locked or lost).
const JUMP_US: i64 = 500_000;

/// Maps the stamps of one sensor.
#[derive(Clone, Copy, Debug, Default)]
pub struct HourClock {
    state: Option<State>,
    restarts: u32,
}

#[derive(Clone, Copy, Debug)]
struct State {
    last_sensor_us: i64,
    last_arrival_us: i64,
    /// Arrival minus sensor time, lower envelope, of the unrolled sensor time.
    offset_us: i64,
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
        let measured_us = state.last_sensor_us.saturating_add(state.offset_us).min(arrival_us);
        Stamp::from_micros(u64::try_from(measured_us).unwrap_or(0))
    }

    /// How often the sensor's clock jumped.
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
            offset_us: arrival_us.saturating_sub(sensor_us),
        }
    }

    /// `None` if the sensor's clock jumped.
    fn follow(self, sensor_us: u32, arrival_us: i64) -> Option<Self> {
        // The step within the hour, brought to ±30 minutes: the roll-over is a small step forwards.
        let hour_us = i64::from(sensor_us).saturating_sub(self.last_sensor_us).rem_euclid(HOUR_US);
        let step_us = if hour_us > HOUR_US / 2 { hour_us.saturating_sub(HOUR_US) } else { hour_us };
        let elapsed_us = arrival_us.saturating_sub(self.last_arrival_us);
        if step_us.saturating_sub(elapsed_us).abs() > JUMP_US {
            return None;
        }
        let last_sensor_us = self.last_sensor_us.saturating_add(step_us);
        let seen_us = arrival_us.saturating_sub(last_sensor_us);
        let allowed_us =
            self.offset_us.saturating_add(elapsed_us.max(0).saturating_mul(DRIFT_PPM) / 1_000_000 + 1);
        Some(Self { last_sensor_us, last_arrival_us: arrival_us, offset_us: seen_us.min(allowed_us) })
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

    #[test]
    fn a_jump_of_the_sensor_restarts() {
        let mut clock = HourClock::default();
        clock.stamp(1_000_000, Stamp::from_micros(50_000_000));
        let locked = clock.stamp(900_000_000, Stamp::from_micros(50_001_327));
        assert_eq!(locked.as_micros(), 50_001_327);
        assert_eq!(clock.restarts(), 1);
    }
}
