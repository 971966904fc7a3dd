//! A plain reference remover: occupancy by ray casting as OctoMap does it (Hornung et al. 2013), written for reading.
//!
//! Every ray lowers the log-odds of the voxels it crosses and raises that of its end, each voxel once a sweep; a return
//! stays if its voxel is occupied at the end. Values are those of the publication's library.

use std::collections::{HashMap, HashSet};

use floorguard_types::geometry::Point3;

type Key = [i32; 3];

/// Log-odds of voxels.
pub struct OctoMap {
    voxel_m: f32,
    log_odds: HashMap<Key, f32>,
}

const HIT: f32 = 0.847_298;
const MISS: f32 = -0.405_465;
const LOWEST: f32 = -1.992_43;
const HIGHEST: f32 = 3.476_099;

impl OctoMap {
    /// An empty map.
    #[must_use]
    pub fn new(voxel_m: f32) -> Self {
        Self { voxel_m, log_odds: HashMap::new() }
    }

    fn key(&self, [x, y, z]: [f32; 3]) -> Key {
        [x, y, z].map(|value| (value / self.voxel_m).floor() as i32)
    }

    /// Enters a sweep: all its returns, seen from one place.
    pub fn enter(&mut self, sensor: Point3, points: &[Point3]) {
        let ends: HashSet<Key> = points.iter().map(|p| self.key([p.x_m, p.y_m, p.z_m])).collect();
        let mut crossed = HashSet::new();
        for end in points {
            let (from, to) = ([sensor.x_m, sensor.y_m, sensor.z_m], [end.x_m, end.y_m, end.z_m]);
            let length = (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum::<f32>().sqrt();
            let steps = (length / (0.5 * self.voxel_m)).ceil() as usize;
            for step in 0..steps {
                let share = step as f32 / steps as f32;
                let key = self.key([0, 1, 2].map(|axis| from[axis] + share * (to[axis] - from[axis])));
                if !ends.contains(&key) {
                    crossed.insert(key);
                }
            }
        }
        for (keys, change) in [(&crossed, MISS), (&ends, HIT)] {
            for key in keys {
                let value = self.log_odds.entry(*key).or_insert(0.0);
                *value = (*value + change).clamp(LOWEST, HIGHEST);
            }
        }
    }

    /// Whether a return stays.
    #[must_use]
    pub fn is_occupied(&self, point: Point3) -> bool {
        self.log_odds.get(&self.key([point.x_m, point.y_m, point.z_m])).is_some_and(|value| *value > 0.0)
    }
}
