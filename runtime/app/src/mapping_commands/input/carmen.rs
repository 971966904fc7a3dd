//! Scans of a CARMEN log.

use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::input::ScanRecord;
use floorguard_recording::carmen::{CarmenLine, CarmenLog, LaserLine};

use super::drive::Sink;

/// Hands over every scan; answers why the log ended early, if it did.
///
/// # Errors
/// The log cannot be opened, or the sink's own.
pub fn read(path: &Path, sink: &mut Sink<'_>) -> anyhow::Result<Option<String>> {
    for line in CarmenLog::open(path).map_err(|error| BadInput(error.to_string()))? {
        match line {
            Ok(CarmenLine::Laser(scan)) => sink(record(scan))?,
            Ok(_) => {}
            Err(error) => return Ok(Some(error.to_string())),
        }
    }
    Ok(None)
}

fn record(mut scan: LaserLine) -> ScanRecord {
    for range in &mut scan.ranges_m {
        if *range >= scan.range_max_m {
            *range = f32::INFINITY;
        }
    }
    ScanRecord {
        time_s: scan.time_s,
        odometry: scan.laser_in_odom.map(Se2::from),
        first_angle_rad: scan.first_angle_rad,
        step_rad: scan.step_rad,
        ranges_m: scan.ranges_m,
        ..ScanRecord::default()
    }
}
