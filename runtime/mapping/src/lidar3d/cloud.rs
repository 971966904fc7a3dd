//! The surfaces of a building as a cloud: returns of many sweeps, one mean for each small cube.

use std::collections::HashMap;

use nalgebra::Vector3;

/// The mean of the returns in one cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudPoint {
    /// Metres in the map.
    pub place_m: Vector3<f32>,
    /// Mean reflectivity, 0 to 255; 0 where the log has none.
    pub reflectivity: f32,
    /// When the cube was seen first, seconds since the first sweep.
    pub time_s: f32,
    /// Returns in it.
    pub count: u32,
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    sum: Vector3<f64>,
    reflectivity: u64,
    count: u32,
    time_s: f32,
}

/// Grows with the building: some 40 bytes for each cube that holds a return.
#[derive(Clone, Debug)]
pub struct SurfaceCloud {
    edge_m: f32,
    cells: HashMap<[i32; 3], Cell>,
}

impl SurfaceCloud {
    /// With cubes of this edge, metres, > 0.
    #[must_use]
    pub fn new(edge_m: f32) -> Self {
        Self { edge_m: edge_m.max(1.0e-3), cells: HashMap::new() }
    }

    /// A return more.
    pub fn add(&mut self, place_m: &Vector3<f32>, reflectivity: u8, time_s: f32) {
        let index = |value: f32| libm::floorf(value / self.edge_m) as i32;
        let key = [index(place_m.x), index(place_m.y), index(place_m.z)];
        let new = Cell { sum: Vector3::zeros(), reflectivity: 0, count: 0, time_s };
        let cell = self.cells.entry(key).or_insert(new);
        cell.sum += place_m.map(f64::from);
        cell.reflectivity += u64::from(reflectivity);
        cell.count = cell.count.saturating_add(1);
    }

    /// The returns of a cube of another cloud, whose mean lies here.
    pub fn merge(&mut self, point: &CloudPoint) {
        let index = |value: f32| libm::floorf(value / self.edge_m) as i32;
        let key = [index(point.place_m.x), index(point.place_m.y), index(point.place_m.z)];
        let new = Cell { sum: Vector3::zeros(), reflectivity: 0, count: 0, time_s: point.time_s };
        let cell = self.cells.entry(key).or_insert(new);
        cell.sum += point.place_m.map(f64::from) * f64::from(point.count);
        cell.reflectivity += u64::from(point.count) * point.reflectivity as u64;
        cell.count = cell.count.saturating_add(point.count);
        cell.time_s = cell.time_s.min(point.time_s);
    }

    /// How many cubes hold a return.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether none does.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// All cubes with at least `count_least` returns, ordered by x, y, z: the same for the same returns.
    #[must_use]
    pub fn points(&self, count_least: u32) -> Vec<CloudPoint> {
        let mut kept: Vec<_> = self.cells.iter().filter(|(_, cell)| cell.count >= count_least).collect();
        kept.sort_unstable_by_key(|(key, _)| **key);
        let point = |(_, cell): (&[i32; 3], &Cell)| CloudPoint {
            place_m: (cell.sum / f64::from(cell.count)).map(|value| value as f32),
            reflectivity: cell.reflectivity as f32 / cell.count as f32,
            time_s: cell.time_s,
            count: cell.count,
        };
        kept.into_iter().map(point).collect()
    }
}
