//! The surfaces of a drive in patches of a few metres of path: each keeps its shape, and moves as a whole when a loop is closed.

use floorguard_mapping::lidar_odometry::Pose3;
use nalgebra::Vector3;

use super::closing::SmallPoints;
use super::cloud::{CloudPoint, SurfaceCloud};

/// Key sweeps of a patch.
const KEYS: usize = 16;
/// A patch reaches so much farther than a sweep, metres.
const BEYOND_M: f32 = 10.0;

/// Cubes of a few key sweeps, in the frame of the first of them: nine bytes a cube, and a few numbers.
#[derive(Clone, Debug)]
struct Patch {
    key: usize,
    places: SmallPoints,
    /// Reflectivity, and returns up to 255.
    values: Vec<[u8; 2]>,
    time_s: Vec<f32>,
}

/// The patch that grows, and those that are done.
#[derive(Clone, Debug)]
pub(super) struct Patches {
    edge_m: f32,
    reach_m: f32,
    open: SurfaceCloud,
    open_key: usize,
    open_pose: Pose3,
    done: Vec<Patch>,
}

impl Patches {
    /// Cubes of this edge, of returns within this range; metres.
    pub(super) fn new(edge_m: f32, range_m: f32) -> Self {
        Self {
            edge_m,
            reach_m: range_m + BEYOND_M,
            open: SurfaceCloud::new(edge_m),
            open_key: 0,
            open_pose: Pose3::identity(),
            done: Vec::new(),
        }
    }

    /// The next key sweep follows, with its number and pose.
    pub(super) fn begin(&mut self, key: usize, pose: &Pose3) {
        if self.open.is_empty() || key >= self.open_key + KEYS {
            self.complete();
            (self.open_key, self.open_pose) = (key, *pose);
        }
    }

    /// From the frame of the odometry into that of the patch.
    pub(super) fn frame(&self) -> Pose3 {
        self.open_pose.inverse()
    }

    /// A return in the frame of the patch.
    pub(super) fn add(&mut self, place_m: &Vector3<f32>, reflectivity: u8, time_s: f32) {
        self.open.add(place_m, reflectivity, time_s);
    }

    fn complete(&mut self) {
        let points = std::mem::replace(&mut self.open, SurfaceCloud::new(self.edge_m)).points(1);
        if points.is_empty() {
            return;
        }
        let mut patch = Patch {
            key: self.open_key,
            places: SmallPoints::within(self.reach_m),
            values: Vec::with_capacity(points.len()),
            time_s: Vec::with_capacity(points.len()),
        };
        for point in points {
            patch.places.push(&point.place_m);
            patch.values.push([point.reflectivity as u8, point.count.min(255) as u8]);
            patch.time_s.push(point.time_s);
        }
        self.done.push(patch);
    }

    /// All of it, with the key sweeps at these poses.
    pub(super) fn cloud(&mut self, pose_of_key: &dyn Fn(usize) -> Pose3) -> SurfaceCloud {
        self.complete();
        let mut cloud = SurfaceCloud::new(self.edge_m);
        for patch in &self.done {
            let pose = pose_of_key(patch.key);
            for ((place, [reflectivity, count]), time_s) in
                patch.places.iter().zip(&patch.values).zip(&patch.time_s)
            {
                let place_m = pose.transform(&place.map(f64::from)).map(|value| value as f32);
                let (reflectivity, count) = (f32::from(*reflectivity), u32::from(*count));
                cloud.merge(&CloudPoint { place_m, reflectivity, time_s: *time_s, count });
            }
        }
        cloud
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patch_moves_with_its_key_sweep() {
        let mut patches = Patches::new(0.05, 60.0);
        let at = |x: f64| Pose3 { place_m: Vector3::new(x, 0.0, 0.0), ..Pose3::identity() };
        for key in 0..40 {
            let pose = at(key as f64);
            patches.begin(key, &pose);
            let place = patches.frame().transform(&(pose.place_m + Vector3::new(0.0, 2.025, 0.0)));
            patches.add(&place.map(|value| value as f32), 9, key as f32);
        }
        // As measured: one cube a metre. The second patch moved sideways by half a metre: so are its 16.
        let still = patches.cloud(&|key| at(key as f64));
        assert_eq!(still.len(), 40);
        let moved = patches.cloud(&|key| {
            let aside = if key == 16 { 0.5 } else { 0.0 };
            Pose3 { place_m: Vector3::new(key as f64, aside, 0.0), ..Pose3::identity() }
        });
        let aside = moved.points(1).iter().filter(|point| (point.place_m.y - 2.525).abs() < 0.01).count();
        assert_eq!((moved.len(), aside), (40, 16));
    }
}
