//! A grid that moves with the robot: its origin shifts by whole cells, and what comes in is unknown.

use floorguard_types::geometry::Point2;
use floorguard_types::number::exact_usize;

use super::grid::{GRID_CELLS_MAX, Grid};
use crate::GridCoordinates;

/// By how many cells a grid was moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GridShift {
    /// Towards larger x.
    pub columns: i32,
    /// Towards larger y.
    pub rows: i32,
}

impl<T: Copy, S: AsRef<[T]> + AsMut<[T]>> Grid<T, S> {
    /// Moves the window so that a point of the map frame lies in its middle cell. Values keep their places in the map; cells
    /// that come in get `fresh`. A point that is not finite moves nothing. Cost: one copy of all values.
    pub fn recentre(&mut self, centre_in_map: Point2, fresh: T) -> GridShift {
        if !centre_in_map.norm().is_finite() {
            return GridShift::default();
        }
        let GridCoordinates { column, row } = self.geometry().coordinates_of(centre_in_map);
        let half = |side: usize| i32::try_from(side / 2).unwrap_or(i32::MAX);
        let columns = column.saturating_sub(half(self.geometry().columns()));
        let rows = row.saturating_sub(half(self.geometry().rows()));
        let shift = GridShift { columns, rows };
        if shift != GridShift::default() {
            self.shift(shift, fresh);
        }
        shift
    }

    fn shift(&mut self, by: GridShift, fresh: T) {
        let (columns, rows) = (self.geometry().columns(), self.geometry().rows());
        let moved = self.geometry().moved(by.columns, by.rows);
        let values = self.values_mut();
        let (right, up) = (exact_usize(by.columns.unsigned_abs()), exact_usize(by.rows.unsigned_abs()));
        if right >= columns || up >= rows {
            values.fill(fresh);
        } else {
            let kept = rows.saturating_sub(up).saturating_mul(columns);
            let gap = up.saturating_mul(columns);
            if by.rows > 0 {
                move_to_front(values, gap);
                values.get_mut(kept..).unwrap_or(&mut []).fill(fresh);
            } else {
                move_to_back(values, gap);
                values.get_mut(..gap).unwrap_or(&mut []).fill(fresh);
            }
            let kept = columns.saturating_sub(right);
            for line in values.chunks_exact_mut(columns.max(1)) {
                if by.columns > 0 {
                    move_to_front(line, right);
                    line.get_mut(kept..).unwrap_or(&mut []).fill(fresh);
                } else {
                    move_to_back(line, right);
                    line.get_mut(..right).unwrap_or(&mut []).fill(fresh);
                }
            }
        }
        self.set_geometry(moved);
    }
}

/// Moves every value `by` places towards the front; those before it are gone, the last `by` stay as they are.
fn move_to_front<T: Copy>(values: &mut [T], by: usize) {
    for to in 0..values.len().min(GRID_CELLS_MAX) {
        if let Some(value) = values.get(to.saturating_add(by)).copied()
            && let Some(place) = values.get_mut(to)
        {
            *place = value;
        }
    }
}

/// The same towards the back; the first `by` stay as they are.
fn move_to_back<T: Copy>(values: &mut [T], by: usize) {
    for from in (0..values.len().min(GRID_CELLS_MAX)).rev() {
        if let Some(value) = values.get(from).copied()
            && let Some(place) = values.get_mut(from.saturating_add(by))
        {
            *place = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GridGeometry, GridSides};
    use proptest::prelude::*;
    use std::vec;

    proptest! {
        /// Whatever the moves, a cell either keeps the value of its place in the map or is fresh.
        #[test]
        fn values_keep_their_places(moves in prop::collection::vec((-9.0_f32..9.0, -9.0_f32..9.0), 1..8)) {
            let sides = GridSides { columns: 13, rows: 8 };
            let geometry = GridGeometry::with_sides(sides, 0.5, Point2::new(-3.0, -2.0)).unwrap();
            let mut grid = Grid::new(geometry, vec![(i32::MAX, i32::MAX); geometry.cell_count()]).unwrap();
            for (x_m, y_m) in moves {
                let before = grid.clone();
                grid.recentre(Point2::new(x_m, y_m), (i32::MAX, i32::MAX));
                let GridCoordinates { column, row } = grid.geometry().coordinates_of(Point2::new(x_m, y_m));
                prop_assert_eq!((column, row), (6, 4));
                for cell in 0..grid.geometry().cell_count() {
                    let centre = grid.geometry().centre(cell);
                    let place = ((centre.x_m * 4.0).round() as i32, (centre.y_m * 4.0).round() as i32);
                    let was = before.geometry().cell_at(centre).and_then(|old| before.get(old)).copied();
                    prop_assert_eq!(grid.values()[cell], was.unwrap_or((i32::MAX, i32::MAX)));
                    grid.values_mut()[cell] = place;
                }
            }
        }
    }
}
