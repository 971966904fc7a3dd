//! `cargo xtask reproduce people-removal`: tables and pictures.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use floorguard_mapping::people_removal::{RemovalBox, RemovalSize};
use floorguard_mapping_host::clean::{BoxIndex, SweepTracker, Track};
use floorguard_mapping_host::output::{TopView, cloud_ply, draw_top_view};
use floorguard_types::geometry::Point3;

use super::chance::Chance;
use super::remove::{Outcome, Surveys, erasor, octomap, ours};
use super::sim3d::{LabelledSweep, SimulatedDrive, simulate};
use super::twice::Twice;
use crate::data::recording;

/// Seed of the buildings.
const SEED: u64 = 20_261_123;
/// Static returns that must stay on the simulated floor plan, and people's returns that must go.
const PLAN_GOALS: [f64; 2] = [0.998, 0.98];
/// The same in every building.
const BUILDING_GOALS: [f64; 2] = [0.995, 0.98];
/// Time of both passes, a sweep.
const PLAN_MS: f64 = 5.0;
/// What others reached: method, data, static and dynamic accuracy in per cent, milliseconds a sweep.
const PUBLISHED: &str = "| DUFOMap 1.1.1, run by us | fr101, 4 walkers | 99.99 | 93.5 | 96.6 | 27 |\n\
    | Removert, as published | semi-indoor, VLP-16 | 99.96 | 12.2 | 21.7 | – |\n\
    | ERASOR, as published | semi-indoor, VLP-16 | 94.9 | 66.3 | 78.1 | – |\n\
    | OctoMap with ground filter, as published | semi-indoor, VLP-16 | 96.8 | 73.5 | 83.6 | – |\n";

/// The simulated floor plan as a survey.
struct Plan<'a> {
    drive: &'a SimulatedDrive,
    track: &'a Track,
}

impl Surveys for Plan<'_> {
    fn for_each(&self, each: &mut dyn FnMut(&LabelledSweep, &Track)) -> anyhow::Result<()> {
        self.drive.for_each(usize::MAX, |labelled| each(labelled, self.track))
    }
}

/// Runs the experiment with so many random buildings, prints the table and writes it, pictures and clouds into `folder`. True
/// if all goals are met; the floor plan is left out with a line where its data are absent.
///
/// # Errors
/// A file that cannot be read or written, or no C++ compiler for the simulator beside the project.
pub fn people_removal(trials: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let mut table = String::from(
        "| remover | data | static kept, % | people removed, % | harmonic mean | ms a sweep |\n|---|---|---|---|---|---|\n",
    );
    table += PUBLISHED;
    let mut holds = true;
    if let Some(data) = recording("sim3d") {
        holds &= plan(&data, folder, &mut table)?;
    }
    holds &= buildings(trials, folder, &mut table)?;
    holds &= boxes(&mut table);
    println!("{table}");
    std::fs::write(folder.join("people-removal.md"), &table)?;
    Ok((table, holds))
}

fn plan(data: &Path, folder: &Path, table: &mut String) -> anyhow::Result<bool> {
    let drive = simulate(data, "fr101", 4, &folder.join("sim3d"))?;
    let clean = ours(&Plan { drive: &drive, track: &drive.track })?;
    row(table, ["ours", "fr101, 4 walkers"], &clean);
    pictures(folder, "fr101", &clean)?;
    let disturbed = drive.disturbed_track(0.01, 0.1_f64.to_radians())?;
    let rough = ours(&Plan { drive: &drive, track: &disturbed })?;
    row(table, ["ours, poses off by 1 cm and 0.1°", "fr101, 4 walkers"], &rough);
    let mapped = own_track(&drive)?;
    let by_own_poses = ours(&Plan { drive: &drive, track: &mapped })?;
    row(table, ["ours, poses of `map3d`", "fr101, 4 walkers"], &by_own_poses);
    let true_poses = Plan { drive: &drive, track: &drive.track };
    let references = [octomap(&true_poses)?, erasor(&true_poses)?];
    for (name, reference) in ["OctoMap, written plainly", "ERASOR, written plainly"].iter().zip(&references) {
        row(table, [name, "fr101, 4 walkers"], reference);
    }
    let is_faster = clean.ms_per_sweep <= PLAN_MS && by_own_poses.ms_per_sweep <= PLAN_MS;
    let is_best = |ours: &Outcome| {
        references.iter().all(|other| ours.score.harmonic_mean() > other.score.harmonic_mean())
    };
    Ok(meets(&clean, PLAN_GOALS)
        && meets(&by_own_poses, PLAN_GOALS)
        && is_faster
        && is_best(&clean)
        && is_best(&by_own_poses))
}

