//! Empties cells that the lidar sees through now.
//!
//! The published window forgets only what a person's box erases, so that a removed object stays. Here a cell between the
//! newest two scans becomes empty if both saw through it: at its elevation three neighbouring beams of each end behind it.
//! No return is no evidence, and neither is a return before the cell, or a gap between the scans that is wider than
//! objects may be.

use floorguard_types::geometry::{Point2, Point3, wrap_angle};
use floorguard_types::number::exact_usize;
use floorguard_types::time::{Age, Stamp};
use heapless::Vec;

use super::cell::{CellContent, WindowCell};
use super::compensation::Rigid;
use super::face::Face;
use super::geometry::SIDE_MAX;
use super::window::SlidingWindow;

/// Scans farther apart in time say nothing about what lies between them, microseconds: two scans and a half.
const PAUSE_MAX_US: u64 = 250_000;
/// Farther apart in direction likewise, radians: 10°.
const SWEEP_MAX_RAD: f32 = 0.174_533;
/// Where neighbouring scans pass a cell farther apart than so many cells, an object may stand between them.
const GAP_CELLS: f32 = 4.0;
/// Half of a grid's sector and some more, radians: 40°.
const SECTOR_RAD: f32 = 0.698;
/// The wedge is widened by this for the search, radians: the robot moved between the scans.
const EDGE_RAD: f32 = 0.02;
/// Cells of one row that a wedge of 10° may empty at once.
const GONE_MAX: usize = 64;

/// Directions from the robot's centre in the window's frame that were swept: from the right one to the left one, radians.
/// Invariant: `from_rad` ≤ `to_rad`; `to_rad` may exceed π.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SweptWedge {
    /// Its right end.
    pub from_rad: f32,
    /// Its left end.
    pub to_rad: f32,
}

impl SweptWedge {
    /// All directions of the window.
    pub const ALL: Self = Self { from_rad: -2.0, to_rad: 2.0 };

    /// A direction lies within.
    #[must_use]
    pub fn contains(&self, azimuth_rad: f32) -> bool {
        let middle_rad = 0.5 * (self.from_rad + self.to_rad);
        libm::fabsf(wrap_angle(azimuth_rad - middle_rad)) <= 0.5 * (self.to_rad - self.from_rad)
    }
}

/// Columns of a grid that a wedge may touch.
struct ColumnRange {
    first: usize,
    end: usize,
}

impl<S: AsRef<[WindowCell]> + AsMut<[WindowCell]>> SlidingWindow<S> {
    /// What the newest two scans have between them; `None` after a pause or a jump.
    pub(super) fn swept_wedge(&self) -> Option<SweptWedge> {
        if self.previous.is_none() || self.newest.is_none() {
            return None;
        }
        let is_near =
            matches!(self.previous.stamp.age(self.newest.stamp), Age::Past(us) if us <= PAUSE_MAX_US);
        let heading_rad = self.frame_in_odometry().heading_rad;
        let before_rad = wrap_angle(self.previous.middle_rad() - heading_rad);
        let turned_rad = wrap_angle(self.newest.middle_rad() - self.previous.middle_rad());
        let slant_rad = 0.5 * self.previous.slant_rad().max(self.newest.slant_rad());
        let is_wedge = is_near && libm::fabsf(turned_rad) <= SWEEP_MAX_RAD;
        is_wedge.then_some(SweptWedge {
            from_rad: before_rad + turned_rad.min(0.0) - slant_rad,
            to_rad: before_rad + turned_rad.max(0.0) + slant_rad,
        })
    }

    /// Empties what both scans see through, and places of people without a box. Returns how many cells. Cost: one pass over
    /// the columns that the wedge touches, about a quarter of a grid; four arc tangents for each cell within the wedge.
    pub(super) fn clear_swept(&mut self, wedge: SweptWedge, now: Stamp) -> u32 {
        if !self.options.clears_swept {
            return 0;
        }
        let edges = self.edges_of(wedge);
        let odometry_from_window = Rigid::of(self.frame_in_odometry());
        let mut cleared = 0_u32;
        for face in Face::ALL {
            let Some(range) = self.columns_of(face, wedge) else { continue };
            for row in 0..self.geometry.rows().min(SIDE_MAX) {
                let gone = self.gone_in_row((face, row, &range), &edges, (&odometry_from_window, now));
                for index in &gone {
                    if let Some(cell) = self.cells_mut(face).get_mut(*index) {
                        *cell = WindowCell::EMPTY;
                        cleared = cleared.saturating_add(1);
                    }
                }
            }
        }
        self.counters.cells_cleared = self.counters.cells_cleared.saturating_add(cleared);
        cleared
    }

