//! Where the cells of a vertical grid lie, and places within a cell.

use floorguard_types::number::{nearest_f32, saturating_i32, saturating_u8, saturating_usize};

use super::capacities::{WINDOW_HALF_WIDTH_M, WINDOW_HEIGHT_M};
use super::cell::{ELEVATION_STEP_M, WindowCell};
use super::face::FacePoint;

/// Steps of a place within a cell, over its whole edge: from −128 to 127 from the centre.
const STEPS_IN_CELL: f32 = 256.0;
/// Edges of cells, metres: below, noise of the lidar is larger than a cell; above, a person fits into one.
const RESOLUTION_M: core::ops::RangeInclusive<f32> = 0.01..=0.5;
/// Sides of a grid, cells: a bound of loops.
pub(super) const SIDE_MAX: usize = 1024;
pub(super) const FACE_CELLS_MAX: usize = SIDE_MAX * SIDE_MAX;

/// Columns, rows and edge of a cell, the same for the three grids. Columns run from right to left as seen from the robot,
/// rows upwards from the floor. Invariants: both sides within 1…1,024; edge within 0.01…0.5 m.
///
/// ```
/// use floorguard_mapping::sliding_window::WindowGeometry;
///
/// let geometry = WindowGeometry::of_resolution(0.05).unwrap();
/// assert_eq!((geometry.columns(), geometry.rows(), geometry.cells()), (124, 48, 17_856));
/// assert_eq!(WindowGeometry::of_resolution(0.0), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowGeometry {
    resolution_m: f32,
    cells_per_metre: f32,
    half_width_m: f32,
    columns: u16,
    rows: u16,
}

/// A cell of a grid, and where in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot {
    /// Within its grid.
    pub(super) index: usize,
    /// From the centre of the cell, in 256ths of its edge.
    pub(super) along: i8,
    pub(super) up: i8,
}

/// A row or a column, and where in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) cell: usize,
    pub(super) steps: i8,
}

/// The cell of a place in cells from the corner; `None` outside of so many cells, and for NaN.
#[inline]
fn part_of(from_corner: f32, cells: u16) -> Option<Part> {
    if !(from_corner >= 0.0 && from_corner < f32::from(cells)) {
        return None;
    }
    // Not negative: towards zero is downwards.
    let cell = saturating_usize(from_corner);
    let fraction = from_corner - nearest_f32(cell);
    // Up to 255: the low eight bits of 128 less.
    let steps = saturating_u8(fraction * STEPS_IN_CELL + 0.5).wrapping_sub(128).cast_signed();
    Some(Part { cell, steps })
}

/// A place in a cell as a part of its edge, 0…1.
#[inline]
fn within(steps: i8) -> f32 {
    0.5 + f32::from(steps) * (1.0 / STEPS_IN_CELL)
}

impl WindowGeometry {
    /// The window as published: 6.2 m wide, 2.4 m high (Dalmedico et al. 2019; the width follows from the range of
    /// the lidar). `None` for an edge outside 0.01…0.5 m.
    #[must_use]
    pub fn of_resolution(resolution_m: f32) -> Option<Self> {
        Self::new(resolution_m, WINDOW_HALF_WIDTH_M, WINDOW_HEIGHT_M)
    }

    /// Edge of a cell, half of the width and the height, metres. `None` for an edge outside 0.01…0.5 m or a side outside
    /// 1…1,024 cells.
    #[must_use]
    pub fn new(resolution_m: f32, half_width_m: f32, height_m: f32) -> Option<Self> {
        if !RESOLUTION_M.contains(&resolution_m) {
            return None;
        }
        let cells = |length_m: f32| {
            let count = saturating_usize(libm::roundf(length_m / resolution_m));
            if (1..=SIDE_MAX).contains(&count) { u16::try_from(count).ok() } else { None }
        };
        Some(Self {
            resolution_m,
            cells_per_metre: 1.0 / resolution_m,
            half_width_m,
            columns: cells(2.0 * half_width_m)?,
            rows: cells(height_m)?,
        })
    }

    /// Edge of a cell, metres.
    #[must_use]
    pub const fn resolution_m(&self) -> f32 {
        self.resolution_m
    }

    /// Half of the width of a grid, metres.
    pub(super) const fn half_width_m(&self) -> f32 {
        self.half_width_m
    }

