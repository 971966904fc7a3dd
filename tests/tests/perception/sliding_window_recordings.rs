//! Two recordings of a real lidar that a servo tilts: another mechanism than the published one, without ground truth. The
//! points of all scans enter the window and its plan; counts and sums are those of the recording's key.

use std::io::Read as _;

use flate2::read::GzDecoder;
use floorguard_mapping::sliding_window::{CellPolicy, Inserted};
use floorguard_tests::data::recording;
use floorguard_tests::reproduce::sliding_window::window;
use floorguard_types::geometry::{Point3, Pose2};
use floorguard_types::time::Stamp;

/// Height of the tilting axis above the floor: not documented, metres.
const HEIGHT: f64 = 0.3;
/// The servo's angle of a horizontal scan, degrees.
const HORIZONTAL: f64 = 90.0;
/// An angle belongs to a scan if it was sent at most so long before or after it, seconds.
const GAP: f64 = 0.3;

/// Recording, scans, ranges within 0.05 m and 10 m, their sum in metres: the key.
const KEY: [(&str, usize, usize, f64); 2] = [
    ("turboslam_subset", 276, 87_348, 227_171.52),
    ("turboslam_lidar_servoAngle_imu_3hz_8hz_8hz", 204, 56_552, 157_597.29),
];

fn rows(name: &str) -> Option<Vec<Vec<f64>>> {
    let path = recording(&format!("actuated_lidar/{name}.csv.gz"))?;
    let mut text = String::new();
    GzDecoder::new(std::fs::File::open(path).unwrap()).read_to_string(&mut text).unwrap();
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    Some(text.lines().skip(1).map(numbers).collect())
}

/// The servo's angle at a time in nanoseconds, interpolated; `None` where it was not sent.
fn servo_at(servo: &[Vec<f64>], time_ns: f64) -> Option<f64> {
    let after = servo.partition_point(|row| row[0] < time_ns);
    let (before, after) = (servo.get(after.checked_sub(1)?)?, servo.get(after)?);
    let is_near = time_ns - before[0] <= GAP * 1e9 && after[0] - time_ns <= GAP * 1e9;
    let part = (time_ns - before[0]) / (after[0] - before[0]).max(1.0);
    is_near.then(|| before[1] + part * (after[1] - before[1]))
}

#[test]
fn recorded_scans_fill_the_window() {
    for (name, scans, count, sum_m) in KEY {
        let (Some(rows_of_scans), Some(servo)) =
            (rows(&format!("{name}.scan")), rows(&format!("{name}.servo_deg")))
        else {
            return;
        };
        assert_eq!(rows_of_scans.len(), scans);
        let (mut found, mut total_m, mut entered) = (0_usize, 0.0, 0_usize);
        let mut window = window(0.05, CellPolicy::Nearest).unwrap();
        let mut all = Inserted::default();
        for row in &rows_of_scans {
            let ranges = row[6..].iter().enumerate().filter(|(_, range)| (0.05..10.0).contains(*range));
            found += ranges.clone().count();
            total_m += ranges.clone().map(|(_, range)| range).sum::<f64>();
            let Some(tilt) = servo_at(&servo, row[0]).map(|degrees| (degrees - HORIZONTAL).to_radians())
            else {
                continue;
            };
            let point = |(beam, range): (usize, &f64)| {
                let azimuth = row[2] + row[4] * beam as f64;
                let ahead = range * azimuth.cos();
                let (x, y, z) = (ahead * tilt.cos(), range * azimuth.sin(), HEIGHT - ahead * tilt.sin());
                Point3::new(x as f32, y as f32, z as f32)
            };
            let points: Vec<Point3> = ranges.map(point).collect();
            let stamp = Stamp::from_micros((row[1] * 1e6) as u64);
            let inserted = window.insert_points(&points, Pose2::default(), stamp).unwrap();
            assert!(usize::from(inserted.surfaces + inserted.outside) <= points.len());
            all.surfaces = all.surfaces.saturating_add(inserted.surfaces);
            entered += 1;
        }
        // The key counted before ranges were rounded to text: one of 10.00 m may be within or not.
        assert!(found.abs_diff(count) <= 1, "{name}: {found} ranges");
        assert!((total_m - sum_m).abs() < 11.0, "{name}: {total_m} m");
        // Angles are missing where none was sent for a while.
        assert!(entered * 10 > scans * 6, "{name}: {entered} of {scans} scans have an angle");
        // What is seen lies within the window.
        let surfaces: Vec<_> = window.points().collect();
        assert!(surfaces.len() > 1_000 && all.surfaces > 5_000, "{name}: {} cells", surfaces.len());
        assert!(surfaces.iter().all(|one| (0.0..=2.4).contains(&one.point.z_m)));
    }
}
