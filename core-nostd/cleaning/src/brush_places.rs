//! Where the brushes of all particles are: which cells are still under, or beside, some of them.

use super::swath::Brush;
use floorguard_mapping::{GridCoordinates, GridGeometry};
use floorguard_types::geometry::Point2;
use floorguard_types::number::saturating_i32;

/// Cells in which the middle of some brush can lie before the bounding box takes over.
const PLACES_MAX: usize = 48;

/// Cells that hold the middle of some particle's brush. A cell is *active* while one of them is within half a brush
/// and one cell (book, Cleaning: Active cells).
#[derive(Clone, Debug)]
pub struct BrushPlaces {
    cells: heapless::Vec<GridCoordinates, PLACES_MAX>,
    reach: i32,
    low: GridCoordinates,
    high: GridCoordinates,
    is_full: bool,
}

impl BrushPlaces {
    /// No brush yet.
    #[must_use]
    pub fn new(brush: Brush, geometry: &GridGeometry) -> Self {
        let half = 0.5 * brush.width_m * geometry.cells_per_metre();
        let reach = saturating_i32(libm::ceilf(half)).clamp(0, 1_000).saturating_add(1);
        Self {
            cells: heapless::Vec::new(),
            reach,
            low: GridCoordinates { column: i32::MAX, row: i32::MAX },
            high: GridCoordinates { column: i32::MIN, row: i32::MIN },
            is_full: false,
        }
    }

    /// Adds the brush of a particle.
    #[inline]
    pub fn add(&mut self, bar: [Point2; 2], geometry: &GridGeometry) {
        let [left, right] = bar;
        let middle = Point2::new(0.5 * (left.x_m + right.x_m), 0.5 * (left.y_m + right.y_m));
        let place = geometry.coordinates_of(middle);
        let (low, high) = (self.low, self.high);
        self.low = GridCoordinates { column: low.column.min(place.column), row: low.row.min(place.row) };
        self.high = GridCoordinates { column: high.column.max(place.column), row: high.row.max(place.row) };
        if !self.cells.contains(&place) {
            // More places than capacity: the bounding box holds cells longer than needed, never shorter.
            self.is_full |= self.cells.push(place).is_err();
        }
    }

    /// Some brush is over this cell or beside it.
    #[must_use]
    pub fn is_near(&self, column: i32, row: i32) -> bool {
        let near = |a: i32, b: i32| a.abs_diff(b) <= self.reach.unsigned_abs();
        if self.is_full {
            return column >= self.low.column.saturating_sub(self.reach)
                && column <= self.high.column.saturating_add(self.reach)
                && row >= self.low.row.saturating_sub(self.reach)
                && row <= self.high.row.saturating_add(self.reach);
        }
        self.cells.iter().any(|place| near(place.column, column) && near(place.row, row))
    }
}
