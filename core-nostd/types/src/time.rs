//! Stamps on the robot's monotonic clock, and ages that know about the future.
//!
//! A stamp tells when something was *measured*. A one-sided age test would let a stamp from the future stay fresh for
//! ever, so [`Stamp::age`] has two answers and every caller must look at both.

use crate::number::{nearest_f32, truncating_i32, truncating_u32};

/// Microseconds on the robot's monotonic clock. 2^64 µs are 584,000 years: no wrap-around.
///
/// ```
/// use floorguard_types::time::Stamp;
///
/// let start = Stamp::from_micros(86_400_000_000);
/// let later = start.plus_micros(25);
/// assert_eq!(later.seconds_since(start), 25.0e-6);
/// assert_eq!(start.seconds_since(later), -25.0e-6);
/// assert_eq!(Stamp::ZERO.minus_micros(1), Stamp::ZERO);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Stamp(u64);

/// How old a stamp is, seen from now.
///
/// ```
/// use floorguard_types::time::{Age, Stamp};
///
/// let is_fresh = |measured: Stamp, now: Stamp| match measured.age(now) {
///     Age::Past(micros) => micros <= 100_000,
///     Age::Future(micros) => micros <= 2_000,
/// };
/// let now = Stamp::from_micros(1_000_000);
/// assert!(is_fresh(Stamp::from_micros(950_000), now));
/// assert!(!is_fresh(Stamp::from_micros(9_000_000), now));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Age {
    /// Measured this many microseconds ago.
    Past(u64),
    /// Claims to be measured this many microseconds from now (always > 0).
    Future(u64),
}

impl Stamp {
    /// The start of the clock.
    pub const ZERO: Self = Self(0);

    /// From microseconds of the monotonic clock.
    #[must_use]
    pub const fn from_micros(micros: u64) -> Self {
        Self(micros)
    }

    /// Microseconds of the monotonic clock.
    #[must_use]
    pub const fn as_micros(self) -> u64 {
        self.0
    }

    /// How old this stamp is at `now`.
    #[must_use]
    pub const fn age(self, now: Self) -> Age {
        if self.0 <= now.0 { Age::Past(now.0 - self.0) } else { Age::Future(self.0 - now.0) }
    }

    /// Microseconds that it lies in the past of `now`; 0 when it claims to come from the future.
    #[must_use]
    pub const fn past_us(self, now: Self) -> u64 {
        now.0.saturating_sub(self.0)
    }

    /// This stamp moved later by `micros`, saturating at the end of time.
    #[must_use]
    pub const fn plus_micros(self, micros: u64) -> Self {
        Self(self.0.saturating_add(micros))
    }

    /// This stamp moved earlier by `micros`, saturating at zero.
    #[must_use]
    pub const fn minus_micros(self, micros: u64) -> Self {
        Self(self.0.saturating_sub(micros))
    }

    /// Signed seconds from `earlier` to this stamp. Differences are taken in integers before they are narrowed, so
    /// a day of uptime costs no precision.
    #[must_use]
    pub fn seconds_since(self, earlier: Self) -> f32 {
        match earlier.age(self) {
            Age::Past(micros) => nearest_f32(micros) * 1.0e-6,
            Age::Future(micros) => -nearest_f32(micros) * 1.0e-6,
        }
    }
}

/// Maps a free-running 32-bit microsecond counter (wraps every 71.6 min) onto the 64-bit clock.
///
/// ```
/// use floorguard_types::time::Unwrap32;
///
/// let mut clock = Unwrap32::default();
/// assert_eq!(clock.extend(0x7fff_ffff), 0x7fff_ffff);
/// assert_eq!(clock.extend(0xffff_fff0), 0xffff_fff0);
/// assert_eq!(clock.extend(0x0000_0010), 0x1_0000_0010);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwrap32 {
    last: u64,
}

impl Unwrap32 {
    /// The 64-bit value nearest to the previous one whose low half equals `counter`. Right as long as two readings
    /// are less than 35 minutes apart; small steps backwards stay backwards.
    pub fn extend(&mut self, counter: u32) -> u64 {
        let delta = truncating_i32(counter.wrapping_sub(truncating_u32(self.last)));
        self.last = self.last.saturating_add_signed(i64::from(delta));
        self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn future_stamps_are_not_fresh_ones() {
        let now = Stamp::from_micros(1_000);
        assert_eq!(Stamp::from_micros(400).age(now), Age::Past(600));
        assert_eq!(Stamp::from_micros(1_000).age(now), Age::Past(0));
        assert_eq!(Stamp::from_micros(1_001).age(now), Age::Future(1));
    }

    #[test]
    fn seconds_keep_microseconds_after_thirty_days() {
        let day30 = Stamp::from_micros(30 * 86_400 * 1_000_000);
        assert_eq!(day30.plus_micros(25).seconds_since(day30), 25.0e-6);
        assert_eq!(day30.seconds_since(day30.plus_micros(25)), -25.0e-6);
    }

    #[test]
    fn counter_wraps_forwards_and_jitters_backwards() {
        let mut unwrap = Unwrap32::default();
        assert_eq!(unwrap.extend(0x7fff_ffff), 0x7fff_ffff);
        assert_eq!(unwrap.extend(0xffff_fff0), 0xffff_fff0);
        assert_eq!(unwrap.extend(0x0000_0010), 0x1_0000_0010);
        assert_eq!(unwrap.extend(0xffff_fff0), 0xffff_fff0);
    }
}