    /// Both ends of the wedge around the lidar's axis.
    fn edges_of(&self, wedge: SweptWedge) -> Edges {
        let (right_sin, right_cos) = libm::sincosf(wedge.from_rad - EDGE_RAD);
        let (left_sin, left_cos) = libm::sincosf(wedge.to_rad + EDGE_RAD);
        let axis = Rigid::of(self.frame_in_odometry().inverse()).transform_flat(self.newest.axis());
        Edges { axis, right: Point2::new(right_cos, right_sin), left: Point2::new(left_cos, left_sin) }
    }

    /// Cells of a row that both scans pass and that are not there any more; at most 64, others wait for the next sweep.
    fn gone_in_row(
        &self,
        (face, row, range): (Face, usize, &ColumnRange),
        edges: &Edges,
        (odometry_from_window, now): (&Rigid, Stamp),
    ) -> Vec<usize, GONE_MAX> {
        let mut gone = Vec::new();
        let start = row.saturating_mul(self.geometry.columns());
        let ends = start.saturating_add(range.first)..start.saturating_add(range.end);
        let cells = self.cells(face).get(ends).unwrap_or(&[]);
        for (number, cell) in cells.iter().enumerate() {
            if cell.content == CellContent::Empty {
                continue;
            }
            let index = start.saturating_add(range.first).saturating_add(number);
            let in_window = face.point(self.geometry.place(index, cell));
            if edges.contain(in_window)
                && self.is_seen_through((cell, in_window), odometry_from_window.transform(in_window), now)
            {
                // Full: the rest waits.
                let _full = gone.push(index);
            }
        }
        gone
    }

    fn columns_of(&self, face: Face, wedge: SweptWedge) -> Option<ColumnRange> {
        let from_rad = wrap_angle(wedge.from_rad - face.azimuth_rad());
        let to_rad = from_rad + (wedge.to_rad - wedge.from_rad);
        if from_rad > SECTOR_RAD || to_rad < -SECTOR_RAD {
            return None;
        }
        let mount = &self.options.mount;
        let axis_m =
            libm::fabsf(mount.axis_x_m) + libm::fabsf(mount.axis_y_m) + libm::fabsf(mount.lever_arm_m);
        let reach_m = f32::from(mount.range_max_mm) * 1.0e-3 + axis_m;
        let along_m = |angle_rad: f32| libm::tanf(angle_rad.clamp(-1.0, 1.0)) * reach_m;
        let beside_m = axis_m + self.geometry.resolution_m();
        let clamp = |column: i32| {
            let column = exact_usize(column.max(0).unsigned_abs());
            column.min(self.geometry.columns())
        };
        let first = clamp(self.geometry.column_of(along_m(from_rad).min(0.0) - beside_m));
        let end = clamp(self.geometry.column_of(along_m(to_rad).max(0.0) + beside_m).saturating_add(1));
        Some(ColumnRange { first, end })
    }

    /// Both scans pass a cell on either side, and it is not there any more.
    fn is_seen_through(
        &self,
        (cell, in_window): (&WindowCell, Point3),
        in_odometry: Point3,
        now: Stamp,
    ) -> bool {
        let mount = &self.options.mount;
        let (before, after) = (self.previous.see(in_odometry, mount), self.newest.see(in_odometry, mount));
        let (right_rad, left_rad) = (self.previous.beside_rad(&before), self.newest.beside_rad(&after));
        let is_between = right_rad * left_rad <= 0.0;
        let apart_m = libm::fabsf(right_rad - left_rad) * after.distance_m;
        let resolution_m = self.geometry.resolution_m();
        if !is_between || apart_m > GAP_CELLS * resolution_m {
            return false;
        }
        match cell.content {
            CellContent::Person => !self.people.masks(self.box_frame(now), in_window),
            CellContent::Surface | CellContent::Empty => {
                self.previous.sees_through(&before, resolution_m)
                    && self.newest.sees_through(&after, resolution_m)
            }
        }
    }
}

/// A wedge around the lidar's axis in the window's frame.
struct Edges {
    axis: Point2,
    right: Point2,
    left: Point2,
}

impl Edges {
    fn contain(&self, point: Point3) -> bool {
        let (x, y) = (point.x_m - self.axis.x_m, point.y_m - self.axis.y_m);
        self.right.x_m * y - self.right.y_m * x >= 0.0 && x * self.left.y_m - y * self.left.x_m >= 0.0
    }
}
