//! The sensor's 24-bit milliseconds on the robot's clock.

use floorguard_types::number::truncating_u32;
use floorguard_types::time::Stamp;

use crate::velodyne::HourClock;

/// The counter starts over after 4 h 39 min.
const COUNTER_MASK: u32 = 0xFF_FFFF;
const HOUR_MS: u64 = 3_600_000;
/// A reading says when the sensor's counter had its value to half of the time that question and answer took; longer ones say
/// nothing, microseconds.
const ROUND_TRIP_MAX_US: u64 = 40_000;
/// The sensor's clock may have gone wrong by this a second since it was read, microseconds.
const DRIFT_US_PER_S: u64 = 200;
/// So long a reading counts by itself.
const READING_US: u64 = 60_000_000;
/// The counter counts whole milliseconds.
const COUNT_US: i64 = 1_000;

/// Maps the stamps of one sensor.
///
/// It is read by `TM1`: half way between question and answer the sensor's counter had that value. The best reading counts for a
/// minute; meanwhile the least delay of the scans is learned, by which their arrivals then follow the drift of the crystal.
/// Without a reading, the earliest arrivals count as prompt.
///
/// ```
/// use floorguard_drivers::scip::ScipClock;
/// use floorguard_types::time::Stamp;
///
/// let at = Stamp::from_micros;
/// let mut clock = ScipClock::default();
/// clock.read(16_777_000, at(5_000_000), at(5_004_000));
/// // 1,000 counts later, past the end of the counter.
/// let stamp = clock.stamp(784, (at(6_200_000), 100_000));
/// assert_eq!(stamp.as_micros(), 6_002_000);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct ScipClock {
    last: u32,
    /// Counts since the first stamp, unrolled over the ends of the counter.
    unrolled: u64,
    reading: Option<Reading>,
    /// Of the scans since the reading, the least delay from the counter's value to the arrival, microseconds.
    learned_us: Option<u64>,
    arrivals: HourClock,
}

#[derive(Clone, Copy, Debug)]
struct Reading {
    /// The robot's clock less the unrolled counter, microseconds.
    offset_us: i64,
    round_trip_us: u64,
    at: Stamp,
}

impl ScipClock {
    /// The sensor answered with its time: asked and heard then.
    pub fn read(&mut self, sensor_ms: u32, asked: Stamp, heard: Stamp) {
        let round_trip_us = asked.past_us(heard);
        let unrolled_us = self.unroll(sensor_ms);
        if round_trip_us > ROUND_TRIP_MAX_US || heard < asked {
            return;
        }
        let aged_us = |old: Reading| {
            let seconds = old.at.past_us(heard) / 1_000_000;
            old.round_trip_us.saturating_add(seconds.saturating_mul(2 * DRIFT_US_PER_S))
        };
        if self.reading.is_none_or(|old| round_trip_us <= aged_us(old)) {
            let middle_us = signed(asked.as_micros()).saturating_add(signed(round_trip_us / 2));
            // The counter shows a value for a whole millisecond: on the mean it had it half of one ago.
            let offset_us = middle_us.saturating_sub(unrolled_us).saturating_sub(COUNT_US / 2);
            self.reading = Some(Reading { offset_us, round_trip_us, at: heard });
        }
    }

    /// When the counter had a value: never later than the arrival less the delay that there is at least between the two,
    /// microseconds.
    pub fn stamp(&mut self, sensor_ms: u32, (arrival, delay_us): (Stamp, u64)) -> Stamp {
        let unrolled_us = self.unroll(sensor_ms);
        if let Some(reading) = self.reading
            && reading.at.past_us(arrival) <= READING_US
        {
            let at_us = unrolled_us.saturating_add(reading.offset_us).saturating_add(COUNT_US / 2);
            let at = Stamp::from_micros(u64::try_from(at_us).unwrap_or(0)).min(arrival);
            let delay_us = at.past_us(arrival);
            self.learned_us = Some(self.learned_us.map_or(delay_us, |least| least.min(delay_us)));
            return at;
        }
        let latest = arrival.minus_micros(self.learned_us.unwrap_or(delay_us));
        let in_hour_us = truncating_u32(self.unrolled % HOUR_MS).saturating_mul(1_000);
        self.arrivals.stamp(in_hour_us, latest)
    }

