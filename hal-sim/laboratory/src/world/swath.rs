//! The floor that the brush went over, by ground truth.

use std::collections::BTreeSet;

use floorguard_types::geometry::{Point2, Pose2};

/// Width of the brush deck, metres (FLOBOT's scrubber).
pub const BRUSH_M: f32 = 0.65;
/// Where the deck is, forward of the rear axle, metres.
const DECK_M: f32 = 0.25;
/// Side of a cell, metres.
const CELL_M: f32 = 0.05;

/// Cells touched.
#[derive(Clone, Debug, Default)]
pub struct Swath {
    cells: BTreeSet<(i32, i32)>,
}

impl Swath {
    /// The deck is at a pose.
    pub fn touch(&mut self, robot: Pose2) {
        let steps = (BRUSH_M / CELL_M * 2.0) as i32;
        for step in 0..=steps {
            let across_m = BRUSH_M * (step as f32 / steps as f32 - 0.5);
            let place = robot.transform(Point2::new(DECK_M, across_m));
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
        let mut swath = Swath::default();
        for step in 0..=1_000 {
            swath.touch(Pose2::new(step as f32 * 0.01, 0.0, 0.0));
        }
        assert!((swath.area_m2() - 10.0 * f64::from(BRUSH_M)).abs() < 0.6, "{}", swath.area_m2());
    }
}
