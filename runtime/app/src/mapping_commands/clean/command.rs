//! Runs the command.

use std::time::Instant;

use floorguard_host::outcome::{BadInput, WrongUsage};
use floorguard_host::words::counted;
use floorguard_mapping::people_removal::{FloorHeight, PointVerdict};
use floorguard_mapping_host::clean::{BoxIndex, CleanConfig, Cleaner, RawSweep, Thinned, Track};
use floorguard_mapping_host::metrics::{TimedPose, read_tum};

use super::super::files::text;
use super::super::progress::Progress;
use super::arguments::CleanArguments;
use super::capture::LidarCapture;
use super::people::boxes;
use super::result::{CleanSummary, prepare, write};

/// Times of poses below this are seconds since the first packet; a capture bears the time of day.
const ABSOLUTE_S: f64 = 1.0e8;

/// A capture with its poses.
struct Survey {
    capture: LidarCapture,
    track: Track,
}

/// Runs the command.
///
/// # Errors
/// Bad input, or a folder that cannot take the clouds.
pub fn run(arguments: &CleanArguments) -> anyhow::Result<()> {
    if !arguments.poses.is_empty() && arguments.poses.len() != arguments.files.len() {
        let (poses, files) = (arguments.poses.len(), arguments.files.len());
        return Err(WrongUsage(format!(
            "{poses} trajectories for {files} captures: give one for each, or none"
        ))
        .into());
    }
    prepare(&arguments.out)?;
    let surveys = surveys(arguments)?;
    let config = CleanConfig { voxel_m: arguments.voxel_m, ..surveys[0].capture.config() };
    let cleaner =
        Cleaner::new(&config).ok_or_else(|| WrongUsage("a voxel of this edge cannot be".to_owned()))?;
    let mut work = Work {
        cleaner,
        floor: None,
        boxes: BoxIndex::new(&[]),
        clean: Thinned::new(arguments.cube_m),
        removed: Thinned::new(arguments.cube_m),
        summary: CleanSummary::default(),
    };
    let all: u64 = surveys.iter().map(|survey| 2 * survey.capture.sweeps).sum();
    let progress = Progress::new(all);
    let outcome = work.clean(&surveys, arguments, &progress);
    progress.finish();
    outcome?;
    write(&arguments.out, &work.clean, &work.removed, &work.summary)?;
    report(arguments, &surveys, &work.summary)
}

fn surveys(arguments: &CleanArguments) -> anyhow::Result<Vec<Survey>> {
    let mut surveys = Vec::new();
    for (number, file) in arguments.files.iter().enumerate() {
        let capture = LidarCapture::open(file)?;
        let Some(path) = arguments.poses.get(number) else {
            surveys.push(Survey { capture, track: Track::standing() });
            continue;
        };
        let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
        let mut poses: Vec<TimedPose> = read_tum(&text(path)?).map_err(|error| bad(&error))?;
        let is_relative =
            poses.first().is_some_and(|pose| pose.time_s < ABSOLUTE_S) && capture.first_s >= ABSOLUTE_S;
        if is_relative {
            poses.iter_mut().for_each(|pose| pose.time_s += capture.first_s);
        }
        let track = Track::new(poses).map_err(|error| bad(&error))?;
        let [from_s, to_s] = track.span_s();
        if to_s < capture.first_s || from_s > capture.last_s {
            let (first_s, last_s) = (capture.first_s, capture.last_s);
            let what = format!(
                "its times, {from_s:.1} to {to_s:.1} s, are not those of the capture, {first_s:.1} to {last_s:.1} s"
            );
            return Err(bad(&what).into());
        }
        surveys.push(Survey { capture, track });
    }
    Ok(surveys)
}

struct Work {
    cleaner: Cleaner,
    floor: Option<FloorHeight>,
    boxes: BoxIndex,
    clean: Thinned,
    removed: Thinned,
    summary: CleanSummary,
}