    /// Cells along the floor.
    #[must_use]
    pub fn columns(&self) -> usize {
        usize::from(self.columns)
    }

    /// Cells upwards.
    #[must_use]
    pub fn rows(&self) -> usize {
        usize::from(self.rows)
    }

    /// Cells of one grid.
    #[must_use]
    pub fn face_cells(&self) -> usize {
        self.columns().saturating_mul(self.rows())
    }

    /// Cells of all three grids: what one buffer must hold.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.face_cells().saturating_mul(3)
    }

    /// The column that holds a place along the grid; may lie outside.
    pub(super) fn column_of(&self, along_m: f32) -> i32 {
        saturating_i32(libm::floorf((along_m + self.half_width_m) * self.cells_per_metre))
    }

    /// The cell of a point and where in it; `None` outside, and for what is not finite.
    #[inline]
    pub(super) fn slot(&self, seen: FacePoint) -> Option<Slot> {
        let column = self.column(seen.along_m)?;
        let row = part_of(seen.up_m * self.cells_per_metre, self.rows)?;
        let index = row.cell.saturating_mul(self.columns()).saturating_add(column.cell);
        Some(Slot { index, along: column.steps, up: row.steps })
    }

    /// The column that holds a place along the grid, and where in it.
    #[inline]
    pub(super) fn column(&self, along_m: f32) -> Option<Part> {
        part_of((along_m + self.half_width_m) * self.cells_per_metre, self.columns)
    }

    /// Place along the grid of something in a column.
    #[inline]
    pub(super) fn along_m(&self, column: usize, steps: i8) -> f32 {
        (nearest_f32(column) + within(steps)) * self.resolution_m - self.half_width_m
    }

    /// Height of something in a row.
    #[inline]
    pub(super) fn up_m(&self, row: usize, steps: i8) -> f32 {
        (nearest_f32(row) + within(steps)) * self.resolution_m
    }

    /// Where the content of a cell lies, as exactly as the cell keeps it.
    pub(super) fn place(&self, index: usize, cell: &WindowCell) -> FacePoint {
        let columns = self.columns().max(1);
        FacePoint {
            along_m: self.along_m(index % columns, cell.along),
            up_m: self.up_m(index / columns, cell.up),
            elevation_m: f32::from(cell.elevation) * ELEVATION_STEP_M,
        }
    }

    /// The centre of a cell along the grid and upwards, metres; its elevation is 0.
    #[must_use]
    pub fn centre(&self, index: usize) -> FacePoint {
        self.place(index, &WindowCell::EMPTY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_kept_to_a_256th() {
        let geometry = WindowGeometry::of_resolution(0.05).unwrap();
        let mut worst_m = 0.0_f32;
        for step in 0..4_000_u16 {
            let seen = FacePoint {
                along_m: -3.0 + f32::from(step) * 0.0015,
                up_m: 0.01 + f32::from(step) * 0.0005,
                elevation_m: 1.0,
            };
            let slot = geometry.slot(seen).unwrap();
            let cell = WindowCell { elevation: 8_000, along: slot.along, up: slot.up, ..WindowCell::EMPTY };
            let back = geometry.place(slot.index, &cell);
            worst_m = worst_m.max((back.along_m - seen.along_m).abs()).max((back.up_m - seen.up_m).abs());
            assert!((back.elevation_m - 1.0).abs() < 1e-6);
        }
        // Half a step; a whole one just below the next cell.
        assert!(worst_m <= 0.05 / 256.0 + 2e-6, "{worst_m}");
    }

    #[test]
    fn points_outside_have_no_cell() {
        let geometry = WindowGeometry::of_resolution(0.1).unwrap();
        let at = |along_m, up_m| geometry.slot(FacePoint { along_m, up_m, elevation_m: 1.0 });
        assert!(at(3.09, 2.39).is_some() && at(-3.1, 0.0).is_some());
        for (along_m, up_m) in
            [(3.11, 1.0), (-3.11, 1.0), (0.0, -0.01), (0.0, 2.41), (f32::NAN, 1.0), (0.0, f32::NAN)]
        {
            assert_eq!(at(along_m, up_m), None);
        }
        assert_eq!(geometry.column_of(-3.05), 0);
        assert_eq!(WindowGeometry::new(0.01, 6.0, 2.4), None);
        assert_eq!(WindowGeometry::of_resolution(f32::NAN), None);
    }
}
