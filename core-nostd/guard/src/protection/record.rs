//! A stop explains itself: cause, source, measured value, limit, age (FG-REQ-004).

use core::fmt;

use super::action::Action;
use super::cause::Cause;
use super::source::Health;
use floorguard_types::number::{nearest_f32, saturating_u32};
use floorguard_types::time::Stamp;

/// Unit of a measured value and its limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unit {
    /// The cause has no number.
    #[default]
    None,
    /// m
    Metres,
    /// m/s
    MetresPerSecond,
    /// rad/s
    RadiansPerSecond,
    /// s
    Seconds,
    /// %
    Percent,
    /// A device's own code.
    Code,
}

/// Why, seen when it began. Never overwritten while the cause stays.
///
/// ```
/// use floorguard_guard::{Cause, CauseRecord, Unit};
/// use floorguard_types::time::Stamp;
///
/// let record = CauseRecord::new(Cause::ScanProtective, Stamp::ZERO).metres(0.8, 1.2).aged(45_000);
/// assert_eq!((record.measured, record.limit, record.unit), (0.8, 1.2, Unit::Metres));
/// assert_eq!(record.action, Cause::ScanProtective.action());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CauseRecord {
    /// Which cause.
    pub cause: Cause,
    /// What it demands.
    pub action: Action,
    /// What was measured, in `unit`.
    pub measured: f32,
    /// The limit that it broke, in `unit`.
    pub limit: f32,
    /// Unit of both.
    pub unit: Unit,
    /// Age of the measurement when it was judged, microseconds.
    pub age_us: u64,
    /// When it was judged.
    pub raised_at: Stamp,
    /// For a source: how it was. `Healthy` otherwise.
    pub health: Health,
    /// For a source with a stamp from the future: how far ahead, microseconds.
    pub ahead_us: u64,
    /// Speed that the cause still permits, m/s; 0 for a stop.
    pub speed_limit_mps: f32,
}

impl CauseRecord {
    /// A stop without a number, judged at once.
    #[must_use]
    pub const fn new(cause: Cause, raised_at: Stamp) -> Self {
        Self {
            cause,
            action: cause.action(),
            measured: 0.0,
            limit: 0.0,
            unit: Unit::None,
            age_us: 0,
            raised_at,
            health: Health::Healthy,
            ahead_us: 0,
            speed_limit_mps: 0.0,
        }
    }

    /// With a measured distance and the limit that it broke.
    #[must_use]
    pub const fn metres(self, measured_m: f32, limit_m: f32) -> Self {
        self.measured(measured_m, limit_m, Unit::Metres)
    }

    /// With the measured value, the limit that it broke, and their unit.
    #[must_use]
    pub const fn measured(mut self, measured: f32, limit: f32, unit: Unit) -> Self {
        self.measured = measured;
        self.limit = limit;
        self.unit = unit;
        self
    }

    /// With the age of the measurement, microseconds.
    #[must_use]
    pub const fn aged(mut self, age_us: u64) -> Self {
        self.age_us = age_us;
        self
    }

    /// With the speed that is still permitted, m/s.
    #[must_use]
    pub const fn limited_to(mut self, speed_limit_mps: f32) -> Self {
        self.speed_limit_mps = speed_limit_mps;
        self
    }
}

impl fmt::Display for CauseRecord {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", self.cause)?;
        if self.health != Health::Healthy {
            write!(out, " {}", self.health)?;
        }
        let unit = match self.unit {
            Unit::None => "",
            Unit::Metres => " m",
            Unit::MetresPerSecond => " m/s",
            Unit::RadiansPerSecond => " rad/s",
            Unit::Seconds => " s",
            Unit::Percent => " %",
            Unit::Code => "",
        };
        match self.unit {
            Unit::None => {}
            Unit::Code => write!(out, ", code {:#06x}", saturating_u32(self.measured))?,
            _ => write!(out, ": {:.2}{unit}, limit {:.2}{unit}", self.measured, self.limit)?,
        }
        if self.ahead_us > 0 {
            let ahead_s = nearest_f32(self.ahead_us) * 1.0e-6;
            write!(out, ", stamped {ahead_s:.3} s in the future: its clock and the robot's differ")?;
        }
        if self.age_us > 0 && self.age_us < u64::MAX {
            write!(out, ", {} ms old", self.age_us / 1_000)?;
        }
        write!(out, " -> {}", self.action)
    }
}
