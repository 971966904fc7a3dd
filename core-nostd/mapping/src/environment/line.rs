//! The cells that a straight step passes, in order, each once.

use crate::GridCoordinates;
use crate::GridGeometry;
use floorguard_types::geometry::Point2;
use floorguard_types::number::nearest_f32;

/// Cells of one step at most (book, Environment: Visits).
pub const CELLS_OF_STEP: usize = 64;

/// A straight step, map frame, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Where it begins.
    pub from: Point2,
    /// Where it ends.
    pub to: Point2,
}

/// Calls `visit` with every cell from the one that holds `from` to the one that holds `to`, both included, by
/// Amanatides and Woo. Cells outside the raster are passed over. At most [`CELLS_OF_STEP`] cells.
pub fn walk(geometry: &GridGeometry, Step { from, to }: Step, mut visit: impl FnMut(usize)) {
    let GridCoordinates { mut column, mut row } = geometry.coordinates_of(from);
    let GridCoordinates { column: last_column, row: last_row } = geometry.coordinates_of(to);
    let origin = geometry.origin_in_map();
    let scale = geometry.cells_per_metre();
    let along = |from_m: f32, to_m: f32, origin_m: f32, cell: i32| {
        let (start, delta) = ((from_m - origin_m) * scale, (to_m - from_m) * scale);
        if delta > 0.0 {
            (1_i32, (nearest_f32(cell) + 1.0 - start) / delta, 1.0 / delta)
        } else if delta < 0.0 {
            (-1_i32, (nearest_f32(cell) - start) / delta, -1.0 / delta)
        } else {
            (0_i32, f32::INFINITY, f32::INFINITY)
        }
    };
    let (step_x, mut next_x, gap_x) = along(from.x_m, to.x_m, origin.x_m, column);
    let (step_y, mut next_y, gap_y) = along(from.y_m, to.y_m, origin.y_m, row);
    for _ in 0..CELLS_OF_STEP {
        if let Some(cell) = geometry.index(column, row) {
            visit(cell);
        }
        if column == last_column && row == last_row {
            return;
        }
        // An axis that has arrived must not go on: rounding may put its last border a hair too early.
        let x_first = next_x <= next_y;
        if (x_first && column != last_column) || row == last_row {
            column =
                column.saturating_add(if step_x != 0 { step_x } else { (last_column - column).signum() });
            next_x += gap_x;
        } else {
            row = row.saturating_add(if step_y != 0 { step_y } else { (last_row - row).signum() });
            next_y += gap_y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn cells(from: (f32, f32), to: (f32, f32)) -> Vec<(i32, i32)> {
        let geometry = GridGeometry::new(20, 20, 0.2, Point2::new(-2.0, -2.0)).unwrap();
        let mut all = Vec::new();
        let step = Step { from: Point2::new(from.0, from.1), to: Point2::new(to.0, to.1) };
        walk(&geometry, step, |cell| {
            let GridCoordinates { column, row } = geometry.coordinates(cell);
            all.push((column, row));
        });
        all
    }

    #[test]
    fn passes_neighbours_only_and_arrives() {
        assert_eq!(cells((0.1, 0.1), (0.1, 0.1)), [(10, 10)]);
        assert_eq!(cells((0.1, 0.1), (0.5, 0.1)), [(10, 10), (11, 10), (12, 10)]);
        assert_eq!(cells((0.1, 0.1), (-0.3, 0.1)), [(10, 10), (9, 10), (8, 10)]);
        for turn in 0..360 {
            let angle = turn as f32 * 0.017_453_3;
            let to = (0.03 + 1.9 * angle.cos(), -0.07 + 1.9 * angle.sin());
            let passed = cells((0.03, -0.07), to);
            let geometry = GridGeometry::new(20, 20, 0.2, Point2::new(-2.0, -2.0)).unwrap();
            let GridCoordinates { column, row } = geometry.coordinates_of(Point2::new(to.0, to.1));
            assert_eq!(*passed.last().unwrap(), (column, row), "{turn}");
            for pair in passed.windows(2) {
                assert_eq!((pair[0].0 - pair[1].0).abs() + (pair[0].1 - pair[1].1).abs(), 1, "{turn}");
            }
        }
    }

    #[test]
    fn outside_and_nonsense_are_harmless() {
        assert!(cells((-9.0, -9.0), (-8.0, -9.0)).is_empty());
        assert!(cells((-1.9, 0.1), (f32::NAN, f32::INFINITY)).len() <= CELLS_OF_STEP);
    }
}
