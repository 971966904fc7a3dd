//! A raster over the floor: where its cells lie, and storage for one value a cell.

use core::marker::PhantomData;

use floorguard_types::geometry::Point2;
use floorguard_types::number::{
    count_u64, exact_usize, nearest_f32, saturating_i32, saturating_u16_of_u32, truncating_i32,
};

/// Cells of a raster are numbered in 32 bits, and the last number is none.
const CELLS_MAX: u64 = count_u64(GRID_CELLS_MAX);
/// The same as a bound of loops over cells.
pub const GRID_CELLS_MAX: usize = exact_usize(u32::MAX);
/// Cells along a side, as a bound of loops over rows and columns.
pub const GRID_SIDE_MAX: i32 = 1 << 30;

/// Columns and rows of a raster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridSides {
    /// Along x.
    pub columns: u32,
    /// Along y.
    pub rows: u32,
}

/// A cell by column and row; may lie outside the raster.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GridCoordinates {
    /// Along x, from 0.
    pub column: i32,
    /// Along y, from 0.
    pub row: i32,
}

/// Where the cells of a raster lie in the map frame. Cell (0, 0) is the one with the smallest coordinates; the index
/// runs along x first. Invariants: 0 < `resolution_m` < 100, both sides ≥ 1.
///
/// ```
/// use floorguard_mapping::GridGeometry;
/// use floorguard_types::geometry::Point2;
///
/// let geometry = GridGeometry::new(40, 20, 0.5, Point2::new(-10.0, -5.0)).unwrap();
/// let cell = geometry.cell_at(Point2::new(0.1, 0.1)).unwrap();
/// assert_eq!(geometry.coordinates(cell).column, 20);
/// assert_eq!(geometry.centre(cell), Point2::new(0.25, 0.25));
/// assert_eq!(geometry.cell_at(Point2::new(11.0, 0.0)), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridGeometry {
    columns: u32,
    rows: u32,
    resolution_m: f32,
    cells_per_metre: f32,
    origin_in_map: Point2,
}

impl GridGeometry {
    /// Columns, rows, edge of a cell in metres, and the corner of cell (0, 0) in the map frame. `None` for a side of
    /// zero, an edge outside (0, 100) m or a corner that is not finite.
    #[must_use]
    pub fn new(width: u16, height: u16, resolution_m: f32, origin_in_map: Point2) -> Option<Self> {
        let sides = GridSides { columns: u32::from(width), rows: u32::from(height) };
        Self::with_sides(sides, resolution_m, origin_in_map)
    }

    /// As [`Self::new`], with sides of 32 bits. `None` also where the cells cannot be counted in 32 bits: searches number
    /// cells so.
    #[must_use]
    pub fn with_sides(sides: GridSides, resolution_m: f32, origin_in_map: Point2) -> Option<Self> {
        let cells = u64::from(sides.columns).checked_mul(u64::from(sides.rows))?;
        let legal = (1..CELLS_MAX).contains(&cells)
            && resolution_m > 1e-4
            && resolution_m < 100.0
            && origin_in_map.x_m.is_finite()
            && origin_in_map.y_m.is_finite();
        legal.then_some(Self {
            columns: sides.columns,
            rows: sides.rows,
            resolution_m,
            cells_per_metre: 1.0 / resolution_m,
            origin_in_map,
        })
    }

    /// Columns, ≥ 1, for file formats with 16 bits: at most 65,535. Everything else asks [`Self::columns`].
    #[must_use]
    pub const fn width(&self) -> u16 {
        saturating_u16_of_u32(self.columns)
    }

    /// Rows, ≥ 1, for file formats with 16 bits: at most 65,535. Everything else asks [`Self::rows`].
    #[must_use]
    pub const fn height(&self) -> u16 {
        saturating_u16_of_u32(self.rows)
    }

    /// Both sides, ≥ 1.
    #[must_use]
    pub const fn sides(&self) -> GridSides {
        GridSides { columns: self.columns, rows: self.rows }
    }

