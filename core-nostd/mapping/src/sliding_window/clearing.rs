//! Empties cells that the lidar sees through now.
//!
//! The published window forgets only what a person's box erases, so that a removed object stays. Here a cell between the
//! newest two scans becomes empty if both saw through it: at its elevation three neighbouring beams of each end behind it.
//! No return is no evidence, and neither is a return before the cell, or a gap between the scans that is wider than
//! objects may be.

use floorguard_types::geometry::wrap_angle;
use floorguard_types::number::exact_usize;
use floorguard_types::time::{Age, Stamp};

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
    /// the columns that the wedge touches, about a quarter of a grid.
    pub(super) fn clear_swept(&mut self, wedge: SweptWedge, now: Stamp) -> u32 {
        if !self.options.clears_swept {
            return 0;
        }
        let mut cleared = 0_u32;
        for face in Face::ALL {
            let Some(range) = self.columns_of(face, wedge) else { continue };
            for row in 0..self.geometry.rows().min(SIDE_MAX) {
                let start = row.saturating_mul(self.geometry.columns());
                for column in (range.first..range.end).take(SIDE_MAX) {
                    let index = start.saturating_add(column);
                    if self.is_seen_through((face, index), now)
                        && let Some(cell) = self.cells_mut(face).get_mut(index)
                    {
                        *cell = WindowCell::EMPTY;
                        cleared = cleared.saturating_add(1);
                    }
                }
            }
        }
        self.counters.cells_cleared = self.counters.cells_cleared.saturating_add(cleared);
        cleared
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
    fn is_seen_through(&self, (face, index): (Face, usize), now: Stamp) -> bool {
        let Some(cell) = self.cells(face).get(index).filter(|cell| cell.content != CellContent::Empty) else {
            return false;
        };
        let in_window = face.point(self.geometry.place(index, cell));
        let point = Rigid::of(self.frame_in_odometry()).transform(in_window);
        let mount = &self.options.mount;
        let (before, after) = (self.previous.see(point, mount), self.newest.see(point, mount));
        let (right_rad, left_rad) = (self.previous.beside_rad(&before), self.newest.beside_rad(&after));
        let is_between = right_rad * left_rad <= 0.0;
        let apart_m = libm::fabsf(right_rad - left_rad) * after.distance_m;
        let resolution_m = self.geometry.resolution_m();
        if !is_between || apart_m > GAP_CELLS * resolution_m {
            return false;
        }
        match cell.content {
            CellContent::Person => !self.is_within_box(in_window, now),
            CellContent::Surface | CellContent::Empty => {
                self.previous.sees_through(&before, resolution_m)
                    && self.newest.sees_through(&after, resolution_m)
            }
        }
    }
}
