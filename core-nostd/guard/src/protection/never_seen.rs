//! Places beside the body that no beam of the safety scanner has passed through, near to what it has met.
//!
//! The scanner does not look beside and behind the body. Of an object that stands there since the memory began it meets the far side
//! at most: the near one, before it, is where a flank or the tail turns (FG-REQ-069). What the robot comes by crosses the first or the
//! last beam of the sector before it lies there: what these have passed through is known (book, Fields of the swept body: Memory).

use super::collision::Body;
use super::lidar_evidence::parts;
use super::local_memory::{CELL_M, LocalMemory, SIDE, local};
use super::scan_evidence::beams_of_sector;
use super::scan_table::ScanTable;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{count_i32, count_u32, exact_usize, saturating_i32};
use floorguard_types::sensing::{BeamReturn, Scan};

/// What the scanner met may go on so far, cells to each side: 0.29 m.
const GOES_ON: usize = 4;
/// Cells along the first and the last beam that are marked: 1.5 m, which is 0.6 m beside the body.
const MARKED: i32 = 20;
/// Places farther from the body than this are not asked for, metres.
const AROUND_M: f32 = 0.6;
/// So far behind the first or the last beam it has passed through a cell, metres: half a cell, and what a robot at its greatest speed goes
/// until a scan is taken in.
const PASSED_M: f32 = 0.1;

/// What a scanner does not see: between its last beam and its first one.
#[derive(Clone, Copy)]
pub struct Blind {
    at: Point2,
    first: Point2,
    last: Point2,
}

impl Blind {
    /// Of a scanner, robot frame; `None`: it has no beam.
    pub fn of(table: &ScanTable) -> Option<Self> {
        let mounting = &table.geometry.mounting;
        let [first, last] = beams_of_sector(&table.geometry).map(|beam| table.directions.get(beam).copied());
        Some(Self { at: Point2::new(mounting.x_m, mounting.y_m), first: first?, last: last? })
    }

    /// A place of the robot frame lies there. Of a sector of less than half a turn what lies behind both its ends.
    fn has(&self, place: Point2) -> bool {
        let to = Point2::new(place.x_m - self.at.x_m, place.y_m - self.at.y_m);
        let left_of = |of: Point2| of.x_m * to.y_m - of.y_m * to.x_m;
        left_of(self.last) > PASSED_M && left_of(self.first) < -PASSED_M
    }
}

/// Where a scanner was when it scanned, and direction and range of its first and its last beam, metres and millimetres, in the memory's
/// frame.
pub(super) type Ends = (Point2, [(Point2, u16); 2]);

/// Of a scan; what is unknown passes through nothing.
pub(super) fn ends_of(
    scan: &Scan,
    (table, sector): (&ScanTable, [usize; 2]),
    (at, turned): (Point2, Point2),
) -> Ends {
    let end = |beam: usize| {
        let direction = table.directions.get(beam).copied().unwrap_or_default();
        let (x, y) = (direction.x_m, direction.y_m);
        let range_mm = match scan.beams.get(beam) {
            Some(BeamReturn::Hit(range_mm) | BeamReturn::Free(range_mm)) => *range_mm,
            _ => 0,
        };
        (Point2::new(turned.x_m * x - turned.y_m * y, turned.y_m * x + turned.x_m * y), range_mm)
    };
    (at, sector.map(end))
}