    /// Columns, ≥ 1.
    #[inline]
    #[must_use]
    pub const fn columns(&self) -> usize {
        exact_usize(self.columns)
    }

    /// Rows, ≥ 1.
    #[inline]
    #[must_use]
    pub const fn rows(&self) -> usize {
        exact_usize(self.rows)
    }

    /// The same raster moved by whole cells.
    #[must_use]
    pub fn moved(&self, columns: i32, rows: i32) -> Self {
        let x_m = self.origin_in_map.x_m + nearest_f32(columns) * self.resolution_m;
        let y_m = self.origin_in_map.y_m + nearest_f32(rows) * self.resolution_m;
        Self { origin_in_map: Point2::new(x_m, y_m), ..*self }
    }

    /// Edge of a cell, metres.
    #[must_use]
    pub const fn resolution_m(&self) -> f32 {
        self.resolution_m
    }

    /// Cells in a metre.
    #[must_use]
    pub const fn cells_per_metre(&self) -> f32 {
        self.cells_per_metre
    }

    /// Corner of cell (0, 0), in the map frame.
    #[must_use]
    pub const fn origin_in_map(&self) -> Point2 {
        self.origin_in_map
    }

    /// Number of cells.
    #[must_use]
    pub const fn cell_count(&self) -> usize {
        // The constructor checked that the product fits 32 bits.
        exact_usize(self.columns).saturating_mul(exact_usize(self.rows))
    }

    /// Index of a cell, `None` outside.
    #[inline]
    #[must_use]
    pub fn index(&self, column: i32, row: i32) -> Option<usize> {
        let column = usize::try_from(column).ok()?;
        let row = usize::try_from(row).ok()?;
        let inside = column < self.columns() && row < self.rows();
        inside.then(|| row.saturating_mul(self.columns()).saturating_add(column))
    }

    /// The cell that holds a point of the map frame; may lie outside the raster.
    #[inline]
    #[must_use]
    pub fn coordinates_of(&self, point_in_map: Point2) -> GridCoordinates {
        let x = (point_in_map.x_m - self.origin_in_map.x_m) * self.cells_per_metre;
        let y = (point_in_map.y_m - self.origin_in_map.y_m) * self.cells_per_metre;
        // `as` saturates, and takes NaN to 0; floor, not truncation, so that −0.5 is outside.
        GridCoordinates { column: saturating_i32(libm::floorf(x)), row: saturating_i32(libm::floorf(y)) }
    }

    /// Index of the cell that holds a point of the map frame, `None` outside.
    #[inline]
    #[must_use]
    pub fn cell_at(&self, point_in_map: Point2) -> Option<usize> {
        let GridCoordinates { column, row } = self.coordinates_of(point_in_map);
        self.index(column, row)
    }

    /// Column and row of an index.
    #[inline]
    #[must_use]
    pub fn coordinates(&self, index: usize) -> GridCoordinates {
        let width = self.columns().max(1);
        GridCoordinates { column: truncating_i32(index % width), row: truncating_i32(index / width) }
    }

    /// Centre of a cell, in the map frame.
    #[must_use]
    pub fn centre(&self, index: usize) -> Point2 {
        let GridCoordinates { column, row } = self.coordinates(index);
        Point2::new(
            self.origin_in_map.x_m + (nearest_f32(column) + 0.5) * self.resolution_m,
            self.origin_in_map.y_m + (nearest_f32(row) + 0.5) * self.resolution_m,
        )
    }
}

/// The storage holds fewer cells than the geometry asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridTooSmall {
    /// Cells of the geometry.
    pub needed: usize,
    /// Cells of the storage.
    pub capacity: usize,
}

impl core::fmt::Display for GridTooSmall {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(formatter, "the map has {} cells, but the capacity is {}", self.needed, self.capacity)
    }
}

impl core::error::Error for GridTooSmall {}

