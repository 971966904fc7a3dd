//! The floor that the brush went over, by ground truth.

use std::collections::BTreeSet;

use floorguard_sim::robot::BrushDeck;
use floorguard_types::geometry::{Point2, Pose2};

/// Side of a cell, metres.
const CELL_M: f32 = 0.05;

/// Cells touched.
#[derive(Clone, Debug)]
pub struct SweptArea {
    deck: BrushDeck,
    cells: BTreeSet<(i32, i32)>,
}

impl SweptArea {
    /// Nothing is swept yet.
    #[must_use]
    pub const fn new(deck: BrushDeck) -> Self {
        Self { deck, cells: BTreeSet::new() }
    }

    /// The robot is at a pose.
    pub fn touch(&mut self, robot: Pose2) {
        let BrushDeck { width_m, offset_m } = self.deck;
        let steps = (width_m / CELL_M * 2.0) as i32;
        for step in 0..=steps {
            let across_m = width_m * (step as f32 / steps as f32 - 0.5);
            let place = robot.transform(Point2::new(offset_m, across_m));
            self.cells.insert(((place.x_m / CELL_M).floor() as i32, (place.y_m / CELL_M).floor() as i32));
        }
    }

    /// Area, m².
    #[must_use]
    pub fn area_m2(&self) -> f64 {
        self.cells.len() as f64 * f64::from(CELL_M * CELL_M)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_metres_straight_are_ten_metres_of_brush() {
        let deck = BrushDeck { width_m: 0.65, offset_m: 0.25 };
        let mut swept = SweptArea::new(deck);
        for step in 0..=1_000 {
            swept.touch(Pose2::new(step as f32 * 0.01, 0.0, 0.0));
        }
        assert!((swept.area_m2() - 6.5).abs() < 0.6, "{}", swept.area_m2());
    }
}
