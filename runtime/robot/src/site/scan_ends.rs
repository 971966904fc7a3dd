//! Where the beams of a scan end.

use floorguard_types::geometry::Point2;
use floorguard_types::sensing::{BeamReturn, Scan};

/// Ends of each `interval`-th beam, in the scanner's frame.
pub fn ends_of(scan: &Scan, interval: usize) -> impl Iterator<Item = Point2> {
    scan.beams.iter().enumerate().step_by(interval).filter_map(|(beam, hit)| match hit {
        BeamReturn::Hit(range_mm) => {
            let angle = scan.first_angle_rad + beam as f32 * scan.step_rad;
            let range_m = f32::from(*range_mm) * 1.0e-3;
            let (sin, cos) = libm::sincosf(angle);
            Some(Point2::new(range_m * cos, range_m * sin))
        }
        _ => None,
    })
}
