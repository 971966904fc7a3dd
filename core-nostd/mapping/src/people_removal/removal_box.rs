//! The box around a person whose points leave the map; the floor below stays.

use floorguard_types::geometry::Point3;

/// Size of a box, metres. Invariant: all positive and finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemovalSize {
    /// Edge along x and y, metres.
    pub side_m: f32,
    /// Points lower than this above the floor stay, metres.
    pub floor_clearance_m: f32,
    /// Points higher than this above the floor stay, metres.
    pub height_m: f32,
}

impl Default for RemovalSize {
    /// 1 m × 1 m, from 0.05 m to 2 m above the floor.
    fn default() -> Self {
        Self { side_m: 1.0, floor_clearance_m: 0.05, height_m: 2.0 }
    }
}

/// A box along the axes of the map. Points on its faces are inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemovalBox {
    /// Smallest coordinates.
    pub lowest_in_map: Point3,
    /// Largest coordinates.
    pub highest_in_map: Point3,
}

impl RemovalBox {
    /// Around a place; `floor_m` is the height of the floor there, in the map.
    ///
    /// ```
    /// use floorguard_mapping::people_removal::{RemovalBox, RemovalSize};
    /// use floorguard_types::geometry::Point3;
    ///
    /// let removed = RemovalBox::around(Point3::new(4.0, 2.0, 1.1), 0.0, RemovalSize::default());
    /// assert!(removed.contains(Point3::new(4.4, 1.6, 0.1)));
    /// // The floor below and the wall beside stay.
    /// assert!(!removed.contains(Point3::new(4.0, 2.0, 0.02)));
    /// assert!(!removed.contains(Point3::new(4.6, 2.0, 1.0)));
    /// ```
    #[must_use]
    pub fn around(person_in_map: Point3, floor_m: f32, size: RemovalSize) -> Self {
        let half_m = 0.5 * size.side_m;
        let Point3 { x_m, y_m, .. } = person_in_map;
        Self {
            lowest_in_map: Point3::new(x_m - half_m, y_m - half_m, floor_m + size.floor_clearance_m),
            highest_in_map: Point3::new(x_m + half_m, y_m + half_m, floor_m + size.height_m),
        }
    }

    /// Whether a point of the map is in it.
    #[inline]
    #[must_use]
    pub fn contains(&self, point_in_map: Point3) -> bool {
        let (low, high) = (self.lowest_in_map, self.highest_in_map);
        (low.x_m..=high.x_m).contains(&point_in_map.x_m)
            && (low.y_m..=high.y_m).contains(&point_in_map.y_m)
            && (low.z_m..=high.z_m).contains(&point_in_map.z_m)
    }
}
