//! A revolution of a two-dimensional safety scanner.

use heapless::Vec;

use crate::capacities::SCAN_BEAMS_MAX;
use crate::time::Stamp;

/// What one beam says. Three values, not two: "no data" must never look like "no obstacle".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BeamReturn {
    /// Something stands there, this many millimetres away.
    Hit(u16),
    /// The device itself says that there is nothing up to its range, in millimetres.
    Free(u16),
    /// Dazzled, dirty, out of order, below the minimum range, or not measured.
    #[default]
    Unknown,
}

/// A scan. Beams run counter-clockwise from `first_angle_rad`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scan {
    /// The middle of the scan, on the robot's clock.
    pub stamp: Stamp,
    /// The device's own scan counter; one that stands still means a frozen device.
    pub sequence: u32,
    /// Angle of beam 0 in the sensor's frame, radians; 0 is straight ahead.
    pub first_angle_rad: f32,
    /// Angle from beam to beam, radians, > 0.
    pub step_rad: f32,
    /// The beams.
    pub beams: Vec<BeamReturn, SCAN_BEAMS_MAX>,
}
