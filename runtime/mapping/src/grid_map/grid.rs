//! A map of three values.

use floorguard_mapping::Occupancy;

/// A raster map. Row 0 has the smallest y; the index runs along x first.
#[derive(Clone, Debug, PartialEq)]
pub struct GridMap {
    /// Cells along x, ≥ 1.
    pub columns: usize,
    /// Cells along y, ≥ 1.
    pub rows: usize,
    /// Edge of a cell, metres.
    pub cell_m: f64,
    /// Lower left corner of cell (0, 0) in the map, metres.
    pub corner_m: [f64; 2],
    /// `columns` · `rows` cells.
    pub cells: Vec<Occupancy>,
}

impl GridMap {
    /// The state of a cell; unknown outside.
    #[must_use]
    pub fn at(&self, column: i64, row: i64) -> Occupancy {
        let inside = |value: i64, count: usize| usize::try_from(value).ok().filter(|value| *value < count);
        let index = inside(column, self.columns).zip(inside(row, self.rows));
        index.and_then(|(x, y)| self.cells.get(y * self.columns + x)).copied().unwrap_or_default()
    }

    /// Column and row of a place of the map, which may lie outside.
    #[must_use]
    pub fn cell_of(&self, [x_m, y_m]: [f64; 2]) -> [i64; 2] {
        let cell = |value: f64, corner: f64| ((value - corner) / self.cell_m).floor() as i64;
        [cell(x_m, self.corner_m[0]), cell(y_m, self.corner_m[1])]
    }

    /// Centre of a cell by its index, metres.
    #[must_use]
    pub fn centre_m(&self, index: usize) -> [f64; 2] {
        let (column, row) = (index % self.columns, index / self.columns);
        let centre = |cell: usize, corner: f64| corner + (cell as f64 + 0.5) * self.cell_m;
        [centre(column, self.corner_m[0]), centre(row, self.corner_m[1])]
    }

    /// Area of the cells of one state, square metres.
    #[must_use]
    pub fn area_m2(&self, state: Occupancy) -> f64 {
        self.cells.iter().filter(|cell| **cell == state).count() as f64 * self.cell_m * self.cell_m
    }
}
