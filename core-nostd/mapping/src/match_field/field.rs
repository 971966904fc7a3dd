//! A field that grows by returns, with the coarse level that a search over a small window needs.

use floorguard_types::geometry::Point2;

use super::stamp::Stamp;
use super::view::FieldLevel;
use crate::grid::{Grid, GridGeometry, GridTooSmall};

/// A field over storage `S`: a fine level and one that bounds 4 × 4 cells, both kept while returns come in.
#[derive(Clone, Debug)]
pub struct MatchField<S> {
    fine: Grid<u8, S>,
    coarse: Grid<u8, S>,
    reach_m: f32,
}

/// Level of the coarse grid.
const COARSE_SHIFT: u8 = 2;

impl<S: AsRef<[u8]> + AsMut<[u8]>> MatchField<S> {
    /// An empty field. `reach_m` is the distance at which a return's value has fallen to zero.
    ///
    /// # Errors
    /// A storage is smaller than the geometry.
    pub fn new(geometry: GridGeometry, storage: [S; 2], reach_m: f32) -> Result<Self, GridTooSmall> {
        let [fine, coarse] = storage;
        let mut field =
            Self { fine: Grid::new(geometry, fine)?, coarse: Grid::new(geometry, coarse)?, reach_m };
        field.clear();
        Ok(field)
    }

    /// Writes a return, in the field's frame. Cost: (2 reach / edge)² cells, and somewhat more for the coarse level.
    pub fn insert(&mut self, point: Point2) {
        let geometry = *self.fine.geometry();
        let stamp = Stamp { geometry, reach_m: self.reach_m, shift: COARSE_SHIFT };
        stamp.write(self.fine.values_mut(), self.coarse.values_mut(), point);
    }

    /// Forgets all returns.
    pub fn clear(&mut self) {
        self.fine.values_mut().fill(0);
        self.coarse.values_mut().fill(0);
    }

    /// The levels, fine first.
    #[must_use]
    pub fn levels(&self) -> [FieldLevel<'_>; 2] {
        let geometry = *self.fine.geometry();
        [
            FieldLevel { geometry, values: self.fine.values(), shift: 0 },
            FieldLevel { geometry, values: self.coarse.values(), shift: COARSE_SHIFT },
        ]
    }

    /// Distance at which a return's value has fallen to zero, metres.
    #[must_use]
    pub const fn reach_m(&self) -> f32 {
        self.reach_m
    }
}

/// Makes the next coarser level: every cell of `target` becomes the largest of four cells of `source`, which lie
/// 2^`source.shift` apart. Cost: four reads a cell.
pub fn coarsen(source: FieldLevel<'_>, target: &mut [u8]) {
    let step = 1_usize << source.shift.min(15);
    let width = usize::from(source.geometry.width()).max(1);
    let rows = usize::from(source.geometry.height());
    target.fill(0);
    for (row, out) in target.chunks_exact_mut(width).take(rows).enumerate() {
        let start = row.saturating_mul(width);
        let above = start.saturating_add(step.saturating_mul(width));
        for first in [start, above] {
            let line = source.values.get(first..first.saturating_add(width)).unwrap_or_default();
            raise(out, line);
            raise(out, line.get(step..).unwrap_or_default());
        }
    }
}

/// Makes each value at least as large as another one.
fn raise(values: &mut [u8], others: &[u8]) {
    for (value, other) in values.iter_mut().zip(others) {
        *value = (*value).max(*other);
    }
}

#[cfg(test)]
mod tests {
    use std::vec;

    use super::*;

    #[test]
    fn coarse_cells_hold_their_largest_fine_value() {
        let geometry = GridGeometry::new(40, 30, 0.05, Point2::new(-1.0, -0.5)).unwrap();
        let storage = || vec![0_u8; geometry.cell_count()];
        let mut field = MatchField::new(geometry, [storage(), storage()], 0.25).unwrap();
        // Amid the grid, at its corners, beside it, and nowhere.
        let places = [[0.013, 0.027], [-0.99, -0.49], [0.98, 0.97], [1.1, 0.2], [-1.2, 0.9], [9.0, 9.0]];
        for [x_m, y_m] in places {
            field.insert(Point2::new(x_m, y_m));
        }
        field.insert(Point2::new(f32::NAN, 0.0));
        let [fine, coarse] = field.levels();
        let mut seen = 0;
        for row in 0..30 {
            for column in 0..40 {
                let centre = [(column, -1.0_f32), (row, -0.5)]
                    .map(|(cell, origin)| origin + 0.05 * (cell as f32 + 0.5));
                let away = |[x, y]: &[f32; 2]| libm::hypotf(x - centre[0], y - centre[1]);
                let nearest = places.iter().map(away).fold(f32::INFINITY, f32::min);
                let expected = (1.0 - nearest / 0.25).max(0.0) * 255.0;
                let value = fine.at(column, row);
                assert!((f32::from(value) - expected).abs() <= 0.6, "{column} {row}: {value} {expected}");
                seen += i32::from(value > 0);
                let window = (0..4).flat_map(|down| (0..4).map(move |right| (column + right, row + down)));
                let largest = window.map(|(column, row)| fine.at(column, row)).max().unwrap_or(0);
                // At the rim a coarse cell also bounds what a return beside the grid would have there.
                let is_inside = column < 36 && row < 26;
                assert!(coarse.at(column, row) >= largest, "{column} {row}");
                assert!(!is_inside || coarse.at(column, row) == largest, "{column} {row}");
            }
        }
        assert!(seen > 100, "{seen}");
    }
}