/// One value for every cell of a raster, in storage `S`.
///
/// ```
/// use floorguard_mapping::{FixedGrid, Grid, GridGeometry, GridTooSmall};
/// use floorguard_types::geometry::Point2;
///
/// // Storage is handed in: an array on a microcontroller, a boxed slice on a computer.
/// let geometry = GridGeometry::new(4, 3, 0.1, Point2::default()).unwrap();
/// let mut grid: FixedGrid<u8, 12> = Grid::new(geometry, [0; 12]).unwrap();
/// *grid.get_mut(5).unwrap() = 7;
/// assert_eq!(grid.values().iter().sum::<u8>(), 7);
/// let error = Grid::<u8, _>::new(geometry, [0; 11]).unwrap_err();
/// assert_eq!(error, GridTooSmall { needed: 12, capacity: 11 });
/// ```
#[derive(Clone, Debug)]
pub struct Grid<T, S> {
    geometry: GridGeometry,
    storage: S,
    values: PhantomData<T>,
}

/// A grid whose storage is an array: the form for the target.
pub type FixedGrid<T, const CELLS: usize> = Grid<T, [T; CELLS]>;

impl<T, S: AsRef<[T]> + AsMut<[T]>> Grid<T, S> {
    /// A grid over storage that is at least as large as the geometry. What the storage holds becomes the values.
    ///
    /// # Errors
    /// The storage is too small; choose a coarser raster or a smaller window.
    pub fn new(geometry: GridGeometry, storage: S) -> Result<Self, GridTooSmall> {
        let (needed, capacity) = (geometry.cell_count(), storage.as_ref().len());
        if capacity < needed {
            return Err(GridTooSmall { needed, capacity });
        }
        Ok(Self { geometry, storage, values: PhantomData })
    }

    /// Where the cells lie.
    #[must_use]
    pub const fn geometry(&self) -> &GridGeometry {
        &self.geometry
    }

    /// For a window that moves: same sides, other origin.
    pub(crate) const fn set_geometry(&mut self, moved: GridGeometry) {
        self.geometry = moved;
    }

    /// All values, by index.
    #[must_use]
    pub fn values(&self) -> &[T] {
        self.storage.as_ref().get(..self.geometry.cell_count()).unwrap_or(&[])
    }

    /// All values, by index, to be changed.
    pub fn values_mut(&mut self) -> &mut [T] {
        self.storage.as_mut().get_mut(..self.geometry.cell_count()).unwrap_or(&mut [])
    }

    /// The value of a cell.
    #[inline]
    #[must_use]
    pub fn get(&self, index: usize) -> Option<&T> {
        self.storage.as_ref().get(index)
    }

    /// The value of a cell, to be changed.
    #[inline]
    pub fn get_mut(&mut self, index: usize) -> Option<&mut T> {
        self.storage.as_mut().get_mut(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_cells_agree() {
        let geometry = GridGeometry::new(4, 3, 0.1, Point2::new(-0.2, 1.0)).unwrap();
        assert_eq!(geometry.cell_at(Point2::new(-0.15, 1.05)), Some(0));
        assert_eq!(geometry.cell_at(Point2::new(0.15, 1.25)), Some(11));
        assert_eq!(geometry.cell_at(Point2::new(-0.21, 1.05)), None);
        assert_eq!(geometry.cell_at(Point2::new(0.21, 1.05)), None);
        for index in 0..12 {
            assert_eq!(geometry.cell_at(geometry.centre(index)), Some(index));
        }
        assert_eq!(geometry.cell_at(Point2::new(f32::INFINITY, 1.05)), None);
    }

    #[test]
    fn refuses_what_does_not_fit() {
        let geometry = GridGeometry::new(4, 3, 0.1, Point2::default()).unwrap();
        assert_eq!(
            FixedGrid::<u8, 11>::new(geometry, [0; 11]).err(),
            Some(GridTooSmall { needed: 12, capacity: 11 })
        );
        assert_eq!(FixedGrid::<u8, 20>::new(geometry, [0; 20]).unwrap().values().len(), 12);
        assert!(GridGeometry::new(0, 3, 0.1, Point2::default()).is_none());
        assert!(GridGeometry::new(1, 3, f32::NAN, Point2::default()).is_none());
    }
}
