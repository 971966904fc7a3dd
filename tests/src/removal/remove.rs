//! Removers on labelled drives: each sees the same sweeps and poses, and the same judge counts.

use floorguard_mapping::people_removal::PointVerdict;
use floorguard_mapping_host::clean::{CleanConfig, Cleaner, Thinned, Track};
use floorguard_types::geometry::Point3;

use super::erasor::Erasor;
use super::octomap::OctoMap;
use super::score::Score;
use super::sim3d::LabelledSweep;
use crate::bench::took;

/// Surveys whose sweeps can be asked for again and again.
pub trait Surveys {
    /// Calls `each` for every sweep, with the track of its survey.
    ///
    /// # Errors
    /// A file of sweeps is damaged.
    fn for_each(&self, each: &mut dyn FnMut(&LabelledSweep, &Track)) -> anyhow::Result<()>;
}

/// How a remover did.
pub struct Outcome {
    /// By the labels.
    pub score: Score,
    /// Time of the processor for both passes, a sweep.
    pub ms_per_sweep: f64,
    /// What stays, for pictures.
    pub kept: Thinned,
    /// What was removed.
    pub removed: Thinned,
}

/// Cubes of the clouds of pictures, metres.
const CUBE_M: f32 = 0.05;
/// OctoMap uses only every fifth sweep: one sweep takes it a fifth of a second.
const REFERENCE_EVERY: u64 = 5;

/// Seconds that the work took this thread's processor: other programs do not count.
fn cpu_s(work: impl FnMut()) -> f64 {
    1.0e-9 * took(work).cpu_ns
}

/// Our remover, two passes.
///
/// # Errors
/// The sweeps cannot be read.
///
/// # Panics
/// Never: the edge of the voxels is a valid one.
pub fn ours(surveys: &dyn Surveys) -> anyhow::Result<Outcome> {
    let mut cleaner = Cleaner::new(&CleanConfig::vlp16()).expect("voxels of 0.1 m");
    let (mut took_s, mut sweeps) = (0.0, 0_u64);
    surveys.for_each(&mut |labelled, track| {
        took_s += cpu_s(|| {
            cleaner.observe(&labelled.sweep, track);
        });
        sweeps += 1;
    })?;
    let (mut score, mut verdicts) = (Score::default(), Vec::new());
    let (mut kept, mut removed) = (Thinned::new(CUBE_M), Thinned::new(CUBE_M));
    surveys.for_each(&mut |labelled, track| {
        took_s += cpu_s(|| {
            let _ = cleaner.judge(&labelled.sweep, track, &mut verdicts);
        });
        for ((verdict, label), point) in verdicts.iter().zip(&labelled.labels).zip(cleaner.points_in_map()) {
            let is_removed = *verdict == PointVerdict::Moved;
            score.enter(*label > 0, is_removed);
            if is_removed { removed.enter(*point) } else { kept.enter(*point) }
        }
    })?;
    Ok(Outcome { score, ms_per_sweep: 1.0e3 * took_s / sweeps.max(1) as f64, kept, removed })
}

/// The plain reference; the floor is kept by its height, as the benchmark's variant with a ground filter does.
///
/// # Errors
/// The sweeps cannot be read.
pub fn octomap(surveys: &dyn Surveys) -> anyhow::Result<Outcome> {
    let mut map = OctoMap::new(0.1);
    let (mut took_s, mut sweeps, mut placed) = (0.0, 0_u64, Vec::new());
    surveys.for_each(&mut |labelled, track| {
        sweeps += 1;
        if sweeps % REFERENCE_EVERY != 0 {
            return;
        }
        let Some(sensor) = place(labelled, track, &mut placed) else { return };
        took_s += cpu_s(|| map.enter(sensor, &placed));
    })?;
    let scored = scored(surveys, &|point| point.z_m > 0.1 && !map.is_occupied(point))?;
    let cast = (sweeps / REFERENCE_EVERY).max(1);
    Ok(Outcome { ms_per_sweep: 1.0e3 * took_s / cast as f64, ..scored })
}

/// What a reference makes of all points, whose time was taken before.
fn scored(surveys: &dyn Surveys, is_removed: &dyn Fn(Point3) -> bool) -> anyhow::Result<Outcome> {
    let (mut score, mut placed) = (Score::default(), Vec::new());
    let (mut kept, mut removed) = (Thinned::new(CUBE_M), Thinned::new(CUBE_M));
    surveys.for_each(&mut |labelled, track| {
        if place(labelled, track, &mut placed).is_none() {
            return;
        }
        for (point, label) in placed.iter().zip(&labelled.labels) {
            let is_removed = is_removed(*point);
            score.enter(*label > 0, is_removed);
            if is_removed { removed.enter(*point) } else { kept.enter(*point) }
        }
    })?;
    Ok(Outcome { score, ms_per_sweep: 0.0, kept, removed })
}

/// The second plain reference, by heights in polar bins; every fifth sweep is compared, as for the other.
///
/// # Errors
/// The sweeps cannot be read.
pub fn erasor(surveys: &dyn Surveys) -> anyhow::Result<Outcome> {
    let mut map = Erasor::default();
    let (mut took_s, mut sweeps, mut placed) = (0.0, 0_u64, Vec::new());
    surveys.for_each(&mut |labelled, track| {
        if place(labelled, track, &mut placed).is_some() {
            took_s += cpu_s(|| map.enter(&placed));
        }
    })?;
    surveys.for_each(&mut |labelled, track| {
        sweeps += 1;
        if sweeps % REFERENCE_EVERY != 0 {
            return;
        }
        let Some(sensor) = place(labelled, track, &mut placed) else { return };
        took_s += cpu_s(|| map.compare(sensor, &placed));
    })?;
    let scored = scored(surveys, &|point| !map.stays(point))?;
    let compared = (sweeps / REFERENCE_EVERY).max(1);
    Ok(Outcome { ms_per_sweep: 1.0e3 * took_s / compared as f64, ..scored })
}

/// Puts the returns into the map, each by the pose at its own time; the pose in the middle of the sweep is the sensor's.
fn place(labelled: &LabelledSweep, track: &Track, placed: &mut Vec<Point3>) -> Option<Point3> {
    let sweep = &labelled.sweep;
    placed.clear();
    let mut pose = track.at(sweep.start_s)?;
    let mut pose_s = sweep.start_s;
    for each in &sweep.returns {
        let time_s = sweep.start_s + f64::from(each.offset_s);
        if time_s > pose_s + 1.0e-3 {
            (pose, pose_s) = (track.at(time_s)?, time_s);
        }
        placed.push(pose.transform(each.point_in_sensor));
    }
    Some(track.at(sweep.start_s + 0.5 * sweep.duration_s())?.translation)
}
