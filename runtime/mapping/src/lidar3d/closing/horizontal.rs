//! The scan of a sweep: what a scanner on the plane would see from the sensor's height.

use std::f32::consts::{PI, TAU};

use floorguard_mapping::lidar_odometry::Pose3;
use floorguard_types::geometry::Point2;
use nalgebra::{Matrix3, Vector3};

use crate::front_end::Node;
use crate::se2::Se2;

/// Beams of the scan.
const BEAMS: usize = 720;
/// Angle between them, radians.
pub(super) const BEAM_STEP_RAD: f32 = TAU / BEAMS as f32;

/// Place and heading on the plane; turns about the other axes are left out.
pub(super) fn flat(pose: &Pose3) -> Se2 {
    let r = &pose.rotation;
    Se2::new(pose.place_m.x, pose.place_m.y, libm::atan2(r.m21, r.m11))
}

/// A pose in space at a height.
pub(super) fn upright(flat: Se2, height_m: f64) -> Pose3 {
    let (sin, cos) = libm::sincos(flat.heading_rad);
    Pose3 {
        rotation: Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0),
        place_m: Vector3::new(flat.x_m, flat.y_m, height_m),
    }
}

/// The nearest return of each beam, of those near the horizontal through the sensor.
pub(super) fn node(
    points: impl Iterator<Item = Vector3<f32>>,
    pose: &Pose3,
    time_s: f64,
    elevation_rad: f32,
) -> Node {
    let level = upright(flat(pose), pose.place_m.z).inverse().compose(pose).rotation.map(|part| part as f32);
    let mut nearest = [f32::INFINITY; BEAMS];
    let slope = libm::tanf(elevation_rad);
    for point in points {
        let point = level * point;
        let range_m = libm::hypotf(point.x, point.y);
        if point.z.abs() > slope * range_m {
            continue;
        }
        let share = (libm::atan2f(point.y, point.x) + PI) / TAU;
        let beam = ((share * BEAMS as f32) as usize).min(BEAMS - 1);
        nearest[beam] = nearest[beam].min(range_m);
    }
    let beams = nearest.iter().enumerate().filter(|(_, range_m)| range_m.is_finite());
    let point = |(beam, range_m): (usize, &f32)| {
        let (sin, cos) = libm::sincosf((beam as f32 + 0.5) * BEAM_STEP_RAD - PI);
        Point2::new(range_m * cos, range_m * sin)
    };
    Node {
        time_s,
        pose: flat(pose),
        odometry: None,
        points: beams.map(point).collect(),
        information: Matrix3::identity(),
        score: 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tilted_sensor_sees_the_same_scan() {
        // A round wall of 5 m, 2 m high, seen upright and with the sensor tilted by 5°.
        let mut upright_points = Vec::new();
        let mut tilted_points = Vec::new();
        let tilted = Pose3::identity().moved(Vector3::new(0.087, 0.0, 0.4), Vector3::new(1.0, 2.0, 0.3));
        let back = tilted.rotation.transpose().map(|part| part as f32);
        for step in 0..3_600 {
            for height in -20..=20 {
                let (sin, cos) = libm::sincosf(step as f32 * TAU / 3_600.0);
                let point = Vector3::new(5.0 * cos, 5.0 * sin, 0.05 * height as f32);
                upright_points.push(point);
                tilted_points.push(back * point);
            }
        }
        let one = node(upright_points.into_iter(), &Pose3::identity(), 0.0, 0.03);
        let other = node(tilted_points.into_iter(), &tilted, 0.0, 0.03);
        assert_eq!((one.points.len(), other.points.len()), (BEAMS, BEAMS));
        assert!(other.points.iter().all(|point| (point.norm() - 5.0).abs() < 0.01));
        assert!((other.pose.x_m - 1.0).abs() < 1e-9 && (other.pose.heading_rad - 0.4).abs() < 0.01);
    }
}
