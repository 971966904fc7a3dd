//! Sweeps as they are measured, before anything is known of where the sensor was.

use floorguard_types::geometry::Point3;

/// Rings of the fan; lidars with fewer leave the rest empty.
pub const FAN_RINGS: usize = 32;

/// A return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawReturn {
    /// In the sensor's frame, metres.
    pub point_in_sensor: Point3,
    /// Seconds since the start of the sweep.
    pub offset_s: f32,
    /// Ring, lowest first.
    pub ring: u8,
}

/// A revolution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawSweep {
    /// Seconds on the clock of the poses.
    pub start_s: f64,
    /// Returns in the order of their times.
    pub returns: Vec<RawReturn>,
}

impl RawSweep {
    /// Seconds from the start to the last return.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.returns.last().map_or(0.0, |last| f64::from(last.offset_s))
    }
}
