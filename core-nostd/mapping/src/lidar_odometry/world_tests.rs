//! A world of boxes for the tests: rays are cut with boxes in double precision, at the pose of each single firing.

use std::vec::Vec;

use nalgebra::Vector3;

use super::averaging::SweepReturn;
use super::motion::{Pose3, Twist3};

/// Seconds of a revolution, and firings in it.
pub const PERIOD_S: f64 = 0.1;
const FIRINGS: u32 = 1_800;
const RANGE_M: f64 = 60.0;

/// Lower and upper corner.
pub type Cuboid = [Vector3<f64>; 2];

/// A room with boxes in it; the room's walls, floor and ceiling are seen from within.
pub struct World {
    pub room: Cuboid,
    pub boxes: Vec<Cuboid>,
    /// Standard deviation of the ranges, metres.
    pub noise_m: f64,
}

/// Numbers that look random, the same every time.
pub struct Noise(u64);

impl Noise {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Within −1…1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Mean 0, deviation 1: the sum of three.
    fn normal(&mut self) -> f64 {
        self.uniform() + self.uniform() + self.uniform()
    }
}

/// Where a ray enters and leaves a box.
fn cut(from: &Vector3<f64>, direction: &Vector3<f64>, [low, high]: &Cuboid) -> [f64; 2] {
    let mut span = [f64::NEG_INFINITY, f64::INFINITY];
    for axis in 0..3 {
        let (a, b) =
            ((low[axis] - from[axis]) / direction[axis], (high[axis] - from[axis]) / direction[axis]);
        span = [span[0].max(a.min(b)), span[1].min(a.max(b))];
    }
    span
}

impl World {
    /// A room of 9 × 7 m with a table, a pillar and a shelf.
    pub fn furnished() -> Self {
        let cuboid = |a: [f64; 3], b: [f64; 3]| [Vector3::from(a), Vector3::from(b)];
        Self {
            room: cuboid([-4.0, -3.0, -0.8], [5.0, 4.0, 1.8]),
            boxes: std::vec![
                cuboid([2.0, 1.0, -0.8], [3.2, 2.0, 0.0]),
                cuboid([1.5, -2.0, -0.8], [1.9, -1.6, 1.8]),
                cuboid([-4.0, 2.0, -0.8], [-2.0, 2.6, 1.2]),
            ],
            noise_m: 0.01,
        }
    }

    /// A corridor 2.4 m wide, without ends in sight.
    pub fn corridor() -> Self {
        let room = [Vector3::new(-900.0, -1.2, -0.8), Vector3::new(900.0, 1.2, 1.8)];
        Self { room, boxes: Vec::new(), noise_m: 0.01 }
    }

    fn range_m(&self, from: &Vector3<f64>, direction: &Vector3<f64>) -> f64 {
        let [_, wall] = cut(from, direction, &self.room);
        self.boxes.iter().fold(wall, |nearest, cuboid| {
            let [enters, leaves] = cut(from, direction, cuboid);
            if enters <= leaves && enters > 0.0 { nearest.min(enters) } else { nearest }
        })
    }

    /// The sweep of a VLP-16 that ends at a pose with a velocity.
    pub fn sweep(&self, end: &Pose3, twist: &Twist3, noise: &mut Noise) -> Vec<SweepReturn> {
        let mut sweep = Vec::new();
        for firing in 0..FIRINGS {
            let share = f64::from(firing) / f64::from(FIRINGS);
            let pose = end.compose(&twist.over((share - 1.0) * PERIOD_S));
            let azimuth = -core::f64::consts::TAU * share;
            for ring in 0..16_u8 {
                let elevation = (f64::from(ring) * 2.0 - 15.0).to_radians();
                let (up, along) = elevation.sin_cos();
                let direction = Vector3::new(along * azimuth.cos(), along * azimuth.sin(), up);
                let range = self.range_m(&pose.place_m, &(pose.rotation * direction));
                if range > RANGE_M {
                    continue;
                }
                let range = range + self.noise_m * noise.normal();
                sweep.push(SweepReturn {
                    point_in_sensor: (direction * range).map(|value| value as f32),
                    time_share: share as f32,
                    ring,
                });
            }
        }
        sweep
    }
}
