//! Range per beam of the safety scanner below which something is inside a field, computed once (book, Guard: Scanner
//! check).

use super::config::{FieldSet, ScannerGeometry};
use super::field::{Polygon, ray_exit_m};
use floorguard_types::capacities::{FIELD_SETS_MAX, SCAN_BEAMS_MAX};
use floorguard_types::geometry::Point2;
use floorguard_types::number::{nearest_f32, saturating_u16, truncating_u16};

type Limits = [u16; SCAN_BEAMS_MAX];

/// Range per beam and field set below which something is inside.
///
/// ```
/// use floorguard_guard::ScanTable;
///
/// // Two millimetre limits for each beam and field set.
/// assert!(size_of::<ScanTable>() > 541 * 8 * 4);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ScanTable {
    pub(crate) protective: [Limits; FIELD_SETS_MAX],
    pub(crate) warning: [Limits; FIELD_SETS_MAX],
    /// Beams that a protective field watches.
    pub(crate) watched: [u16; FIELD_SETS_MAX],
    pub(crate) directions: [Point2; SCAN_BEAMS_MAX],
    pub(crate) geometry: ScannerGeometry,
}

impl ScanTable {
    /// No beam is watched.
    pub const EMPTY: Self = Self {
        protective: [[0; SCAN_BEAMS_MAX]; FIELD_SETS_MAX],
        warning: [[0; SCAN_BEAMS_MAX]; FIELD_SETS_MAX],
        watched: [0; FIELD_SETS_MAX],
        directions: [Point2::new(0.0, 0.0); SCAN_BEAMS_MAX],
        geometry: ScannerGeometry::NONE,
    };

    /// Precomputes the limits, in place.
    pub fn fill(&mut self, geometry: &ScannerGeometry, sets: &[FieldSet]) {
        let table = self;
        for limits in table.protective.iter_mut().chain(&mut table.warning) {
            limits.fill(0);
        }
        table.geometry = *geometry;
        for (beam, direction) in table.directions.iter_mut().enumerate() {
            let angle_rad = geometry.mounting.heading_rad + beam_angle_rad(geometry, beam);
            let (sin, cos) = libm::sincosf(angle_rad);
            *direction = Point2::new(cos, sin);
        }
        for (set, (protective, warning)) in
            sets.iter().zip(table.protective.iter_mut().zip(table.warning.iter_mut()))
        {
            fill_limits(protective, &set.protective, geometry, &table.directions);
            fill_limits(warning, &set.warning, geometry, &table.directions);
        }
        for (watched, limits) in table.watched.iter_mut().zip(&table.protective) {
            *watched = truncating_u16(limits.iter().filter(|limit| **limit > 0).count());
        }
    }
}

fn beam_angle_rad(geometry: &ScannerGeometry, beam: usize) -> f32 {
    geometry.first_angle_rad + nearest_f32(beam) * geometry.step_rad
}

fn fill_limits(limits: &mut Limits, polygon: &Polygon, geometry: &ScannerGeometry, directions: &[Point2]) {
    let origin = Point2::new(geometry.mounting.x_m, geometry.mounting.y_m);
    let [first_rad, last_rad] = geometry.sector_rad;
    for (beam, (limit_mm, direction)) in limits.iter_mut().zip(directions).enumerate().take(geometry.beams) {
        let angle_rad = beam_angle_rad(geometry, beam);
        // Half a step of slack keeps the end beams of the sector.
        let slack_rad = 0.5 * geometry.step_rad;
        if angle_rad >= first_rad - slack_rad && angle_rad <= last_rad + slack_rad {
            // Rounded up; the cast saturates.
            *limit_mm = saturating_u16(libm::ceilf(ray_exit_m(polygon, origin, *direction) * 1.0e3));
        }
    }
}
