//! The cells that a ray passes (Amanatides and Woo 1987).

use floorguard_mapping::{GridCoordinates, GridGeometry};
use floorguard_types::geometry::Point2;

/// The cells of a raster from one point of the map frame to another, in order, the first and the last included. Cells outside
/// the raster are left out. At most columns + rows + 2 steps beyond those outside.
#[derive(Clone, Debug)]
pub struct RayCells<'a> {
    geometry: &'a GridGeometry,
    column: i32,
    row: i32,
    step_columns: i32,
    step_rows: i32,
    next_x: f32,
    next_y: f32,
    delta_x: f32,
    delta_y: f32,
    left: u32,
}

/// Steps that a ray may have, wherever it ends: 26 km of 5 cm.
const STEPS_MAX: u32 = 1 << 20;

impl<'a> RayCells<'a> {
    /// A ray between two points. Points that are not finite give no cells.
    #[must_use]
    pub fn new(geometry: &'a GridGeometry, from_in_map: Point2, to_in_map: Point2) -> Self {
        let GridCoordinates { column, row } = geometry.coordinates_of(from_in_map);
        let GridCoordinates { column: last_column, row: last_row } = geometry.coordinates_of(to_in_map);
        let finite = from_in_map.norm().is_finite() && to_in_map.norm().is_finite();
        let steps = last_column.abs_diff(column).saturating_add(last_row.abs_diff(row));
        let scale = geometry.cells_per_metre();
        let origin = geometry.origin_in_map();
        let x = Axis::new((from_in_map.x_m - origin.x_m) * scale, (to_in_map.x_m - origin.x_m) * scale);
        let y = Axis::new((from_in_map.y_m - origin.y_m) * scale, (to_in_map.y_m - origin.y_m) * scale);
        Self {
            geometry,
            column,
            row,
            step_columns: x.step,
            step_rows: y.step,
            next_x: x.next,
            next_y: y.next,
            delta_x: x.delta,
            delta_y: y.delta,
            left: if finite { steps.saturating_add(1).min(STEPS_MAX) } else { 0 },
        }
    }
}

/// One axis of a ray: its direction, and where along the ray (0 to 1) it meets the next borders.
struct Axis {
    step: i32,
    next: f32,
    delta: f32,
}

impl Axis {
    fn new(from: f32, to: f32) -> Self {
        let travel = to - from;
        let floor = libm::floorf(from);
        if travel > 0.0 {
            Self { step: 1, next: (floor + 1.0 - from) / travel, delta: 1.0 / travel }
        } else if travel < 0.0 {
            Self { step: -1, next: (floor - from) / travel, delta: -1.0 / travel }
        } else {
            Self { step: 0, next: f32::INFINITY, delta: f32::INFINITY }
        }
    }
}

impl Iterator for RayCells<'_> {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        // Cells outside are passed over: the loop ends with the ray.
        for _ in 0..STEPS_MAX {
            self.left = self.left.checked_sub(1)?;
            let cell = self.geometry.index(self.column, self.row);
            if self.next_x < self.next_y {
                self.column = self.column.wrapping_add(self.step_columns);
                self.next_x += self.delta_x;
            } else {
                self.row = self.row.wrapping_add(self.step_rows);
                self.next_y += self.delta_y;
            }
            if cell.is_some() {
                return cell;
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    proptest! {
        /// Against points set densely along the ray: every cell that one of them lies in is passed, and neighbours share an
        /// edge.
        #[test]
        fn passes_the_cells_of_dense_points(
            from in (0.05_f32..9.9, 0.05_f32..6.9),
            to in (0.05_f32..9.9, 0.05_f32..6.9),
        ) {
            let geometry = GridGeometry::new(20, 14, 0.5, Point2::default()).unwrap();
            let (from, to) = (Point2::new(from.0, from.1), Point2::new(to.0, to.1));
            let cells: Vec<usize> = RayCells::new(&geometry, from, to).collect();
            prop_assert_eq!(cells.first().copied(), geometry.cell_at(from));
            for pair in cells.windows(2) {
                let [from, to] = [pair[0], pair[1]].map(|cell| geometry.coordinates(cell));
                prop_assert_eq!((from.column - to.column).abs() + (from.row - to.row).abs(), 1);
            }
            for step in 0..=200 {
                let t = step as f32 / 200.0;
                let point = Point2::new(from.x_m + t * (to.x_m - from.x_m), from.y_m + t * (to.y_m - from.y_m));
                let near_a_border = |v: f32| (v * 2.0 - (v * 2.0).round()).abs() < 1e-3;
                let cell = geometry.cell_at(point).unwrap();
                prop_assert!(cells.contains(&cell) || near_a_border(point.x_m) || near_a_border(point.y_m));
            }
        }
    }

    #[test]
    fn rays_from_nowhere_have_no_cells() {
        let geometry = GridGeometry::new(20, 14, 0.5, Point2::default()).unwrap();
        assert_eq!(RayCells::new(&geometry, Point2::new(f32::NAN, 1.0), Point2::default()).count(), 0);
        let far = Point2::new(1.0e9, 1.0);
        assert!(RayCells::new(&geometry, Point2::new(1.0, 1.0), far).count() <= 20);
    }
}