/// The track by the sweeps alone; its map begins where the drive does.
fn own_track(drive: &SimulatedDrive) -> anyhow::Result<Track> {
    let mut tracker = SweepTracker::new(false);
    drive.for_each(usize::MAX, |labelled| tracker.push(&labelled.sweep))?;
    Ok(tracker.finish()?)
}

fn buildings(trials: u64, folder: &Path, table: &mut String) -> anyhow::Result<bool> {
    let mut holds = true;
    let named = [("office, 1 person", 1, 1), ("conference room and corridor, 3 people", 2, 3)];
    for (number, (name, rooms, count)) in named.into_iter().enumerate() {
        let surveys = Twice::new(SEED + number as u64, rooms, count);
        let clean = ours(&surveys)?;
        row(table, ["ours", name], &clean);
        row(table, ["OctoMap, written plainly", name], &octomap(&surveys)?);
        row(table, ["ERASOR, written plainly", name], &erasor(&surveys)?);
        pictures(folder, if number == 0 { "office" } else { "conference" }, &clean)?;
        holds &= meets(&clean, BUILDING_GOALS);
    }
    let left = ours(&Twice::left_between())?;
    row(table, ["ours", "stood through the first survey, gone in the second"], &left);
    holds &= meets(&left, BUILDING_GOALS);
    for trial in 0..trials {
        let count = trial as usize % 10 + 1;
        let rooms = 2 + trial as usize % 4;
        let surveys = Twice::new(SEED + 100 + trial, rooms, count);
        let clean = ours(&surveys)?;
        let name = format!("random building {trial}: {rooms} rooms, {count} people");
        row(table, ["ours", &name], &clean);
        holds &= meets(&clean, BUILDING_GOALS);
    }
    Ok(holds)
}

fn meets(outcome: &Outcome, [kept, removed]: [f64; 2]) -> bool {
    outcome.score.static_accuracy() >= kept && outcome.score.dynamic_accuracy() >= removed
}

fn row(table: &mut String, [remover, data]: [&str; 2], outcome: &Outcome) {
    let score = &outcome.score;
    // Writing to a string cannot fail.
    let _ = writeln!(
        table,
        "| {remover} | {data} | {:.3} | {:.2} | {:.2} | {:.1} |",
        100.0 * score.static_accuracy(),
        100.0 * score.dynamic_accuracy(),
        100.0 * score.harmonic_mean(),
        outcome.ms_per_sweep
    );
    println!("{remover}, {data}: {score:?}");
}

fn pictures(folder: &Path, name: &str, outcome: &Outcome) -> anyhow::Result<()> {
    let (kept, removed) = (outcome.kept.points(), outcome.removed.points());
    let frame: Vec<Point3> = kept.iter().chain(removed).copied().collect();
    let before = TopView { kept, removed, heights_m: [0.1, 2.0] };
    std::fs::write(folder.join(format!("{name}-before.png")), draw_top_view(&before, &frame))?;
    std::fs::write(
        folder.join(format!("{name}-after.png")),
        draw_top_view(&TopView { removed: &[], ..before }, &frame),
    )?;
    std::fs::write(folder.join(format!("{name}-clean.ply")), cloud_ply(kept))?;
    Ok(std::fs::write(folder.join(format!("{name}-removed.ply")), cloud_ply(removed))?)
}

/// A thousand boxes out of ten million points, on one core.
fn boxes(table: &mut String) -> bool {
    let mut chance = Chance(SEED);
    let mut place = |height_m: f32| {
        Point3::new(chance.between(-50.0, 50.0), chance.between(-50.0, 50.0), chance.between(0.0, height_m))
    };
    let boxes: Vec<RemovalBox> =
        (0..1_000).map(|_| RemovalBox::around(place(1.8), 0.0, RemovalSize::default())).collect();
    let points: Vec<Point3> = (0..10_000_000).map(|_| place(2.6)).collect();
    let began = Instant::now();
    let index = BoxIndex::new(&boxes);
    let inside = points.iter().filter(|point| index.contains(**point)).count();
    let took_s = began.elapsed().as_secs_f64();
    // The first of them without an index.
    let sample = &points[..20_000];
    let plain = sample.iter().filter(|point| boxes.iter().any(|each| each.contains(**point))).count();
    let is_right = plain == sample.iter().filter(|point| index.contains(**point)).count();
    let _ =
        writeln!(table, "\n1,000 boxes from 10 million points: {inside} inside, {took_s:.2} s on one core.");
    is_right && took_s <= 1.0
}