    /// How well the sensor's time is known: half of a round trip, microseconds; `None` without a reading.
    #[must_use]
    pub fn uncertainty_us(&self) -> Option<u64> {
        self.reading.map(|reading| reading.round_trip_us / 2)
    }

    /// The sensor was started anew: its counter is another one.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Microseconds of the unrolled counter. A small step back is followed.
    fn unroll(&mut self, sensor_ms: u32) -> i64 {
        let counter = sensor_ms & COUNTER_MASK;
        let forward = u64::from(counter.wrapping_sub(self.last) & COUNTER_MASK);
        let half = u64::from(COUNTER_MASK / 2);
        let back = u64::from(self.last.wrapping_sub(counter) & COUNTER_MASK);
        self.unrolled = if forward > half && back <= self.unrolled {
            self.unrolled.saturating_sub(back)
        } else {
            self.unrolled.saturating_add(forward)
        };
        self.last = counter;
        signed(self.unrolled).saturating_mul(COUNT_US)
    }
}

fn signed(value: u64) -> i64 {
    i64::try_from(value).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(micros: u64) -> Stamp {
        Stamp::from_micros(micros)
    }

    /// The counter begins anywhere, ends in between, and counts whole milliseconds; question and answer take 1 to 9 ms.
    #[test]
    fn stamps_are_right_to_half_the_trip() {
        for begin in [0_u64, 5_000, (1 << 24) - 3_000, (1 << 24) - 1] {
            let mut clock = ScipClock::default();
            let counter = |us: u64| ((begin * 1_000 + us) / 1_000 % (1 << 24)) as u32;
            for number in 0..10_u64 {
                let asked = 1_000_000 + number * 50_000;
                let (there, back) = (500 + number * 400, 4_500 - number * 400);
                clock.read(counter(asked + there), at(asked), at(asked + there + back));
            }
            assert!(clock.uncertainty_us().unwrap() <= 2_500);
            for number in 0..200_u64 {
                let measured = 2_000_000 + number * 100_000 + number * 37;
                let stamp = clock.stamp(counter(measured), (at(measured + 150_000), 70_000));
                assert!(stamp.as_micros().abs_diff(measured) <= 3_100, "{number}: {stamp:?} for {measured}");
            }
        }
    }

    #[test]
    fn arrivals_serve_without_a_reading() {
        let mut clock = ScipClock::default();
        let mut worst = 0;
        for number in 0..300_u64 {
            let measured = 3_000_000 + number * 100_000;
            let late = 75_000 + number * 7_919 % 30_000;
            let stamp = clock.stamp((measured / 1_000) as u32, (at(measured + late), 75_000));
            if number > 50 {
                worst = worst.max(stamp.as_micros().abs_diff(measured));
            }
        }
        assert!(worst < 2_000, "{worst}");
    }

    /// 50 parts in a million for an hour: 180 ms, of which a few remain.
    #[test]
    fn drift_is_followed_after_the_reading() {
        let mut clock = ScipClock::default();
        let counter = |us: u64| ((us + us / 20_000) / 1_000 % (1 << 24)) as u32;
        clock.read(counter(1_001_000), at(1_000_000), at(1_002_000));
        let mut worst = 0;
        for number in 0..36_000_u64 {
            let measured = 2_000_000 + number * 100_000;
            let late = 80_000 + number * 7_919 % 5_000;
            let stamp = clock.stamp(counter(measured), (at(measured + late), 60_000));
            worst = worst.max(stamp.as_micros().abs_diff(measured));
        }
        assert!(worst < 9_000, "{worst}");
    }

    #[test]
    fn slow_answers_say_nothing() {
        let mut clock = ScipClock::default();
        clock.read(1_000, at(1_000_000), at(1_041_000));
        assert_eq!(clock.uncertainty_us(), None);
        clock.read(1_050, at(1_050_000), at(1_060_000));
        clock.read(1_100, at(1_100_000), at(1_102_000));
        clock.read(1_150, at(1_150_000), at(1_160_000));
        assert_eq!(clock.uncertainty_us(), Some(1_000));
        clock.forget();
        assert_eq!(clock.uncertainty_us(), None);
    }
}
