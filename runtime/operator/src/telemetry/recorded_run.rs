//! What a recording says of its run, and its file.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_recording::{Compression, Recorder, RunInfo, RunRecorder};
use floorguard_robot::cleaner::MissionPlan;
use floorguard_robot::learning::LearningSetup;
use floorguard_robot::navigator::NavigationPlan;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::tape::TapeLine;

use super::tape::encode_route;

/// Bytes on their way to the disk.
const BUFFER_BYTES: usize = 1 << 20;

/// The threads of a robot in real time are not scheduled the same way twice.
pub const IN_REAL_TIME: &str = "no: it ran in real time";

/// Name of the text that says when a run in real time began, RFC 3339.
pub const RECORDED_AT: &str = "recorded_at";

/// What a recording says of the run that it holds.
#[derive(Clone, Copy, Debug)]
pub struct RecordedRun<'a> {
    /// The robot.
    pub robot: &'a RobotConfiguration,
    /// Its file.
    pub robot_toml: &'a str,
    /// Bit rate of its inertial sensor.
    pub imu_baud: u32,
    /// Its cleaning mission, if it has one.
    pub mission: Option<&'a MissionPlan>,
    /// Its drive to a goal, if it has one.
    pub navigation: Option<&'a NavigationPlan>,
    /// How it learns, if it does.
    pub learning: Option<&'a LearningSetup>,
}

/// A recording on its way into a file.
pub type FileRecorder = RunRecorder<BufWriter<File>>;

pub(super) fn open_recording(
    (path, compression): (&Path, Compression),
    info: &RunInfo<'_>,
) -> anyhow::Result<FileRecorder> {
    let unwritable = |error: &dyn std::fmt::Display| {
        BadInput(format!("{}: cannot be written ({error}); give another place", path.display()))
    };
    let file = File::create(path).map_err(|error| unwritable(&error))?;
    let packed = Recorder::packed(BufWriter::with_capacity(BUFFER_BYTES, file), compression);
    let mut recorder =
        packed.and_then(|packed| RunRecorder::over(packed, info)).map_err(|error| unwritable(&error))?;
    recorder.delivered((0, 0), TapeLine::Route, &encode_route(info.robot));
    Ok(recorder)
}
