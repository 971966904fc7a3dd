//! What a scan of the safety scanner says to the memory: what it met in its plane, and what it looked through.

use super::config::ScannerGeometry;
use super::lidar_evidence::{BEHIND_M, SAME_OBSTACLE_M};
use super::local_memory::{Cell, LocalMemory};
use super::never_seen::ends_of;
use super::scan_table::ScanTable;
use floorguard_types::geometry::Point2;
use floorguard_types::number::{nearest_f32, saturating_usize};
use floorguard_types::sensing::{BeamReturn, Scan};

/// Every so-many-th beam of a scan is compared with its neighbour, the next ones in the next scan: a cell in 3 m has two or three
/// beams, one in 1.5 m five.
const BEAM_STEP: usize = 4;
/// Of so many rows of cells one scan looks through one; the next scan through the next: 160 ms for all of them.
pub(super) const ROW_STEP: usize = 4;
/// Cells that one scan clears at most.
const SEEN_THROUGH_MAX: usize = 32;

impl LocalMemory {
    /// Takes in a scan of the safety scanner that fits the table: what it met up to `reach_m` from it, metres.
    pub fn take_scan(&mut self, scan: &Scan, table: &ScanTable, reach_m: f32) {
        self.scans = self.scans.wrapping_add(1);
        self.take_scan_of((scan, self.scans), table, reach_m);
    }

    /// The same of any scanner in that plane, with the number of its scan.
    pub(super) fn take_scan_of(&mut self, (scan, turn): (&Scan, usize), table: &ScanTable, reach_m: f32) {
        let pose = self.pose_at(scan.stamp);
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        let geometry = &table.geometry;
        let mounted = pose.transform(Point2::new(geometry.mounting.x_m, geometry.mounting.y_m));
        let heading_rad = pose.heading_rad + geometry.mounting.heading_rad;
        let sector = beams_of_sector(geometry);
        self.look_through_plane((scan, turn), (geometry, sector), (mounted, heading_rad));
        self.ends = Some(ends_of(scan, (table, sector), (mounted, Point2::new(cos, sin))));
        let [first, last] = sector;
        let offset = first.wrapping_add(turn % BEAM_STEP);
        let beams = scan.beams.iter().zip(scan.beams.iter().skip(1)).zip(&table.directions).enumerate();
        for (index, ((beam, beside), direction)) in beams.skip(offset).step_by(BEAM_STEP) {
            if index >= last {
                break;
            }
            let (BeamReturn::Hit(range_mm), BeamReturn::Hit(beside_mm)) = (*beam, *beside) else { continue };
            let range_m = f32::from(range_mm) * 1.0e-3;
            // Two beams make an object.
            if range_m > reach_m || (f32::from(beside_mm) * 1.0e-3 - range_m).abs() > SAME_OBSTACLE_M {
                continue;
            }
            let (x, y) =
                (cos * direction.x_m - sin * direction.y_m, sin * direction.x_m + cos * direction.y_m);
            self.set_scanned(
                Cell::of(Point2::new(mounted.x_m + range_m * x, mounted.y_m + range_m * y)),
                true,
            );
        }
    }

    /// Clears the scanned cells that a beam has passed through.
    fn look_through_plane(
        &mut self,
        (scan, turn): (&Scan, usize),
        (geometry, [first, last]): (&ScannerGeometry, [usize; 2]),
        (at, heading_rad): (Point2, f32),
    ) {
        let per_rad = 1.0 / geometry.step_rad;
        let mut seen_through = heapless::Vec::<Cell, SEEN_THROUGH_MAX>::new();
        self.for_each_scanned(turn % ROW_STEP, |cell| {
            let middle = cell.middle();
            let (dx, dy) = (middle.x_m - at.x_m, middle.y_m - at.y_m);
            let bearing_rad = floorguard_types::geometry::wrap_angle(libm::atan2f(dy, dx) - heading_rad);
            let beam = libm::roundf((bearing_rad - geometry.first_angle_rad) * per_rad);
            if beam < nearest_f32(first) || beam > nearest_f32(last) {
                return;
            }
            let free_m = match scan.beams.get(saturating_usize(beam)) {
                Some(BeamReturn::Hit(range_mm) | BeamReturn::Free(range_mm)) => f32::from(*range_mm) * 1.0e-3,
                _ => 0.0,
            };
            if free_m > Point2::new(dx, dy).norm() + BEHIND_M {
                // Full: the next scan clears the rest.
                let _ = seen_through.push(cell);
            }
        });
        for cell in &seen_through {
            self.leave(*cell);
        }
    }
}

/// Indices of the first and last beam that the robot's own body does not cover.
pub(super) fn beams_of_sector(geometry: &ScannerGeometry) -> [usize; 2] {
    let index = |angle_rad: f32| (angle_rad - geometry.first_angle_rad) / geometry.step_rad;
    let [first_rad, last_rad] = geometry.sector_rad;
    [
        saturating_usize(libm::ceilf(index(first_rad) - 0.5)),
        saturating_usize(libm::floorf(index(last_rad) + 0.5)),
    ]
}
