//! A second plain reference remover: ratios of heights in polar bins as ERASOR compares them (Lim et al. 2021), written for
//! reading.
//!
//! The map of all returns and each sweep are cut into bins around the sensor. Where the map reaches much higher above its lowest
//! point than the sweep does, something stood there and is gone: all of the bin but its ground leaves the map.

use std::collections::HashMap;

use floorguard_types::geometry::Point3;

type Key = [i32; 3];

/// Edge of the map's voxels, metres.
const VOXEL_M: f32 = 0.1;
/// Rings and sectors around the sensor, as published for 80 m; indoors the rings end sooner.
const RINGS: usize = 20;
const SECTORS: usize = 108;
const FARTHEST_M: f32 = 10.0;
/// Heights above the floor that count, metres.
const HEIGHTS_M: [f32; 2] = [-0.2, 2.2];
/// A sweep that reaches lower than this share of the map's height contradicts it.
const RATIO: f32 = 0.2;
/// Bins of a sweep with fewer returns say nothing.
const RETURNS_MIN: u32 = 6;
/// What is this near to the lowest point of a bin is its ground, metres.
const GROUND_M: f32 = 0.15;

/// Lowest and highest point of a bin.
#[derive(Clone, Copy)]
struct Bin {
    low_m: f32,
    high_m: f32,
    count: u32,
}

const EMPTY: Bin = Bin { low_m: f32::INFINITY, high_m: f32::NEG_INFINITY, count: 0 };

impl Bin {
    fn enter(&mut self, height_m: f32) {
        self.low_m = self.low_m.min(height_m);
        self.high_m = self.high_m.max(height_m);
        self.count += 1;
    }

    fn height_m(&self) -> f32 {
        (self.high_m - self.low_m).max(0.0)
    }
}

/// The map of all returns; true for a voxel that was removed.
#[derive(Default)]
pub struct Erasor {
    voxels: HashMap<Key, bool>,
}

fn key(point: &Point3) -> Key {
    [point.x_m, point.y_m, point.z_m].map(|value| (value / VOXEL_M).floor() as i32)
}

fn middle(key: &Key) -> Point3 {
    let [x_m, y_m, z_m] = key.map(|index| (index as f32 + 0.5) * VOXEL_M);
    Point3::new(x_m, y_m, z_m)
}

/// Number of the bin around a sensor; `None` outside.
fn bin_of(sensor: &Point3, point: &Point3) -> Option<usize> {
    let (x, y) = (point.x_m - sensor.x_m, point.y_m - sensor.y_m);
    let distance_m = x.hypot(y);
    let is_inside = distance_m < FARTHEST_M && (HEIGHTS_M[0]..HEIGHTS_M[1]).contains(&point.z_m);
    let ring = (distance_m / FARTHEST_M * RINGS as f32) as usize;
    let turn = (y.atan2(x) / std::f32::consts::TAU).rem_euclid(1.0);
    is_inside.then(|| ring * SECTORS + ((turn * SECTORS as f32) as usize).min(SECTORS - 1))
}

impl Erasor {
    /// First pass: enters the returns of a sweep into the map.
    pub fn enter(&mut self, points: &[Point3]) {
        for point in points {
            self.voxels.entry(key(point)).or_insert(false);
        }
    }

    /// Second pass: compares a sweep with the map.
    pub fn compare(&mut self, sensor: Point3, points: &[Point3]) {
        let mut of_sweep = vec![EMPTY; RINGS * SECTORS];
        for point in points {
            if let Some(bin) = bin_of(&sensor, point) {
                of_sweep[bin].enter(point.z_m);
            }
        }
        let mut of_map = vec![EMPTY; RINGS * SECTORS];
        let mut near = Vec::new();
        for (key, is_removed) in &self.voxels {
            let point = middle(key);
            if let Some(bin) = bin_of(&sensor, &point).filter(|_| !is_removed) {
                of_map[bin].enter(point.z_m);
                near.push((*key, bin));
            }
        }
        for (key, bin) in near {
            let (sweep, map) = (of_sweep[bin], of_map[bin]);
            let contradicts = sweep.count >= RETURNS_MIN && sweep.height_m() < RATIO * map.height_m();
            if contradicts && middle(&key).z_m > map.low_m + GROUND_M {
                self.voxels.insert(key, true);
            }
        }
    }

    /// Whether a return stays.
    #[must_use]
    pub fn stays(&self, point: Point3) -> bool {
        !self.voxels.get(&key(&point)).copied().unwrap_or(false)
    }
}
