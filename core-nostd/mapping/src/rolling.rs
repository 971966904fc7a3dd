//! A grid that moves with the robot: its origin shifts by whole cells, and what comes in is unknown.

use floorguard_types::geometry::Point2;

use super::grid::Grid;

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
        let (column, row) = self.geometry().coordinates_of(centre_in_map);
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
        let (right, up) = (by.columns.unsigned_abs() as usize, by.rows.unsigned_abs() as usize);
        if right >= columns || up >= rows {
            values.fill(fresh);
        } else {
            let kept = rows.saturating_sub(up).saturating_mul(columns);
            let gap = up.saturating_mul(columns);
            if by.rows > 0 {
                values.copy_within(gap.., 0);
                values.get_mut(kept..).unwrap_or(&mut []).fill(fresh);
            } else {
                values.copy_within(..kept, gap);
                values.get_mut(..gap).unwrap_or(&mut []).fill(fresh);
            }
            let kept = columns.saturating_sub(right);
            for line in values.chunks_exact_mut(columns.max(1)) {
                if by.columns > 0 {
                    line.copy_within(right.., 0);
                    line.get_mut(kept..).unwrap_or(&mut []).fill(fresh);
                } else {
                    line.copy_within(..kept, right);
                    line.get_mut(..right).unwrap_or(&mut []).fill(fresh);
                }
            }
        }
        self.set_geometry(moved);
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
                let (column, row) = grid.geometry().coordinates_of(Point2::new(x_m, y_m));
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
