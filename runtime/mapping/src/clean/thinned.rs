//! A cloud with at most one point in each small cube.

use std::collections::HashSet;
use std::hash::BuildHasherDefault;

use floorguard_types::geometry::Point3;

use super::voxels::KeyHasher;

/// Collects points and leaves out those of cubes that have one already.
#[derive(Clone, Debug)]
pub struct Thinned {
    per_m: f32,
    cubes: HashSet<[i32; 3], BuildHasherDefault<KeyHasher>>,
    points: Vec<Point3>,
    entered: u64,
}

impl Thinned {
    /// Cubes of this edge, > 0, metres.
    #[must_use]
    pub fn new(edge_m: f32) -> Self {
        Self { per_m: 1.0 / edge_m.max(1.0e-4), cubes: HashSet::default(), points: Vec::new(), entered: 0 }
    }

    /// Enters a point of the map.
    pub fn enter(&mut self, point: Point3) {
        self.entered += 1;
        let cube = [point.x_m, point.y_m, point.z_m].map(|value| (value * self.per_m).floor() as i32);
        if self.cubes.insert(cube) {
            self.points.push(point);
        }
    }

    /// The first point of each cube, in the order of their coming.
    #[must_use]
    pub fn points(&self) -> &[Point3] {
        &self.points
    }

    /// Points that were entered.
    #[must_use]
    pub const fn entered(&self) -> u64 {
        self.entered
    }
}
