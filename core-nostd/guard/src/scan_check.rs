//! Safety scanner against the fields: one comparison per beam and field (book, Guard: Scanner check).

use crate::protection::{Blocked, Body, ScanTable};
use floorguard_types::geometry::Point2;
use floorguard_types::sensing::{BeamReturn, Scan};

/// Share of silent beams that counts as blocked, percent (book, Guard: Blind sectors).
pub const SILENT_PERCENT_MAX: f32 = 5.0;
/// Angle of adjacent silent beams that counts as blocked, radians: 3°.
pub const SILENT_RUN_RAD: f32 = 3.0 * floorguard_types::units::RADIANS_PER_DEGREE;

/// What one scan says about one field set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScanFinding {
    /// Enough adjacent beams end inside the protective field.
    pub protective: bool,
    /// Enough adjacent beams end inside the warning field.
    pub warning: bool,
    /// Least range of those, metres, and the protective limit of that beam.
    pub nearest_m: f32,
    /// Limit of the beam of `nearest_m`, metres.
    pub nearest_limit_m: f32,
    /// Silent beams within the field, percent.
    pub silent_percent: f32,
    /// Widest angle of adjacent silent beams, radians.
    pub silent_run_rad: f32,
    /// Where the robot must not go.
    pub blocked: Blocked,
}

impl ScanFinding {
    /// Too much of the field is not seen (FG-REQ-024).
    #[must_use]
    pub fn is_blind(&self) -> bool {
        self.silent_percent > SILENT_PERCENT_MAX || self.silent_run_rad > SILENT_RUN_RAD
    }
}

impl ScanTable {
    /// The scan has the beams that the table was made for.
    #[must_use]
    pub fn fits(&self, scan: &Scan) -> bool {
        let same_start = (scan.first_angle_rad - self.geometry.first_angle_rad).abs() < 1.0e-3;
        let same_step = (scan.step_rad - self.geometry.step_rad).abs() < 1.0e-5;
        scan.beams.len() == self.geometry.beams && same_start && same_step
    }

    /// Compares each beam with the limits of a set (FG-REQ-020).
    #[must_use]
    pub fn check(&self, scan: &Scan, set: usize, (adjacent, body): (u8, &Body)) -> ScanFinding {
        let mut finding = ScanFinding { nearest_m: f32::INFINITY, ..ScanFinding::default() };
        let sets = (self.protective.get(set), self.warning.get(set), self.watched.get(set));
        let (Some(protective), Some(warning), Some(watched)) = sets else { return finding };
        let (mut run, mut warning_run, mut silent_run) = (0_u8, 0_u8, 0_u16);
        let (mut silent, mut widest) = (0_u16, 0_u16);
        for (index, (beam, (limit_mm, warning_mm))) in
            scan.beams.iter().zip(protective.iter().zip(warning)).enumerate()
        {
            // Most beams do not end within either field.
            if beam.is_behind(*limit_mm, *warning_mm) {
                (run, warning_run, silent_run) = (0, 0, 0);
                continue;
            }
            let range_mm = range_of(*beam, *limit_mm);
            let is_silent = range_mm.is_none() && *limit_mm > 0;
            silent = silent.saturating_add(u16::from(is_silent));
            silent_run = if is_silent { silent_run.saturating_add(1) } else { 0 };
            widest = widest.max(silent_run);
            let range_mm = range_mm.unwrap_or(u16::MAX);
            run = if range_mm < *limit_mm { run.saturating_add(1) } else { 0 };
            warning_run = if range_mm < *warning_mm { warning_run.saturating_add(1) } else { 0 };
            finding.warning |= warning_run >= adjacent;
            finding.protective |= run >= adjacent;
            if let Some(direction) = self.directions.get(index).filter(|_| range_mm < *limit_mm) {
                self.note_hit(&mut finding, (range_mm, *limit_mm), (*direction, body));
            }
        }
        finding.silent_percent = 100.0 * f32::from(silent) / f32::from(*watched).max(1.0);
        finding.silent_run_rad = f32::from(widest) * self.geometry.step_rad;
        finding
    }

    fn note_hit(
        &self,
        finding: &mut ScanFinding,
        (range_mm, limit_mm): (u16, u16),
        (direction, body): (Point2, &Body),
    ) {
        let range_m = f32::from(range_mm) * 1.0e-3;
        if range_m < finding.nearest_m {
            finding.nearest_m = range_m;
            finding.nearest_limit_m = f32::from(limit_mm) * 1.0e-3;
        }
        let origin = self.geometry.mounting;
        let point = Point2::new(origin.x_m + range_m * direction.x_m, origin.y_m + range_m * direction.y_m);
        finding.blocked.add(point, body);
    }
}

/// Millimetres to what stands there, the greatest number where nothing does, `None` where unknown. A beam that is
/// free only up to less than the limit says nothing about the rest of the field.
fn range_of(beam: BeamReturn, limit_mm: u16) -> Option<u16> {
    match beam {
        BeamReturn::Hit(range_mm) => Some(range_mm),
        BeamReturn::Free(range_mm) if range_mm >= limit_mm => Some(u16::MAX),
        _ => None,
    }
}
