//! How far the nearest obstacle is, for every cell: the likelihood field of the range sensor and the inflation of the
//! planner.
//!
//! Distances are exact between cell centres, in whole centimetres, and end at two metres: a byte a cell. Two passes
//! bounded by the window of two metres, no queue (book, Cleaning: Distance field).

use super::grid::Grid;
use floorguard_types::geometry::Point2;
use floorguard_types::number::{nearest_f32, saturating_u8, truncating_u32};

/// Where distances end, metres; a stored 200 means "at least this far".
pub const DISTANCE_LIMIT_M: f32 = 2.0;

/// Distance to the nearest obstacle, centimetres, in a byte a cell.
pub type DistanceField<S> = Grid<u8, S>;

/// Fills `field` from `is_obstacle(index)`. `rows` is scratch of the same number of cells and holds column distances
/// afterwards. Costs cells × (2 · 2 m/resolution + 3) steps; done once a map.
///
/// ```
/// use floorguard_mapping::{Grid, GridGeometry, fill_distances};
/// use floorguard_types::geometry::Point2;
///
/// // A wall along the left edge of a map of 2 × 1 m.
/// let geometry = GridGeometry::new(20, 10, 0.1, Point2::default()).unwrap();
/// let mut field = Grid::new(geometry, [0_u8; 200]).unwrap();
/// let mut scratch = field.clone();
/// fill_distances(&mut field, &mut scratch, |cell| geometry.coordinates(cell).column == 0);
/// assert!((field.clearance_m(Point2::new(1.25, 0.5)) - 1.2).abs() < 1.0e-6);
/// assert_eq!(field.clearance_m(Point2::new(-1.0, 0.5)), 0.0);
/// ```
pub fn fill_distances<S, R>(
    field: &mut DistanceField<S>,
    rows: &mut Grid<u8, R>,
    is_obstacle: impl Fn(usize) -> bool,
) where
    S: AsRef<[u8]> + AsMut<[u8]>,
    R: AsRef<[u8]> + AsMut<[u8]>,
{
    let width = field.geometry().columns();
    let resolution_m = field.geometry().resolution_m();
    let reach = saturating_u8((DISTANCE_LIMIT_M / resolution_m).clamp(1.0, 254.0));
    column_distances(rows.values_mut(), width, reach, is_obstacle);
    let vertical = rows.values();
    for (row, target) in field.values_mut().chunks_mut(width).enumerate() {
        let start = row.saturating_mul(width);
        let line = vertical.get(start..start.saturating_add(width)).unwrap_or(&[]);
        for (column, value) in target.iter_mut().enumerate() {
            *value = centimetres(nearest_squared(line, column, reach), resolution_m);
        }
    }
}

/// Cells to the nearest obstacle of the same column, at most `reach` + 1: one sweep up, one down.
fn column_distances(values: &mut [u8], width: usize, reach: u8, is_obstacle: impl Fn(usize) -> bool) {
    let beyond = reach.saturating_add(1);
    for index in 0..values.len() {
        let below = index.checked_sub(width).and_then(|i| values.get(i)).copied().unwrap_or(beyond);
        let distance = if is_obstacle(index) { 0 } else { below.saturating_add(1).min(beyond) };
        if let Some(value) = values.get_mut(index) {
            *value = distance;
        }
    }
    for index in (0..values.len()).rev() {
        let above = values.get(index.saturating_add(width)).copied().unwrap_or(beyond);
        if let Some(value) = values.get_mut(index) {
            *value = (*value).min(above.saturating_add(1));
        }
    }
}

/// Smallest squared distance, in cells, over the columns within reach.
fn nearest_squared(line: &[u8], column: usize, reach: u8) -> u32 {
    let first = column.saturating_sub(usize::from(reach));
    let last = column.saturating_add(usize::from(reach)).saturating_add(1).min(line.len());
    let mut best = u32::MAX;
    for (offset, &vertical) in line.get(first..last).unwrap_or(&[]).iter().enumerate() {
        if vertical > reach {
            continue;
        }
        let horizontal = truncating_u32(first.saturating_add(offset).abs_diff(column));
        let vertical = u32::from(vertical);
        best =
            best.min(horizontal.saturating_mul(horizontal).saturating_add(vertical.saturating_mul(vertical)));
    }
    best
}

fn centimetres(squared_cells: u32, resolution_m: f32) -> u8 {
    let metres = libm::sqrtf(nearest_f32(squared_cells)) * resolution_m;
    saturating_u8(metres.min(DISTANCE_LIMIT_M) * 100.0 + 0.5)
}

impl<S: AsRef<[u8]> + AsMut<[u8]>> Grid<u8, S> {
    /// Distance from the cell of a point to the nearest obstacle, metres, at most [`DISTANCE_LIMIT_M`]. Outside the
    /// map nothing is known, so nothing is clear: 0.
    #[must_use]
    pub fn clearance_m(&self, point_in_map: Point2) -> f32 {
        let index = self.geometry().cell_at(point_in_map);
        index.and_then(|i| self.get(i)).map_or(0.0, |&centimetres| f32::from(centimetres) * 0.01)
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::GridGeometry;
    use super::*;
    use floorguard_types::random::Pcg32;
    use std::vec;
    use std::vec::Vec;

    /// Against the definition: the minimum over all obstacles.
    #[test]
    fn equals_the_brute_force_minimum() {
        let geometry = GridGeometry::new(70, 55, 0.05, Point2::default()).unwrap();
        let mut generator = Pcg32::new(7, 0);
        let obstacles: Vec<bool> = (0..geometry.cell_count()).map(|_| generator.bernoulli(0.002)).collect();
        let mut field = Grid::new(geometry, vec![0_u8; geometry.cell_count()]).unwrap();
        let mut scratch = Grid::new(geometry, vec![0_u8; geometry.cell_count()]).unwrap();
        fill_distances(&mut field, &mut scratch, |i| obstacles[i]);
        for index in 0..geometry.cell_count() {
            let here = geometry.centre(index);
            let nearest = (0..geometry.cell_count())
                .filter(|&i| obstacles[i])
                .map(|i| geometry.centre(i).distance(here))
                .fold(DISTANCE_LIMIT_M, f32::min);
            assert!((field.clearance_m(here) - nearest).abs() <= 0.0051, "{index}");
        }
        assert_eq!(field.clearance_m(Point2::new(-1.0, 0.0)), 0.0);
    }
}
