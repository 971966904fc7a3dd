//! Holes in the floor under what was removed, and how much of them was seen all the same.

use std::collections::{BTreeMap, BTreeSet};

use floorguard_types::geometry::Point3;

/// Edge of a square, metres: half the width of a person, and wider than the rings of a lidar lie apart on the floor nearby.
const SQUARE_M: f32 = 0.25;
/// Points this near to the height of the floor are floor, metres.
const FLOOR_HALF_M: f32 = 0.10;
/// What stood on the floor begins below this height above it, metres.
const LOW_M: f32 = 0.6;

/// Squares of the floor over which something was removed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RemovedAreas {
    /// Height of the floor, metres.
    floor_m: f32,
    squares: BTreeMap<[i32; 2], bool>,
}

/// Areas, m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AreaCount {
    /// Floor below what was removed.
    pub removed_m2: f32,
    /// Of that, floor that was seen at another time.
    pub filled_m2: f32,
}

impl AreaCount {
    /// Filled share, 0 to 1; 1 where nothing was removed.
    #[must_use]
    pub fn filled_share(&self) -> f32 {
        if self.removed_m2 > 0.0 { self.filled_m2 / self.removed_m2 } else { 1.0 }
    }
}

fn square(point: Point3) -> [i32; 2] {
    [point.x_m, point.y_m].map(|value| (value / SQUARE_M).floor() as i32)
}

impl RemovedAreas {
    /// Of points that were removed; those higher than 0.6 m above the floor count for no square.
    #[must_use]
    pub fn new(removed: impl Iterator<Item = Point3>, floor_m: f32) -> Self {
        let low = removed.filter(|point| point.z_m - floor_m <= LOW_M);
        Self { floor_m, squares: low.map(|point| (square(point), false)).collect() }
    }

    /// Enters points that stay.
    pub fn see(&mut self, kept: impl Iterator<Item = Point3>) {
        for point in kept.filter(|point| (point.z_m - self.floor_m).abs() <= FLOOR_HALF_M) {
            if let Some(is_filled) = self.squares.get_mut(&square(point)) {
                *is_filled = true;
            }
        }
    }

    /// The areas.
    ///
    /// ```
    /// use floorguard_mapping_host::clean::RemovedAreas;
    /// use floorguard_types::geometry::Point3;
    ///
    /// let removed = [Point3::new(0.1, 0.1, 0.5), Point3::new(1.1, 0.1, 0.5)];
    /// let mut areas = RemovedAreas::new(removed.into_iter(), 0.0);
    /// // Floor under the first; the wall over the second fills no hole.
    /// areas.see([Point3::new(0.2, 0.2, 0.01), Point3::new(1.1, 0.1, 1.0)].into_iter());
    /// assert_eq!((areas.count().removed_m2, areas.count().filled_m2), (0.125, 0.0625));
    /// assert_eq!(areas.open_squares().count(), 1);
    /// ```
    #[must_use]
    pub fn count(&self) -> AreaCount {
        let area = |count: usize| count as f32 * SQUARE_M * SQUARE_M;
        AreaCount {
            removed_m2: area(self.squares.len()),
            filled_m2: area(self.squares.values().filter(|is_filled| **is_filled).count()),
        }
    }

    /// Middles of the squares that are still holes, x and y in metres, in order of x.
    pub fn open_squares(&self) -> impl Iterator<Item = [f32; 2]> {
        let open = self.squares.iter().filter(|(_, is_filled)| !**is_filled);
        open.map(|(key, _)| key.map(|index| (index as f32 + 0.5) * SQUARE_M))
    }

    /// Points that stay over squares where something was removed, for pictures.
    #[must_use]
    pub fn filled_points(&self, kept: &[Point3]) -> Vec<Point3> {
        let squares: BTreeSet<[i32; 2]> = self.squares.keys().copied().collect();
        let is_floor = |point: &Point3| (point.z_m - self.floor_m).abs() <= FLOOR_HALF_M;
        kept.iter().copied().filter(|point| is_floor(point) && squares.contains(&square(*point))).collect()
    }
}
