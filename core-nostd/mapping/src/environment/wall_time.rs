//! Calendar time: what the people of a place live by, unlike the robot's monotonic clock.
//!
//! Kept in UTC. Habits follow the clock on the wall, so the offset of local time is added where an hour or a weekday
//! is asked for; a change to summer time then moves no habit (book, Environment: Calendar time).

use floorguard_types::number::{nearest_f32_of_f64, nearest_f64, truncating_u8, truncating_u32};

/// Hours of a week.
pub const HOURS_OF_WEEK: usize = 168;

const MICROS: i64 = 1_000_000;
const HOUR_S: i64 = 3_600;
const DAY_S: i64 = 86_400;
const WEEK_S: i64 = 604_800;
/// 1970-01-01 was a Thursday, three days after a Monday.
const EPOCH_AFTER_MONDAY_S: i64 = 3 * DAY_S;

/// Microseconds since 1970-01-01 00:00 UTC.
///
/// ```
/// use floorguard_mapping::environment::WallTime;
///
/// // 1970-01-01 was a Thursday; two hours east of Greenwich it begins at 2 o'clock.
/// let local = WallTime::from_seconds(0).local(7_200);
/// assert_eq!(local.hour(), 2);
/// assert_eq!(local.hour_of_week(), 3 * 24 + 2);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct WallTime(i64);

impl WallTime {
    /// From microseconds since 1970-01-01 00:00 UTC.
    #[must_use]
    pub const fn from_micros(micros: i64) -> Self {
        Self(micros)
    }

    /// From whole seconds since 1970-01-01 00:00 UTC, saturating.
    #[must_use]
    pub const fn from_seconds(seconds: i64) -> Self {
        Self(seconds.saturating_mul(MICROS))
    }

    /// Microseconds since 1970-01-01 00:00 UTC.
    #[must_use]
    pub const fn as_micros(self) -> i64 {
        self.0
    }

    /// Whole seconds since 1970-01-01 00:00 UTC, rounded down.
    #[must_use]
    pub const fn as_seconds(self) -> i64 {
        self.0.div_euclid(MICROS)
    }

    /// This moment moved later, saturating.
    #[must_use]
    pub const fn plus_micros(self, micros: i64) -> Self {
        Self(self.0.saturating_add(micros))
    }

    /// Signed microseconds from `earlier` to this moment, saturating.
    #[must_use]
    pub const fn micros_since(self, earlier: Self) -> i64 {
        self.0.saturating_sub(earlier.0)
    }

    /// Signed hours from `earlier` to this moment. The difference is taken in integers.
    #[must_use]
    pub fn hours_since(self, earlier: Self) -> f32 {
        nearest_f32_of_f64(nearest_f64(self.micros_since(earlier)) / nearest_f64(HOUR_S * MICROS))
    }

    /// The clock on the wall, `offset_s` seconds ahead of UTC.
    #[must_use]
    pub fn local(self, offset_s: i32) -> LocalTime {
        LocalTime(self.as_seconds().saturating_add(i64::from(offset_s)))
    }
}

/// Whole seconds since 1970-01-01 00:00 on the clock on the wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct LocalTime(i64);

impl LocalTime {
    /// From whole seconds since 1970-01-01 00:00 local time.
    #[must_use]
    pub const fn from_seconds(seconds: i64) -> Self {
        Self(seconds)
    }

    /// Whole seconds since 1970-01-01 00:00 local time.
    #[must_use]
    pub const fn as_seconds(self) -> i64 {
        self.0
    }

    /// Seconds since Monday 00:00, within [0, 604,800).
    #[must_use]
    pub fn second_of_week(self) -> u32 {
        truncating_u32(self.0.saturating_add(EPOCH_AFTER_MONDAY_S).rem_euclid(WEEK_S))
    }

    /// Hours since Monday 00:00, within [0, 168).
    #[must_use]
    pub fn hour_of_week(self) -> u8 {
        truncating_u8(self.second_of_week() / truncating_u32(HOUR_S))
    }

    /// Hour of the day, within [0, 24).
    #[must_use]
    pub fn hour(self) -> u8 {
        self.hour_of_week() % 24
    }

    /// Day of the week: 0 is Monday, 6 is Sunday.
    #[must_use]
    pub fn weekday(self) -> u8 {
        self.hour_of_week() / 24
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Python 3: `datetime.fromtimestamp(1775649723, timezone.utc)` is Wednesday 2026-04-08 12:02:03.
    #[test]
    fn a_known_moment() {
        let utc = WallTime::from_micros(1_775_649_723_000_001);
        let local = utc.local(0);
        assert_eq!((local.weekday(), local.hour(), local.hour_of_week()), (2, 12, 60));
        let summer = utc.local(7_200);
        assert_eq!((summer.weekday(), summer.hour()), (2, 14));
        assert_eq!(utc.local(12 * 3_600).weekday(), 3);
    }

    #[test]
    fn times_before_epoch_and_at_extremes() {
        assert_eq!(WallTime::from_micros(-1).local(0).hour_of_week(), 2 * 24 + 23);
        for extreme in [i64::MIN, i64::MAX] {
            let local = WallTime::from_micros(extreme).local(i32::MAX);
            assert!(usize::from(local.hour_of_week()) < HOURS_OF_WEEK);
            assert!(WallTime::from_micros(extreme).hours_since(WallTime::default()).is_finite());
        }
    }
}
