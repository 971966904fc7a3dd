//! What the scans of a bridge are, as the robot's file says it.

use super::decode_error::{DecodeError, ShapePart};
use super::frame::ScanHead;

/// Two angles that differ by less are the same, millionths of a degree: the guard's own tolerance is 57,000.
const SAME_ANGLE_UDEG: i64 = 50_000;
/// Two steps that differ by less are the same, millionths of a degree: the guard's own tolerance is 570.
const SAME_STEP_UDEG: i64 = 500;

/// What the scans of a bridge are: others are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScanShape {
    /// Beams of a scan.
    pub beams: u16,
    /// Angle of the first one, counter-clockwise from straight ahead, millionths of a degree.
    pub first_udeg: i32,
    /// From beam to beam, counter-clockwise, millionths of a degree.
    pub step_udeg: u32,
    /// From scan to scan, microseconds.
    pub period_us: u32,
    /// What is nearer or farther is not believed, millimetres.
    pub range_mm: [u16; 2],
}

impl ScanShape {
    /// Whether a scan has these beams, at these angles: a beam that points elsewhere is an obstacle in the wrong place.
    pub(super) fn check(&self, head: &ScanHead) -> Result<(), DecodeError> {
        let differs = |part, found: i64, expected: i64, tolerance: i64| {
            let is_other = found.saturating_sub(expected).abs() > tolerance;
            is_other.then_some(DecodeError::Shape { part, found, expected })
        };
        let last = |first: i32, step: u32| {
            let steps = i64::from(self.beams.saturating_sub(1));
            i64::from(step).saturating_mul(steps).saturating_add(i64::from(first))
        };
        let (found, expected) =
            (last(head.first_udeg, head.step_udeg), last(self.first_udeg, self.step_udeg));
        let first = (i64::from(head.first_udeg), i64::from(self.first_udeg));
        let step = (i64::from(head.step_udeg), i64::from(self.step_udeg));
        let difference = differs(ShapePart::Beams, i64::from(head.beams), i64::from(self.beams), 0)
            .or_else(|| differs(ShapePart::FirstAngle, first.0, first.1, SAME_ANGLE_UDEG))
            .or_else(|| differs(ShapePart::Step, step.0, step.1, SAME_STEP_UDEG))
            .or_else(|| differs(ShapePart::LastAngle, found, expected, SAME_ANGLE_UDEG));
        difference.map_or(Ok(()), Err)
    }
}
