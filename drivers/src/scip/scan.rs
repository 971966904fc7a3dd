//! A scan, as the sensor sent it and as a measurement.

use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;
use heapless::Vec;

use super::command::{RangeKind, ScanRange};

/// Values of a scan: a whole turn of a UST-10LX has 1,440 steps, of which 1,081 measure.
pub const SCIP_BEAMS_MAX: usize = 1_441;

/// A scan as it was sent.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RawScan {
    /// What was measured.
    pub kind: RangeKind,
    /// Which steps.
    pub range: ScanRange,
    /// Scans that are still to come, as the sensor says; `None` for the newest scan, which was asked for alone.
    pub remaining: Option<u8>,
    /// Of 24 bits, milliseconds, when the sensor's mirror passed step 0.
    pub sensor_ms: u32,
    /// Millimetres, one for each step or cluster. Numbers below the sensor's least range are error codes.
    pub distances_mm: Vec<u32, SCIP_BEAMS_MAX>,
    /// Strengths, with [`RangeKind::Strength`] only.
    pub strengths: Vec<u32, SCIP_BEAMS_MAX>,
}

impl RawScan {
    /// No value.
    pub const EMPTY: Self = Self {
        kind: RangeKind::Distance,
        range: ScanRange { first_step: 0, last_step: 0, cluster: 0 },
        remaining: None,
        sensor_ms: 0,
        distances_mm: Vec::new(),
        strengths: Vec::new(),
    };
}

/// A scan as a measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeasuredScan {
    /// When the first beam was measured, on the robot's clock.
    pub first_beam: Stamp,
    /// From beam to beam, microseconds.
    pub beam_period_us: f32,
    /// Angle of the first beam, radians; 0 is the sensor's front.
    pub first_angle_rad: f32,
    /// From beam to beam, radians, counter-clockwise as seen from above the sensor.
    pub step_rad: f32,
    /// The beams. What the sensor calls an error, and what is nearer or farther than it can measure, is unknown: never free.
    pub beams: Vec<BeamReturn, SCIP_BEAMS_MAX>,
}

impl MeasuredScan {
    /// No beam.
    pub const EMPTY: Self = Self {
        first_beam: Stamp::ZERO,
        beam_period_us: 0.0,
        first_angle_rad: 0.0,
        step_rad: 0.0,
        beams: Vec::new(),
    };
}
