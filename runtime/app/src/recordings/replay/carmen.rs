//! A CARMEN log: legs and people out of its scans, in the frame of its odometry.

use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::recorded::Recorded;
use super::rows::print;
use super::scans::{ScanPlayer, ScanRow, to_scan};
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
    let mut player = ScanPlayer::new();
    let mut recorded = Recorded::open(&arguments.file, arguments.record.as_deref())?;
    let mut summary = Summary::new();
    let mut ended = None;
    let mut standing = 0_u64;
    for line in CarmenLog::open(&arguments.file).map_err(|error| bad(&error))? {
        match line {
            Ok(CarmenLine::Laser(scan)) => {
                let row = play(&mut player, &scan, &mut recorded);
                summary.legs += row.legs() as u64;
                summary.people(row.people());
                standing += u64::from(!row.is_newer());
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
    if standing > 0 && standing + 1 == summary.frames {
        say!(
            "all {} scans bear one time: speeds, who stands and who walks cannot be known from this log",
            summary.frames
        );
    } else if standing > 0 {
        say!("{standing} of {} scans are not later than the one before them", summary.frames);
    }
    recorded.finish()?;
    ended.map_or(Ok(()), |error| Err(error.into()))
}

fn play(player: &mut ScanPlayer, line: &LaserLine, recorded: &mut Recorded) -> ScanRow {
    let micros = (line.time_s.max(0.0) * 1.0e6) as u64;
    let angles = (line.first_angle_rad, line.step_rad);
    let scan = to_scan(Stamp::from_micros(micros), angles, &line.ranges_m, [0.0, line.range_max_m]);
    let (laser, frame) = line.laser_in_odom.map_or((Pose2::default(), "sensor"), |laser| (laser, "odom"));
    let row = player.scan(&scan, (laser, frame));
    recorded.scan(&scan, laser, row.everybody());
    row
}
