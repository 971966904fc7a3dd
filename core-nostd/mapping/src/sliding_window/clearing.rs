//! Empties cells that the lidar sees through now.
//!
//! The published window forgets only what a person's box erases, so that a removed object stays. Here a cell between the
//! newest two scans becomes empty if both saw through it: at its elevation three neighbouring beams of each end behind it.
//! No return is no evidence, and neither is a return before the cell, or a gap between the scans that is wider than
//! objects may be.

use floorguard_types::geometry::{Point2, Point3, wrap_angle};
use floorguard_types::number::{exact_usize, truncating_u32};
use floorguard_types::time::{Age, Stamp};
use heapless::Vec;

use super::cell::{CellContent, WindowCell};
use super::column::Column;
use super::compensation::Rigid;
use super::face::Face;
use super::geometry::SIDE_MAX;
use super::look::{Edges, Look, Scans, Stand};
use super::window::SlidingWindow;

/// Scans farther apart in time say nothing about what lies between them, microseconds: two scans and a half.
const PAUSE_MAX_US: u64 = 250_000;
/// Farther apart in direction likewise, radians: 10°.
const SWEEP_MAX_RAD: f32 = 0.174_533;
/// Where neighbouring scans pass a cell farther apart than so many cells, an object may stand between them.
const GAP_CELLS: f32 = 4.0;
/// Half of a grid's sector and some more, radians: 40°.
const SECTOR_RAD: f32 = 0.698;
/// The wedge is widened by this for the search, radians: rounding, and at most this where the robot moved between the scans.
const STILL_EDGE_RAD: f32 = 0.003;
const EDGE_RAD: f32 = 0.02;
/// What it saw from its former place at this distance has moved aside by the movement over it, metres.
const NEAREST_M: f32 = 0.3;
/// Cells of one column that a wedge may empty at once.
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
    /// the columns that the wedge touches, about a quarter of a grid, nine instructions a cell; 60 for each cell within the
    /// wedge, and four arc tangents where the newest scan sees through it.
    pub(super) fn clear_swept(&mut self, wedge: SweptWedge, now: Stamp) -> u32 {
        if !self.options.clears_swept {
            return 0;
        }
        let edges = self.edges_of(wedge);
        let odometry_from_window = Rigid::of(self.frame_in_odometry());
        let mut cleared = 0_u32;
        for face in Face::ALL {
            let Some(range) = self.columns_of(face, wedge) else { continue };
            let look = Look::of(face, self, &edges);
            for column in range.first..range.end.min(SIDE_MAX) {
                let gone = self.clear_column((face, column), &look, (&odometry_from_window, now));
                cleared = cleared.saturating_add(gone);
            }
        }
        self.counters.cells_cleared = self.counters.cells_cleared.saturating_add(cleared);
        cleared
    }

    /// Empties cells of a column that both scans pass and that are not there any more; at most 64, others wait for the next
    /// sweep.
    fn clear_column(
        &mut self,
        (face, column): (Face, usize),
        look: &Look,
        (odometry_from_window, now): (&Rigid, Stamp),
    ) -> u32 {
        let Some(depths) = look.depths(column) else { return 0 };
        let columns = self.geometry.columns().max(1);
        let scans = Scans { newest: &self.newest, previous: &self.previous };
        let mut gone = Vec::<usize, GONE_MAX>::new();
        let cells = self.cells(face);
        let mut index = column;
        for row in 0..self.geometry.rows().min(SIDE_MAX) {
            let Some(cell) = cells.get(index) else { break };
            // An empty cell has elevation 0.
            if cell.elevation.wrapping_sub(depths.first) <= depths.span && cell.content != CellContent::Empty
            {
                let may_be_gone =
                    cell.content == CellContent::Person || look.may_see_through((column, row), cell, scans);
                if may_be_gone && self.is_gone((face, index, cell), odometry_from_window, now) {
                    // Full: the rest waits.
                    let _full = gone.push(index);
                }
            }
            index = index.saturating_add(columns);
        }
        for index in &gone {
            if let Some(cell) = self.cells_mut(face).get_mut(*index) {
                *cell = WindowCell::EMPTY;
            }
        }
        truncating_u32(gone.len())
    }

    #[inline(never)]
    fn is_gone(
        &self,
        (face, index, cell): (Face, usize, &WindowCell),
        odometry_from_window: &Rigid,
        now: Stamp,
    ) -> bool {
        let in_window = face.point(self.geometry.place(index, cell));
        self.is_seen_through((cell, in_window), odometry_from_window.transform(in_window), now)
    }

    /// Both ends of the wedge around the lidar's axis.
    fn edges_of(&self, wedge: SweptWedge) -> Edges {
        let frame = self.frame_in_odometry();
        let window_from_odometry = Rigid::of(frame.inverse());
        let stand = |scan: &Column| Stand::of(scan, &window_from_odometry, frame.heading_rad);
        let moved_m = self.previous.axis().distance(self.newest.axis());
        let edge_rad = STILL_EDGE_RAD + (moved_m / NEAREST_M).min(EDGE_RAD);
        let (right_sin, right_cos) = libm::sincosf(wedge.from_rad - edge_rad);
        let (left_sin, left_cos) = libm::sincosf(wedge.to_rad + edge_rad);
        Edges {
            right: Point2::new(right_cos, right_sin),
            left: Point2::new(left_cos, left_sin),
            newest: stand(&self.newest),
            previous: stand(&self.previous),
        }
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
        let resolution_m = self.geometry.resolution_m();
        let after = self.newest.see(in_odometry, mount);
        // Most surfaces are still there: the cheapest question first.
        if cell.content == CellContent::Surface && !self.newest.sees_through(&after, resolution_m) {
            return false;
        }
        let before = self.previous.see(in_odometry, mount);
        let right_rad = self.previous.beside_rad(&before, in_odometry);
        let left_rad = self.newest.beside_rad(&after, in_odometry);
        let is_between = right_rad * left_rad <= 0.0;
        let apart_m = libm::fabsf(right_rad - left_rad) * after.distance_m;
        if !is_between || apart_m > GAP_CELLS * resolution_m {
            return false;
        }
        match cell.content {
            CellContent::Person => !self.people.masks(self.box_frame(now), in_window),
            CellContent::Surface | CellContent::Empty => self.previous.sees_through(&before, resolution_m),
        }
    }
}
