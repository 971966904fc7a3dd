//! The recorded bytes of an S300's line through the robot's stages, in the scanner's frame.

use std::fs::File;
use std::io::Read as _;

use floorguard_drivers::s300::{Configuration, Event, Receiver};
use floorguard_host::packing::unpacked;
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::recorded::Recorded;
use super::rows::print;
use super::stages::RobotStages;
use super::summary::Summary;
use crate::recordings::arguments::ReplayArguments;
use floorguard_host::outcome::BadInput;

/// From scan to scan (book, SICK S300: Line): the bytes have no times of their own, the scans are numbered.
const SCAN_US: u64 = 40_000;
/// Of 500 kBd: 64 bytes.
const PIECE_US: u64 = 1_280;

/// Runs the command on the bytes of a line.
///
/// # Errors
/// Bad input.
pub fn run(arguments: &ReplayArguments) -> anyhow::Result<()> {
    let bad = |error: std::io::Error| BadInput(format!("{}: {error}", arguments.file.display()));
    let mut bytes = Vec::new();
    File::open(&arguments.file)
        .and_then(unpacked)
        .and_then(|mut source| source.read_to_end(&mut bytes))
        .map_err(bad)?;
    let mut receiver = Box::new(Receiver::new(Configuration::default()));
    let mut recorded = Recorded::open(&arguments.file, arguments.record.as_deref())?;
    let (mut stages, mut summary) = (RobotStages::new()?.for_s300(), Summary::new());
    let (mut refusal, mut printed, mut first) = (None, Ok(()), None);
    for (piece, arrival_us) in bytes.chunks(64).zip((1_000_000..).step_by(PIECE_US as usize)) {
        receiver.push(piece, Stamp::from_micros(arrival_us), |event| match event {
            Event::Scan(scan) => {
                let number = u64::from(scan.sequence);
                let mut scan = scan.clone();
                scan.stamp =
                    Stamp::from_micros(number.saturating_sub(*first.get_or_insert(number)) * SCAN_US);
                let row = stages.scan("S300", &scan, (Pose2::default(), None));
                summary.frame(&row);
                recorded.scan(&scan, Pose2::default(), row.everybody());
                if arguments.json && printed.is_ok() {
                    printed = print(&row);
                }
            }
            Event::StandBy { .. } => {}
            Event::Refused(error) => refusal = Some(error),
        });
    }
    printed?;
    let counters = receiver.counters();
    if let Some(error) = refusal {
        say!("telegrams that are right and of no use, the last: {error}");
    }
    say!("{} telegrams, {} scans missing", counters.telegrams, counters.lost_scans);
    say!("{}", summary.line("scan"));
    summary.say_standing("scan");
    stages.say_times();
    recorded.finish()
}