impl LocalMemory {
    /// Marks what the first and the last beam of the newest scan have passed through: at most 40 cells. Beside the decision on a scan, which has
    /// no time for it.
    pub fn mark_ends(&mut self) {
        let Some((at, beams)) = self.ends.take() else { return };
        let from = self.in_window(at);
        let corner = (local(self.first.x), local(self.first.y));
        for (direction, range_mm) in beams {
            let (along_x, along_y) = (parts(direction.x_m), parts(direction.y_m));
            let (mut x, mut y) = (parts(from.x_m), parts(from.y_m));
            let passed = saturating_i32(f32::from(range_mm) * (1.0e-3 / CELL_M));
            for step in 0..MARKED {
                let (column, line) =
                    (exact_usize((x >> 16).cast_unsigned()), exact_usize((y >> 16).cast_unsigned()));
                if step >= passed || column >= SIDE || line >= SIDE {
                    break;
                }
                if let Some(row) = self.rows.get_mut(corner.1.wrapping_add(line) % SIDE) {
                    row.set_passed(corner.0.wrapping_add(column) % SIDE);
                }
                (x, y) = (x.wrapping_add(along_x), y.wrapping_add(along_y));
            }
        }
    }

    /// Visits the cells near the body that no beam has passed through, near to what the scanner has met, where it does not see. At
    /// most 4,096, each in the robot frame.
    pub fn for_each_never_seen(
        &self,
        blind: &Blind,
        (pose, body): (Pose2, &Body),
        mut visit: impl FnMut(Point2),
    ) {
        let [columns, rows] = self.around(pose, body);
        let bits = span(columns);
        let first = count_u32(local(self.first.x));
        let row_of = |y: usize| self.rows.get(local(self.first.y).wrapping_add(y) % SIDE);
        let mut near = [0_u64; SIDE];
        for (y, near) in near.iter_mut().enumerate() {
            let met = row_of(y).map_or(0, |row| row.by_scanner.rotate_right(first));
            let beside = met | met.wrapping_shl(1) | met.wrapping_shr(1);
            let two = beside | beside.wrapping_shl(1) | beside.wrapping_shr(1);
            *near = two | two.wrapping_shl(2) | two.wrapping_shr(2);
        }
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        for y in 0..SIDE {
            if y < rows[0] || y > rows[1] {
                continue;
            }
            let known = row_of(y).map_or(u64::MAX, |row| (row.kept() | row.passed).rotate_right(first));
            let met =
                near.iter().skip(y.saturating_sub(GOES_ON)).take(y.min(GOES_ON).saturating_add(GOES_ON + 1));
            let mut word = met.fold(0, |near, row| near | row) & bits & !known;
            for _ in 0..SIDE {
                if word == 0 {
                    break;
                }
                let x = word.trailing_zeros().cast_signed();
                word &= word.wrapping_sub(1);
                let place = self.cell_in_window(x, count_i32(y)).middle();
                let (dx, dy) = (place.x_m - pose.x_m, place.y_m - pose.y_m);
                let in_robot = Point2::new(cos * dx + sin * dy, cos * dy - sin * dx);
                if blind.has(in_robot) && body.distance_m(in_robot) > 0.0 {
                    visit(in_robot);
                }
            }
        }
    }

    /// Columns and rows of the window, counted from its corner, around the body: first and last ones.
    fn around(&self, pose: Pose2, body: &Body) -> [[usize; 2]; 2] {
        let mut around = [[f32::INFINITY, f32::NEG_INFINITY]; 2];
        for (x_m, y_m) in body.x_m.into_iter().flat_map(|x_m| body.y_m.map(|y_m| (x_m, y_m))) {
            let corner = self.in_window(pose.transform(Point2::new(x_m, y_m)));
            for ([least, greatest], value) in around.iter_mut().zip([corner.x_m, corner.y_m]) {
                *least = least.min(value - AROUND_M / CELL_M);
                *greatest = greatest.max(value + AROUND_M / CELL_M);
            }
        }
        around.map(|ends| ends.map(|cells| floorguard_types::number::saturating_usize(cells).min(SIDE - 1)))
    }
}

/// The bits from one to another, both included.
const fn span([first, last]: [usize; 2]) -> u64 {
    let to_last = u64::MAX.wrapping_shr(count_u32((SIDE - 1).saturating_sub(last)));
    to_last & u64::MAX.wrapping_shl(count_u32(first))
}
