//! The part of a field for which there are values.

use floorguard_types::number::exact_usize;

use crate::grid::{GridCoordinates, GridGeometry, GridSides};

/// Cells of a raster that are stored; what lies beside them holds 0. A field around a scanner that sees 30 m has a hundred times
/// the cells of the room that it stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldPart {
    /// The cell with the smallest coordinates, by its place in the raster, ≥ 0.
    pub first: GridCoordinates,
    /// Columns and rows.
    pub sides: GridSides,
}

impl FieldPart {
    /// The whole raster.
    #[must_use]
    pub const fn whole(geometry: &GridGeometry) -> Self {
        Self { first: GridCoordinates { column: 0, row: 0 }, sides: geometry.sides() }
    }

    /// Columns that are stored.
    #[inline]
    #[must_use]
    pub const fn columns(&self) -> usize {
        exact_usize(self.sides.columns)
    }

    /// Number of cells.
    #[must_use]
    pub const fn cell_count(&self) -> usize {
        exact_usize(self.sides.columns).saturating_mul(exact_usize(self.sides.rows))
    }

    /// Place of a cell of the raster among the values; `None` for one that is not stored.
    #[inline]
    #[must_use]
    pub fn index(&self, column: i32, row: i32) -> Option<usize> {
        let column = usize::try_from(column.checked_sub(self.first.column)?).ok()?;
        let row = usize::try_from(row.checked_sub(self.first.row)?).ok()?;
        let inside = column < self.columns() && row < exact_usize(self.sides.rows);
        inside.then(|| row.saturating_mul(self.columns()).saturating_add(column))
    }
}
