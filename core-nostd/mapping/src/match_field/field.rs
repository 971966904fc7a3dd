//! A field that grows by returns, with the coarse level that a search over a small window needs.

use floorguard_types::geometry::Point2;

use super::part::FieldPart;
use super::stamp::Stamp;
use super::view::FieldLevel;
use crate::grid::{GRID_SIDE_MAX, GridCoordinates, GridGeometry, GridSides, GridTooSmall};

/// A field over storage `S`: a fine level and one that bounds 4 × 4 cells, both kept while returns come in.
#[derive(Clone, Debug)]
pub struct MatchField<S> {
    geometry: GridGeometry,
    part: FieldPart,
    fine: S,
    coarse: S,
    reach_m: f32,
}

/// Of a field that stores nothing.
const NO_SIDES: GridSides = GridSides { columns: 0, rows: 0 };

/// Level of the coarse grid.
const COARSE_SHIFT: u8 = 2;

impl<S: AsRef<[u8]> + AsMut<[u8]>> MatchField<S> {
    /// An empty field. `reach_m` is the distance at which a return's value has fallen to zero.
    ///
    /// # Errors
    /// A storage is smaller than the geometry.
    pub fn new(geometry: GridGeometry, storage: [S; 2], reach_m: f32) -> Result<Self, GridTooSmall> {
        Self::within(geometry, FieldPart::whole(&geometry), storage, reach_m)
    }

    /// The same, of which only a part is stored: returns write nothing beside it.
    ///
    /// # Errors
    /// A storage is smaller than the part.
    pub fn within(
        geometry: GridGeometry,
        part: FieldPart,
        [fine, coarse]: [S; 2],
        reach_m: f32,
    ) -> Result<Self, GridTooSmall> {
        let (needed, capacity) = (part.cell_count(), fine.as_ref().len().min(coarse.as_ref().len()));
        if capacity < needed {
            return Err(GridTooSmall { needed, capacity });
        }
        let mut field = Self { geometry, part, fine, coarse, reach_m };
        field.clear();
        Ok(field)
    }

    /// What is stored of the field.
    #[must_use]
    pub const fn part(&self) -> FieldPart {
        self.part
    }

    /// The first and the last cell that a return writes where they are stored; `None` for one that writes nothing.
    #[must_use]
    pub fn reached_by(&self, point: Point2) -> Option<[GridCoordinates; 2]> {
        self.stamp().reached_cells(point)
    }

    /// Stores another part from now on, in storage of at least so many cells, which is asked for twice and holds 0. What lies beside
    /// it is forgotten.
    ///
    /// # Errors
    /// A storage is smaller than the part: then nothing is stored any more.
    pub fn store(
        &mut self,
        part: FieldPart,
        mut storage: impl FnMut(usize) -> S,
    ) -> Result<(), GridTooSmall> {
        let former = core::mem::replace(&mut self.part, FieldPart { sides: NO_SIDES, ..part });
        let needed = part.cell_count();
        // One after the other: the former values of one are let go before the next storage is asked for.
        for values in [&mut self.fine, &mut self.coarse] {
            let mut to = storage(needed);
            let capacity = to.as_ref().len();
            if capacity < needed {
                return Err(GridTooSmall { needed, capacity });
            }
            copy_part((to.as_mut(), part), (values.as_ref(), former));
            *values = to;
        }
        self.part = part;
        Ok(())
    }

    /// The storage of the fine level.
    #[must_use]
    pub fn into_fine(self) -> S {
        self.fine
    }

    const fn stamp(&self) -> Stamp {
        Stamp { geometry: self.geometry, part: self.part, reach_m: self.reach_m, shift: COARSE_SHIFT }
    }

    /// Writes a return, in the field's frame. Cost: (2 reach / edge)² cells, and somewhat more for the coarse level.
    pub fn insert(&mut self, point: Point2) {
        self.stamp().write(self.fine.as_mut(), self.coarse.as_mut(), point);
    }

    /// Forgets all returns.
    pub fn clear(&mut self) {
        self.fine.as_mut().fill(0);
        self.coarse.as_mut().fill(0);
    }

    /// The levels, fine first.
    #[must_use]
    pub fn levels(&self) -> [FieldLevel<'_>; 2] {
        let Self { geometry, part, .. } = *self;
        [
            FieldLevel { geometry, part, values: self.fine.as_ref(), shift: 0 },
            FieldLevel { geometry, part, values: self.coarse.as_ref(), shift: COARSE_SHIFT },
        ]
    }

    /// Distance at which a return's value has fallen to zero, metres.
    #[must_use]
    pub const fn reach_m(&self) -> f32 {
        self.reach_m
    }
}

/// Writes the values of one part into another part of the same raster.
fn copy_part((to, part): (&mut [u8], FieldPart), (from, former): (&[u8], FieldPart)) {
    let rows = i32::try_from(former.sides.rows).unwrap_or(i32::MAX);
    let column = part.first.column.max(former.first.column);
    let left = |part: &FieldPart| {
        let before = usize::try_from(column.saturating_sub(part.first.column)).unwrap_or(0);
        part.columns().saturating_sub(before)
    };
    let count = left(&part).min(left(&former));
    for below in 0..rows.min(GRID_SIDE_MAX) {
        let row = former.first.row.saturating_add(below);
        let Some((first, start)) = part.index(column, row).zip(former.index(column, row)) else { continue };
        let from = from.get(start..start.saturating_add(count)).unwrap_or_default();
        let to = to.get_mut(first..first.saturating_add(count)).unwrap_or_default();
        to.iter_mut().zip(from).for_each(|(value, other)| *value = *other);
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
