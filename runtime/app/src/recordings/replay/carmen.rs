//! A CARMEN log through the robot's stages: legs and people out of its scans, in the frame of its odometry.

use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::recorded::Recorded;
use super::rows::{FrameRow, print};
use super::scans::to_scan;
use super::stages::RobotStages;
use super::summary::Summary;
use crate::recordings::arguments::ReplayArguments;
use floorguard_host::outcome::BadInput;
use floorguard_recording::carmen::{CarmenLine, CarmenLog, LaserLine};

/// Runs the command on a log.
///
/// # Errors
/// Bad input; every scan before it has been processed and printed.
pub fn run(arguments: &ReplayArguments) -> anyhow::Result<()> {
    let bad = |error: &dyn std::fmt::Display| BadInput(error.to_string());
    let name = arguments.file.display();
    let mut stages = RobotStages::new()?;
    let mut recorded = Recorded::open(&arguments.file, arguments.record.as_deref())?;
    let mut summary = Summary::new();
    let mut ended = None;
    for line in CarmenLog::open(&arguments.file).map_err(|error| bad(&error))? {
        match line {
            Ok(CarmenLine::Laser(scan)) => {
                let row = play(&mut stages, &scan, &mut recorded);
                summary.frame(&row);
                if arguments.json {
                    print(&row)?;
                }
            }
            Ok(_) => {}
            Err(error) => ended = Some(bad(&error)),
        }
    }
    if summary.frames == 0 && ended.is_none() {
        return Err(BadInput(format!(
            "{name}: no scan in it; a CARMEN log has lines FLASER, ROBOTLASER1 or RAWLASER1"
        ))
        .into());
    }
    say!("{}", summary.line("scan"));
    summary.say_standing("scan");
    stages.say_times();
    recorded.finish()?;
    ended.map_or(Ok(()), |error| Err(error.into()))
}

fn play(stages: &mut RobotStages, line: &LaserLine, recorded: &mut Recorded) -> FrameRow {
    let micros = (line.time_s.max(0.0) * 1.0e6) as u64;
    let angles = (line.first_angle_rad, line.step_rad);
    let scan = to_scan(Stamp::from_micros(micros), angles, &line.ranges_m, [0.0, line.range_max_m]);
    // The log tells where the laser was; what carries it does not matter.
    let row = stages.scan("the laser", &scan, (Pose2::default(), line.laser_in_odom));
    recorded.scan(&scan, line.laser_in_odom.unwrap_or_default(), row.everybody());
    row
}
