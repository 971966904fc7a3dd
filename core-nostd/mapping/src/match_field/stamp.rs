//! A return written into a level of a field.

use floorguard_types::geometry::Point2;
use floorguard_types::number::{nearest_f32, saturating_i32, saturating_u8};

use crate::grid::{GRID_SIDE_MAX, GridGeometry};

/// How a return is written.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stamp {
    /// Where the cells lie.
    pub(super) geometry: GridGeometry,
    /// Distance at which the value has fallen to zero, metres.
    pub(super) reach_m: f32,
    /// Level, as in `FieldLevel`.
    pub(super) shift: u8,
}

/// Cells that a return can reach along one direction, at most.
const REACH_CELLS_MAX: i32 = 64;

impl Stamp {
    /// Raises the values around a point.
    pub(super) fn write(&self, values: &mut [u8], point: Point2) {
        let cells_per_metre = self.geometry.cells_per_metre();
        let origin = self.geometry.origin_in_map();
        // In cells, so that cell c has its centre at c.
        let x = (point.x_m - origin.x_m) * cells_per_metre - 0.5;
        let y = (point.y_m - origin.y_m) * cells_per_metre - 0.5;
        let reach = (self.reach_m * cells_per_metre).min(nearest_f32(REACH_CELLS_MAX));
        let window = (1_i32 << self.shift.min(6)).saturating_sub(1);
        let near = |value: f32| saturating_i32(libm::ceilf(value - reach));
        let far = |value: f32| saturating_i32(libm::floorf(value + reach));
        let (width, height) = (i32::from(self.geometry.width()), i32::from(self.geometry.height()));
        let (left, right) = (near(x).saturating_sub(window).max(0), far(x).min(width.saturating_sub(1)));
        let (low, high) = (near(y).saturating_sub(window).max(0), far(y).min(height.saturating_sub(1)));
        if left > right || reach <= 0.0 {
            return;
        }
        let nearest = |value: f32| saturating_i32(libm::roundf(value));
        let (nearest_x, nearest_y) = (nearest(x), nearest(y));
        for row in low..=high.min(GRID_SIDE_MAX) {
            let away_y = y - nearest_f32(closest(nearest_y, row, window));
            let (Some(first), Some(last)) = (self.geometry.index(left, row), self.geometry.index(right, row))
            else {
                continue;
            };
            for (column, value) in (left..=right).zip(values.get_mut(first..=last).unwrap_or_default()) {
                let away_x = x - nearest_f32(closest(nearest_x, column, window));
                let share = 1.0 - libm::sqrtf(away_x * away_x + away_y * away_y) / reach;
                // Between 0 and 255: negative shares saturate to 0.
                *value = (*value).max(saturating_u8(share * 255.0 + 0.5));
            }
        }
    }
}

/// Of the cells `cell` to `cell + window`, the nearest to another one.
fn closest(nearest: i32, cell: i32, window: i32) -> i32 {
    nearest.clamp(cell, cell.saturating_add(window))
}