impl Work {
    fn clean(
        &mut self,
        surveys: &[Survey],
        arguments: &CleanArguments,
        progress: &Progress,
    ) -> anyhow::Result<()> {
        let began = Instant::now();
        for survey in surveys {
            survey.capture.for_each(&mut |sweep| {
                progress.count();
                self.observe(sweep, &survey.track);
                Ok(())
            })?;
        }
        let sweeps = self.summary.sweeps.max(1) as f64;
        self.summary.observe_ms_per_sweep = 1.0e3 * began.elapsed().as_secs_f64() / sweeps;
        if self.cleaner.counts.observed == 0 {
            return Err(BadInput("no sweep has a pose: nothing to clean".to_owned()).into());
        }
        let floor_m = self.floor.as_ref().and_then(FloorHeight::floor_m);
        self.summary.floor_m =
            floor_m.ok_or_else(|| BadInput("no floor in any sweep: is the lidar level?".to_owned()))?;
        if let Some(path) = &arguments.people {
            self.boxes = BoxIndex::new(&boxes(path, self.summary.floor_m)?);
        }
        let began = Instant::now();
        for survey in surveys {
            survey.capture.for_each(&mut |sweep| {
                progress.count();
                self.judge(sweep, &survey.track);
                Ok(())
            })?;
        }
        self.summary.judge_ms_per_sweep = 1.0e3 * began.elapsed().as_secs_f64() / sweeps;
        self.summary.sweeps_without_floor = self.cleaner.counts.without_floor;
        self.summary.evidence_left_out = self.cleaner.space().counts().left_out;
        (self.summary.points_clean, self.summary.points_removed) =
            (self.clean.points().len(), self.removed.points().len());
        Ok(())
    }

    fn observe(&mut self, sweep: &RawSweep, track: &Track) {
        self.summary.sweeps += 1;
        if !self.cleaner.observe(sweep, track) {
            self.summary.sweeps_without_pose += 1;
            return;
        }
        let sensor_m = track.at(sweep.start_s).map_or(0.0, |pose| pose.translation.z_m);
        let heights = self.floor.get_or_insert_with(|| FloorHeight::below(sensor_m));
        self.cleaner.points_in_map().iter().for_each(|point| heights.enter(point.z_m));
    }

    fn judge(&mut self, sweep: &RawSweep, track: &Track) {
        let mut verdicts = Vec::new();
        if self.cleaner.judge(sweep, track, &mut verdicts).is_none() && track.at(sweep.start_s).is_none() {
            return;
        }
        for (point, verdict) in self.cleaner.points_in_map().iter().zip(&verdicts) {
            self.summary.returns += 1;
            if *verdict == PointVerdict::Moved {
                self.summary.returns_moved += 1;
                self.removed.enter(*point);
            } else if self.boxes.contains(*point) {
                self.summary.returns_in_boxes += 1;
                self.removed.enter(*point);
            } else {
                self.clean.enter(*point);
            }
        }
    }
}

fn report(arguments: &CleanArguments, surveys: &[Survey], summary: &CleanSummary) -> anyhow::Result<()> {
    if arguments.json {
        return Ok(tell!("{}", serde_json::to_string(summary)?)?);
    }
    let share = |part: u64| 100.0 * part as f64 / summary.returns.max(1) as f64;
    say!("cleaned: {} ({})", arguments.out.display(), surveys[0].capture.model_name());
    say!("  {} and {}", counted(summary.sweeps, "sweep"), counted(summary.returns, "return"));
    say!(
        "  removed: {} of what moved ({:.2} %)",
        counted(summary.returns_moved, "return"),
        share(summary.returns_moved)
    );
    if arguments.people.is_some() {
        say!("  and {} in boxes around people", counted(summary.returns_in_boxes, "return"));
    }
    if summary.sweeps_without_pose > 0 {
        say!(
            "  note: {} have no pose at their time and are in no cloud",
            counted(summary.sweeps_without_pose, "sweep")
        );
    }
    if summary.sweeps_without_floor > 0 {
        say!(
            "  note: no floor in {}; nothing of them was removed",
            counted(summary.sweeps_without_floor, "sweep")
        );
    }
    say!(
        "  clouds: {} stay, {} were removed",
        counted(summary.points_clean as u64, "point"),
        summary.points_removed
    );
    say!(
        "  took {:.1} + {:.1} ms a sweep, reading included",
        summary.observe_ms_per_sweep,
        summary.judge_ms_per_sweep
    );
    say!("  look at {} and after.png", arguments.out.join("before.png").display());
    Ok(())
}
