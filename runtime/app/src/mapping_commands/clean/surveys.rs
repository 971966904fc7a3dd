//! Recordings with the track of their lidar: given, found by the sweeps themselves, or standing still.

use std::path::Path;
use std::sync::Arc;

use floorguard_host::outcome::{BadInput, WrongUsage};
use floorguard_mapping_host::clean::{SweepTracker, Track};
use floorguard_mapping_host::metrics::{TimedPose, read_tum};

use super::super::progress::Progress;
use super::arguments::CleanArguments;
use super::input::SweepFile;
use crate::files::text;

/// Times of poses below this are seconds since the first packet; a capture bears the time of day.
pub const ABSOLUTE_S: f64 = 1.0e8;
/// More sweeps than this share without a match, and the track is in doubt.
const BLIND_SHARE_MAX: f64 = 0.02;

/// A recording with its poses.
pub struct Survey {
    /// The sweeps.
    pub file: SweepFile,
    /// Where the lidar was.
    pub track: Arc<Track>,
}

/// All surveys of a command.
///
/// # Errors
/// Bad input, or poses that are not those of the recordings.
pub fn open(arguments: &CleanArguments) -> anyhow::Result<Vec<Survey>> {
    if !arguments.poses.is_empty() && arguments.poses.len() != arguments.files.len() {
        let (poses, files) = (arguments.poses.len(), arguments.files.len());
        let what = format!("{poses} trajectories for {files} captures: give one for each, or none");
        return Err(WrongUsage(what).into());
    }
    let files = arguments.files.iter().map(|file| SweepFile::open(file)).collect::<Result<Vec<_>, _>>()?;
    if arguments.map_first {
        return mapped(files, arguments.level_floor);
    }
    let mut surveys = Vec::new();
    for (number, file) in files.into_iter().enumerate() {
        let track = match arguments.poses.get(number) {
            Some(path) => given(path, &file)?,
            None => Track::standing(),
        };
        surveys.push(Survey { file, track: Arc::new(track) });
    }
    Ok(surveys)
}

fn given(path: &Path, file: &SweepFile) -> anyhow::Result<Track> {
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
    let mut poses: Vec<TimedPose> = read_tum(&text(path)?).map_err(|error| bad(&error))?;
    let is_relative =
        poses.first().is_some_and(|pose| pose.time_s < ABSOLUTE_S) && file.first_s >= ABSOLUTE_S;
    if is_relative {
        poses.iter_mut().for_each(|pose| pose.time_s += file.first_s);
    }
    let track = Track::new(poses).map_err(|error| bad(&error))?;
    let [from_s, to_s] = track.span_s();
    if to_s < file.first_s || from_s > file.last_s {
        let (first_s, last_s) = (file.first_s, file.last_s);
        let what = format!(
            "its times, {from_s:.1} to {to_s:.1} s, are not those of the capture, {first_s:.1} to {last_s:.1} s"
        );
        return Err(bad(&what).into());
    }
    Ok(track)
}

/// One track through all files.
fn mapped(files: Vec<SweepFile>, level_floor: bool) -> anyhow::Result<Vec<Survey>> {
    let progress = Progress::new(files.iter().map(|file| file.sweeps).sum());
    let mut tracker = SweepTracker::new(level_floor);
    for file in &files {
        file.for_each(&mut |sweep| {
            progress.count();
            tracker.push(sweep);
            Ok(())
        })?;
    }
    progress.finish();
    let counters = tracker.counters();
    if counters.not_later > 1 {
        let what =
            "sweeps are not later than the ones before: the files are no parts of one drive in their order";
        return Err(BadInput(format!("{} {what}", counters.not_later)).into());
    }
    if counters.blind as f64 > BLIND_SHARE_MAX * counters.sweeps as f64 {
        let what = "sweeps hardly fit what was seen before: look at the result with care";
        say!("note: {} of {} {what}", counters.blind, counters.sweeps);
    }
    let track = Arc::new(tracker.finish().map_err(|error| BadInput(error.to_string()))?);
    Ok(files.into_iter().map(|file| Survey { file, track: track.clone() }).collect())
}
