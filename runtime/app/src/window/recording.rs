//! Scans of a lidar that a servo tilts, as tables of numbers.

use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_mapping::sliding_window::LidarMount;
use floorguard_robot::actuated::WindowMap;
use floorguard_types::geometry::Point3;
use floorguard_types::time::Stamp;

use super::arguments::WindowArguments;
use crate::files::text;

/// An angle belongs to a scan if it was received at most so long before or after it, seconds.
const GAP_S: f64 = 0.3;
/// Ranges that count, metres.
const RANGES_M: std::ops::Range<f64> = 0.05..10.0;
/// Columns before the ranges.
const HEAD: usize = 6;

/// What a recording held.
#[derive(Clone, Copy, Debug, Default)]
pub struct Recorded {
    /// Rows of scans.
    pub scans: u64,
    /// Ranges from 0.05 m to 10 m, and their sum in metres.
    pub ranges: u64,
    pub sum_m: f64,
}

fn rows(path: &Path, least: usize) -> Result<Vec<Vec<f64>>, BadInput> {
    let text = text(path)?;
    let bad = |line: usize, what: &str| BadInput(format!("{}: line {}: {what}", path.display(), line + 1));
    let mut rows = Vec::new();
    for (line, content) in text.lines().enumerate().skip(1).filter(|(_, content)| !content.is_empty()) {
        let cells = content.split(',').map(str::trim).map(str::parse::<f64>);
        let row = cells.collect::<Result<Vec<f64>, _>>().map_err(|_| bad(line, "not a number"))?;
        if row.len() < least {
            return Err(bad(line, &format!("{} numbers, at least {least} are needed", row.len())));
        }
        rows.push(row);
    }
    if rows.is_empty() {
        return Err(BadInput(format!("{}: no row of numbers in it", path.display())));
    }
    Ok(rows)
}

/// The servo's angle at a time in nanoseconds, interpolated.
fn servo_at(servo: &[Vec<f64>], time_ns: f64) -> Option<f64> {
    let after = servo.partition_point(|row| row[0] < time_ns);
    let (before, after) = (servo.get(after.checked_sub(1)?)?, servo.get(after)?);
    let is_near = time_ns - before[0] <= GAP_S * 1e9 && after[0] - time_ns <= GAP_S * 1e9;
    let part = (time_ns - before[0]) / (after[0] - before[0]).max(1.0);
    is_near.then(|| before[1] + part * (after[1] - before[1]))
}

/// Reads both tables and enters all scans that have an angle.
///
/// # Errors
/// A file that cannot be read, or holds something else.
pub fn play(
    arguments: &WindowArguments,
    (scans, servo): (&Path, &Path),
) -> Result<(WindowMap, Recorded), BadInput> {
    // A scan without any range is a row, too.
    let (scans, servo) = (rows(scans, HEAD)?, rows(servo, 2)?);
    let mut map = WindowMap::new(&arguments.setup(LidarMount::PUBLISHED))?;
    let mut recorded = Recorded::default();
    let mut newest = Stamp::ZERO;
    for row in &scans {
        recorded.scans += 1;
        let ranges = row[HEAD..].iter().enumerate().filter(|(_, range)| RANGES_M.contains(*range));
        recorded.ranges += ranges.clone().count() as u64;
        recorded.sum_m += ranges.clone().map(|(_, range)| range).sum::<f64>();
        let stamp = Stamp::from_micros((row[1].max(0.0) * 1e6) as u64);
        let Some(degrees) = servo_at(&servo, row[0]) else {
            map.taken.refuse("angle_missing", "no angle of the servo within 0.3 s of a scan".to_owned());
            continue;
        };
        if stamp <= newest {
            map.taken.refuse("out_of_order", "a scan is not newer than the one before".to_owned());
            continue;
        }
        newest = stamp;
        let tilt = (degrees - arguments.level_deg).to_radians();
        let point = |(beam, range): (usize, &f64)| {
            let azimuth = row[2] + row[4] * beam as f64;
            let ahead = range * azimuth.cos();
            let (x, y, z) =
                (ahead * tilt.cos(), range * azimuth.sin(), arguments.height_m - ahead * tilt.sin());
            Point3::new(x as f32, y as f32, z as f32)
        };
        let points: Vec<Point3> = ranges.map(point).collect();
        map.insert_points(&points, stamp);
    }
    Ok((map, recorded))
}
