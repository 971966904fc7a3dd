//! A return written into both levels of a field.

use floorguard_types::geometry::Point2;
use floorguard_types::number::{nearest_f32, saturating_i32, saturating_u8};

use super::part::FieldPart;
use crate::grid::{GridCoordinates, GridGeometry};

/// How a return is written.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stamp {
    /// Where the cells lie.
    pub(super) geometry: GridGeometry,
    /// Which of them are stored.
    pub(super) part: FieldPart,
    /// Distance at which the value has fallen to zero, metres.
    pub(super) reach_m: f32,
    /// Level of the coarse values, as in `FieldLevel`; at most [`SHIFT_MAX`].
    pub(super) shift: u8,
}

/// Cells that a return can reach along one direction, at most.
const REACH_CELLS_MAX: i32 = 64;
/// Rows that it can reach, at most.
const ROWS_MAX: i32 = 2 * REACH_CELLS_MAX + 2;
/// The coarsest level that is written with a return.
pub(super) const SHIFT_MAX: u8 = 3;
/// Values of a row of a return, with what the coarse level adds at its start.
const ROW: usize = 2 * 64 + 2 + 7;

/// The square of cells that a return reaches, and the return itself, in cells: cell c has its centre at c.
struct Reached {
    x: f32,
    y: f32,
    reach: f32,
    left: i32,
    low: i32,
    high: i32,
    count: usize,
}

impl Stamp {
    /// Raises the values around a point. A coarse cell bounds the fine ones that begin at it: each fine row is spread to the left
    /// and raises the coarse rows of which it is part.
    pub(super) fn write(&self, fine: &mut [u8], coarse: &mut [u8], point: Point2) {
        let Some(reached) = self.reached(point) else { return };
        let window = (1_i32 << self.shift.min(SHIFT_MAX)).saturating_sub(1);
        let lead = usize::try_from(window).unwrap_or(0);
        let mut row_values = [0_u8; ROW];
        let mut spread = [0_u8; ROW];
        let rows = reached.high.saturating_sub(reached.low).saturating_add(1);
        for below in 0..rows.min(ROWS_MAX) {
            let row = reached.low.saturating_add(below);
            let Some(values) = row_values.get_mut(lead..lead.saturating_add(reached.count)) else { return };
            reached.values(row, values);
            self.raise(fine, (reached.left, row), values);
            let whole = lead.saturating_add(reached.count);
            let (Some(source), Some(target)) = (row_values.get(..whole), spread.get_mut(..whole)) else {
                return;
            };
            target.iter_mut().zip(source).for_each(|(value, own)| *value = *own);
            for by in 1..=lead.min(7) {
                let later = source.get(by..).unwrap_or_default();
                target.iter_mut().zip(later).for_each(|(value, other)| *value = (*value).max(*other));
            }
            for below in 0..=window.min(7) {
                self.raise(coarse, (reached.left.saturating_sub(window), row.saturating_sub(below)), target);
            }
        }
    }

    /// The first and the last cell of the raster that a return writes in either level.
    pub(super) fn reached_cells(&self, point: Point2) -> Option<[GridCoordinates; 2]> {
        let reached = self.reached(point)?;
        let lead = (1_i32 << self.shift.min(SHIFT_MAX)).saturating_sub(1);
        let right = reached.left.saturating_add(i32::try_from(reached.count).unwrap_or(i32::MAX));
        let (width, height) = (i32::from(self.geometry.width()), i32::from(self.geometry.height()));
        let first = |low: i32| low.saturating_sub(lead).max(0);
        let last = |high: i32, side: i32| high.min(side).saturating_sub(1);
        Some([
            GridCoordinates { column: first(reached.left), row: first(reached.low) },
            GridCoordinates { column: last(right, width), row: last(reached.high.saturating_add(1), height) },
        ])
    }

    fn reached(&self, point: Point2) -> Option<Reached> {
        let cells_per_metre = self.geometry.cells_per_metre();
        let origin = self.geometry.origin_in_map();
        let x = (point.x_m - origin.x_m) * cells_per_metre - 0.5;
        let y = (point.y_m - origin.y_m) * cells_per_metre - 0.5;
        let reach = (self.reach_m * cells_per_metre).min(nearest_f32(REACH_CELLS_MAX));
        let near = |value: f32| saturating_i32(libm::ceilf(value - reach));
        let far = |value: f32| saturating_i32(libm::floorf(value + reach));
        let (width, height) = (i32::from(self.geometry.width()), i32::from(self.geometry.height()));
        let (left, right, low, high) = (near(x), far(x), near(y), far(y));
        let is_beside = right < 0 || high < 0 || left >= width || low >= height;
        let count = usize::try_from(right.saturating_sub(left).saturating_add(1)).ok()?;
        (reach > 0.0 && !is_beside).then_some(Reached { x, y, reach, left, low, high, count })
    }

    /// Makes values at least as large as others; what lies beside what is stored is left out.
    fn raise(&self, values: &mut [u8], (left, row): (i32, i32), others: &[u8]) {
        let begins = self.part.first.column;
        let columns = i32::try_from(self.part.sides.columns).unwrap_or(i32::MAX);
        let from = left.max(begins);
        let hidden = usize::try_from(from.saturating_sub(left)).unwrap_or(usize::MAX);
        let seen = usize::try_from(begins.saturating_add(columns).saturating_sub(from)).unwrap_or(0);
        let others = others.get(hidden..).unwrap_or_default();
        let others = others.get(..seen.min(others.len())).unwrap_or_default();
        let Some(first) = self.part.index(from, row) else { return };
        let cells = values.get_mut(first..first.saturating_add(others.len())).unwrap_or_default();
        cells.iter_mut().zip(others).for_each(|(value, other)| *value = (*value).max(*other));
    }
}

impl Reached {
    /// The values of the cells of a row.
    fn values(&self, row: i32, values: &mut [u8]) {
        let away_y = self.y - nearest_f32(row);
        let first = nearest_f32(self.left);
        let per_cell = 255.0 / self.reach;
        for (index, value) in values.iter_mut().enumerate() {
            let away_x = self.x - (first + nearest_f32(index));
            let away = libm::sqrtf(away_x * away_x + away_y * away_y);
            // Between 0 and 255: negative shares saturate to 0.
            *value = saturating_u8(255.5 - away * per_cell);
        }
    }
}
