//! A room of plain walls through which a robot with a lidar drives, made without the simulator.

use std::path::Path;

use floorguard_recording::{MotionRow, PointRow, Recorder};
use floorguard_types::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::ImuSample;
use floorguard_types::time::Stamp;

/// Range in a room from −4, −3 to 5, 4 with a ceiling at 2.6 m.
pub fn room_range_m(from: [f64; 3], direction: [f64; 3]) -> f64 {
    let (low, high) = ([-4.0, -3.0, 0.0], [5.0, 4.0, 2.6]);
    let along = |axis: usize| {
        let wall = if direction[axis] > 0.0 { high[axis] } else { low[axis] };
        if direction[axis].abs() < 1e-9 { f64::INFINITY } else { (wall - from[axis]) / direction[axis] }
    };
    (0..3).map(along).fold(f64::INFINITY, f64::min)
}

/// Bag of a robot that stands for a second and then drives along x with 0.4 m/s; its lidar is 0.5 m ahead, its gyroscope has a bias.
pub fn space_bag(path: &Path, sweeps: u32) {
    let mut recorder = Recorder::new(std::fs::File::create(path).expect("a file")).expect("written");
    let place_m = |at_s: f64| -2.0 + 0.4 * (at_s - 1.0).max(0.0);
    let lidar = Transform3 { translation: Point3::new(0.5, 0.0, 0.8), ..Transform3::IDENTITY };
    let stamp = |at_s: f64| Stamp::from_micros(1_700_000_000_000_000 + (at_s * 1.0e6) as u64);
    recorder.mounting(stamp(0.0), "lidar", &lidar).expect("written");
    recorder.mounting(stamp(0.0), "imu", &Transform3::IDENTITY).expect("written");
    for index in 0..sweeps {
        let start_s = 0.1 * f64::from(index);
        for part in 0..10 {
            let stamp = stamp(start_s + 0.01 * f64::from(part));
            let pose_in_odom = Pose2::new(place_m(start_s + 0.01 * f64::from(part)) as f32, 0.0, 0.0);
            let row = MotionRow { stamp, pose_in_odom, twist: Twist2::ZERO, covariance: [[0.0; 3]; 3] };
            recorder.motion(stamp, &row).expect("written");
            let sample = ImuSample { stamp, angular_radps: [0.01, 0.0, -0.02], ..ImuSample::default() };
            recorder.imu(stamp, &sample).expect("written");
        }
        let mut points = Vec::new();
        for column in 0..900 {
            let time_s = 0.1 * f64::from(column) / 900.0;
            let (sin, cos) = (-0.4 * f64::from(column)).to_radians().sin_cos();
            for ring in 0..16_u16 {
                let (up, along) = (2.0 * f64::from(ring) - 15.0).to_radians().sin_cos();
                let direction = [along * cos, along * sin, up];
                let range_m = room_range_m([place_m(start_s + time_s) + 0.5, 0.0, 0.8], direction);
                let position_m = direction.map(|part| (part * range_m) as f32);
                points.push(PointRow { position_m, reflectivity: 9, ring, time_s: time_s as f32 });
            }
        }
        recorder.points(stamp(start_s), (stamp(start_s), "lidar"), &points).expect("written");
    }
    recorder.finish().expect("closed");
}
