//! Floor that the brush may have cleaned without credit.
//!
//! A belief that finds its pose wrong withdraws the credit of the brush; while it does not trust its pose it gives none. The brush cleaned
//! all the same, so that less dirt may lie there than the map expects. A dirt sensor without hits over such cells would be evidence against
//! every pose, above all the true one: the next pass would end with a wrong pose again, without end.

use floorguard_mapping::GridGeometry;
use floorguard_types::geometry::Point2;

use super::cells_around::cells_around;

/// Which cells these are.
#[derive(Clone, Debug, Default)]
pub struct UncreditedFloor {
    is_uncredited: Vec<bool>,
}

impl UncreditedFloor {
    /// A raster of so many cells, all credited.
    #[must_use]
    pub fn new(cells: usize) -> Self {
        Self { is_uncredited: vec![false; cells] }
    }

    /// The brush was on this cell, without credit.
    pub fn add(&mut self, cell: usize) {
        if let Some(is_uncredited) = self.is_uncredited.get_mut(cell) {
            *is_uncredited = true;
        }
    }

    /// The brush was around this place.
    pub fn add_around(&mut self, geometry: &GridGeometry, (place, reach_m): (Point2, f32)) {
        for cell in cells_around(geometry, place, reach_m) {
            self.add(cell);
        }
    }

    /// Some such cell lies around a place.
    #[must_use]
    pub fn is_around(&self, geometry: &GridGeometry, (place, reach_m): (Point2, f32)) -> bool {
        cells_around(geometry, place, reach_m).any(|cell| self.is_uncredited.get(cell) == Some(&true))
    }

    /// The expected dirt is new: it holds everywhere.
    pub fn clear(&mut self) {
        self.is_uncredited.fill(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floor_under_the_brush_is_found_again() {
        let geometry = GridGeometry::new(40, 40, 0.1, Point2::default()).unwrap();
        let mut floor = UncreditedFloor::new(geometry.cell_count());
        let place = Point2::new(2.0, 2.0);
        assert!(!floor.is_around(&geometry, (place, 5.0)), "nothing yet");
        floor.add_around(&geometry, (place, 0.3));
        assert!(floor.is_around(&geometry, (Point2::new(2.5, 2.0), 0.3)));
        assert!(!floor.is_around(&geometry, (Point2::new(2.9, 2.0), 0.3)), "0.3 m beside it");
        assert!(!floor.is_around(&geometry, (Point2::new(-9.0, 2.0), 0.3)), "beyond the map");
        floor.clear();
        assert!(!floor.is_around(&geometry, (place, 0.3)));
        floor.add(usize::MAX);
    }
}
