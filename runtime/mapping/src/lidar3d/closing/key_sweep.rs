//! A sweep that is kept for the closing of loops, in little room.

use floorguard_mapping::lidar_odometry::Pose3;
use nalgebra::{Matrix6, Vector3};

/// Points in 16 bits for each axis.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallPoints {
    step_m: f32,
    points: Vec<[i16; 3]>,
}

/// Finer than this is noise.
const STEP_LEAST_M: f32 = 0.002;

impl SmallPoints {
    /// For points within this distance along each axis: steps of two millimetres up to 65 m.
    #[must_use]
    pub fn within(reach_m: f32) -> Self {
        Self { step_m: (reach_m / f32::from(i16::MAX)).max(STEP_LEAST_M), points: Vec::new() }
    }

    /// A farther point ends at the reach.
    pub fn push(&mut self, point: &Vector3<f32>) {
        let part = |value: f32| libm::roundf(value / self.step_m) as i16;
        self.points.push([part(point.x), part(point.y), part(point.z)]);
    }

    /// In metres.
    pub fn iter(&self) -> impl Iterator<Item = Vector3<f32>> {
        let step_m = self.step_m;
        self.points.iter().map(move |point| Vector3::from(point.map(f32::from)) * step_m)
    }
}

/// A sweep that entered the map, in the frame of the sensor at its end. Some 20 KB of a VLP-16.
#[derive(Clone, Debug)]
pub struct KeySweep {
    /// Number of the sweep in the drive.
    pub sweep: usize,
    /// Seconds since the first sweep.
    pub time_s: f64,
    /// By the odometry alone.
    pub pose: Pose3,
    /// Of the pose as seen from the key sweep before: rotation and place, in the sensor's axes.
    pub covariance: Matrix6<f64>,
    /// Means of returns: what is measured with.
    pub means: SmallPoints,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_back_within_a_step() {
        let mut points = SmallPoints::within(60.0);
        let given = [Vector3::new(1.2345, -30.0005, 0.0), Vector3::new(-59.9, 3.3333, 12.0)];
        given.iter().for_each(|point| points.push(point));
        for (found, point) in points.iter().zip(given) {
            assert!((found - point).amax() <= 0.001_01, "{found} {point}");
        }
        // Farther than fits: the end of the range, never the other side.
        points.push(&Vector3::new(100.0, -100.0, 0.0));
        let last = points.iter().last().unwrap();
        assert!(last.x > 65.0 && last.y < -65.0);
        let mut far = SmallPoints::within(200.0);
        far.push(&Vector3::new(199.0, -199.0, 0.0));
        assert!((far.iter().last().unwrap().x - 199.0).abs() < 0.01);
    }
}
