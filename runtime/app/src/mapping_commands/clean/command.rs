//! Runs the command.

use std::time::Instant;

use floorguard_host::outcome::{BadInput, WrongUsage};
use floorguard_mapping::people_removal::{FloorHeight, PointVerdict, PositionMethod, Sighting};
use floorguard_mapping_host::clean::{
    CleanConfig, Cleaner, PeopleInImages, PersonBoxes, RawSweep, Thinned, Track,
};

use super::super::progress::Progress;
use super::arguments::{BoxMethod, CleanArguments};
use super::boxes_file::read_boxes;
use super::people::boxes;
use super::report::report;
use super::result::{CleanSummary, Cleaned, prepare, write};
use super::surveys::{ABSOLUTE_S, Survey, open};
use crate::cameras::CameraFile;

/// Runs the command.
///
/// # Errors
/// Bad input, or a folder that cannot take the clouds.
pub fn run(arguments: &CleanArguments) -> anyhow::Result<()> {
    prepare(&arguments.out)?;
    let surveys = open(arguments)?;
    let config = CleanConfig { voxel_m: arguments.voxel_m, ..surveys[0].file.config() };
    let cleaner =
        Cleaner::new(&config).ok_or_else(|| WrongUsage("a voxel of this edge cannot be".to_owned()))?;
    let mut work = Work {
        cleaner,
        floor: None,
        images: images(arguments, &surveys)?,
        boxes: Vec::new(),
        clean: Thinned::new(arguments.cube_m),
        removed: Thinned::new(arguments.cube_m),
        summary: CleanSummary::default(),
    };
    let all: u64 = surveys.iter().map(|survey| 2 * survey.file.sweeps).sum();
    let progress = Progress::new(all);
    let outcome = work.clean(&surveys, arguments, &progress);
    progress.finish();
    outcome?;
    let sightings: Vec<Sighting> =
        work.images.iter().flat_map(|images| images.sightings().entries()).copied().collect();
    let cleaned = Cleaned {
        clean: work.clean.points(),
        removed: work.removed.points(),
        sightings: &sightings,
        track: arguments.map_first.then(|| surveys[0].track.poses()),
    };
    write(&arguments.out, &cleaned, &mut work.summary)?;
    report(arguments, surveys[0].file.name(), &work.summary)
}

/// Boxes of pictures with their camera, for each survey: who stood somewhere in one survey may be gone in the next.
fn images(arguments: &CleanArguments, surveys: &[Survey]) -> anyhow::Result<Vec<PeopleInImages>> {
    let (Some(path), Some(camera)) = (&arguments.boxes, &arguments.camera) else { return Ok(Vec::new()) };
    let camera = CameraFile::read(camera)?.mounted(camera)?;
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
    let mut images = read_boxes(path)?;
    let first_s = surveys[0].file.first_s;
    let is_relative = images.first().is_some_and(|image| image.stamp_s < ABSOLUTE_S) && first_s >= ABSOLUTE_S;
    if is_relative {
        images.iter_mut().for_each(|image| image.stamp_s += first_s);
    }
    let method = match arguments.box_method {
        BoxMethod::Depth => PositionMethod::DepthMode,
        BoxMethod::Nearest => PositionMethod::NearestToMiddle,
    };
    let collect =
        |_: &Survey| PeopleInImages::new(camera, images.clone(), method).map_err(|error| bad(&error));
    Ok(surveys.iter().map(collect).collect::<Result<Vec<_>, _>>()?)
}

struct Work {
    cleaner: Cleaner,
    floor: Option<FloorHeight>,
    /// For each survey; none without pictures.
    images: Vec<PeopleInImages>,
    /// For each survey.
    boxes: Vec<PersonBoxes>,
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
        for (number, survey) in surveys.iter().enumerate() {
            survey.file.for_each(&mut |sweep| {
                progress.count();
                self.observe(number, sweep, &survey.track);
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
        self.boxes = self.removal_boxes(arguments, surveys.len())?;
        let began = Instant::now();
        for (number, survey) in surveys.iter().enumerate() {
            survey.file.for_each(&mut |sweep| {
                progress.count();
                self.judge(number, sweep, &survey.track);
                Ok(())
            })?;
        }
        self.summary.judge_ms_per_sweep = 1.0e3 * began.elapsed().as_secs_f64() / sweeps;
        self.summary.sweeps_without_floor = self.cleaner.counts.without_floor;
        self.summary.evidence_left_out = self.cleaner.space().counts().left_out;
        Ok(())
    }

    /// For each survey, around places of a file and around people in its pictures.
    fn removal_boxes(
        &mut self,
        arguments: &CleanArguments,
        surveys: usize,
    ) -> anyhow::Result<Vec<PersonBoxes>> {
        let floor_m = self.summary.floor_m;
        let given = match &arguments.people {
            Some(path) => boxes(path, floor_m)?,
            None => Vec::new(),
        };
        self.summary.enter_images(&self.images);
        if !self.images.is_empty() && self.summary.pictures_used == 0 {
            let what = format!(
                "none of the {} pictures lies within 50 ms of a sweep with a pose: are the clocks the same?",
                self.summary.pictures_unused
            );
            return Err(BadInput(what).into());
        }
        let of_survey = |number: usize| {
            let seen = self.images.get(number).map_or(&[][..], |images| images.sightings().entries());
            PersonBoxes::new(seen, &given, floor_m, self.cleaner.space())
        };
        Ok((0..surveys).map(of_survey).collect())
    }

    fn observe(&mut self, survey: usize, sweep: &RawSweep, track: &Track) {
        self.summary.sweeps += 1;
        if !self.cleaner.observe(sweep, track) {
            self.summary.sweeps_without_pose += 1;
            return;
        }
        let sensor_m = track.at(sweep.start_s).map_or(0.0, |pose| pose.translation.z_m);
        let heights = self.floor.get_or_insert_with(|| FloorHeight::below(sensor_m));
        let points_in_map = self.cleaner.points_in_map();
        points_in_map.iter().for_each(|point| heights.enter(point.z_m));
        if let Some(images) = self.images.get_mut(survey) {
            images.enter(sweep.start_s + 0.5 * sweep.duration_s(), points_in_map, track);
        }
    }

    fn judge(&mut self, survey: usize, sweep: &RawSweep, track: &Track) {
        let mut verdicts = Vec::new();
        if self.cleaner.judge(sweep, track, &mut verdicts).is_none() && track.at(sweep.start_s).is_none() {
            return;
        }
        let boxes = self.boxes[survey].of_sweep(sweep.start_s + 0.5 * sweep.duration_s());
        for (point, verdict) in self.cleaner.points_in_map().iter().zip(&verdicts) {
            self.summary.returns += 1;
            if *verdict == PointVerdict::Moved {
                self.summary.returns_moved += 1;
                self.removed.enter(*point);
            } else if boxes.contains(*point) {
                self.summary.returns_in_boxes += 1;
                self.removed.enter(*point);
            } else {
                self.clean.enter(*point);
            }
        }
    }
}
