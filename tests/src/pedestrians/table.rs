//! All scenes, all drivers, in one table, and ours beside each other driver on the same starts.

use std::fmt::Write as _;
use std::path::Path;

use rayon::prelude::*;

use super::crowd::Behaviour;
use super::drive::{Driven, LIMIT_S, Robot, Trial, drive, undisturbed};
use super::policy::Policy;
use super::recording::Recording;
use super::scenes::{SCENES, example_robot};
use super::start::draw;
use crate::data::recording;

const BEHAVIOURS: [Behaviour; 2] = [Behaviour::Recorded, Behaviour::Reacting];
/// First seed.
const SEED: u64 = 1;

/// One drive of the experiment.
struct Entry {
    scene: &'static str,
    behaviour: Behaviour,
    policy: Policy,
    driven: Driven,
}

/// What is compared: its name, its value, and whether more of it is better.
type Measure = (&'static str, fn(&Driven) -> f32, bool);
const MEASURES: [Measure; 5] = [
    ("time to the goal, s", |driven| driven.time_s, false),
    ("least distance, m", |driven| driven.least_m, true),
    ("distance of passing, m", |driven| driven.passing_m, true),
    ("people's detour, m a drive", |driven| driven.detour_m, false),
    ("people's delay, s a drive", |driven| driven.delay_s, false),
];

/// All drives from one start.
fn from_start(robot: &Robot, (scene, recording): (&'static str, &Recording), seed: u64) -> Vec<Entry> {
    let Some(start) = draw(recording, seed) else { return Vec::new() };
    let alone = undisturbed(recording, &start);
    let all = BEHAVIOURS.iter().flat_map(|behaviour| Policy::ALL.map(|policy| (*behaviour, policy)));
    let entries = all.map(|(behaviour, policy)| {
        let alone = (behaviour == Behaviour::Reacting).then_some(&alone);
        let trial = Trial { start, behaviour, policy, seed };
        Entry { scene, behaviour, policy, driven: drive(robot, recording, (&trial, alone)) }
    });
    let entries = entries.collect();
    eprintln!("{scene}, start {seed}");
    entries
}

fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len().max(1) as f32
}

/// Mean and half of its 95 % interval, by the normal approximation.
fn mean_and_doubt(values: &[f32]) -> (f32, f32) {
    let middle = mean(values);
    let squares: f32 = values.iter().map(|value| (value - middle) * (value - middle)).sum();
    let count = values.len() as f32;
    (middle, 1.96 * (squares / (count - 1.0).max(1.0) / count.max(1.0)).sqrt())
}

fn line(entries: &[&Entry], name: &str, policy: Policy) -> String {
    let of =
        |value: fn(&Driven) -> f32| mean(&entries.iter().map(|at| value(&at.driven)).collect::<Vec<_>>());
    let sum = |value: fn(&Driven) -> u32| entries.iter().map(|at| value(&at.driven)).sum::<u32>();
    let reached = entries.iter().filter(|at| at.driven.is_reached).count();
    let is_reacting = entries.first().is_some_and(|at| at.behaviour == Behaviour::Reacting);
    let people = if is_reacting {
        format!("{:10.2} {:9.2}", of(|driven| driven.detour_m), of(|driven| driven.delay_s))
    } else {
        format!("{:>10} {:>9}", "–", "–")
    };
    format!(
        "{name:8} {:22} {reached:3} of {:3} {:8.1} {:8.2} {:10.2} {:12} {:12} {people}\n",
        policy.name(),
        entries.len(),
        of(|driven| driven.time_s),
        of(|driven| driven.least_m),
        of(|driven| driven.passing_m),
        sum(|driven| driven.driven_into),
        sum(|driven| driven.walked_into),
    )
}

/// Ours minus another driver on the same starts; the second value says that ours is better in each measure.
fn comparison(entries: &[Entry], behaviour: Behaviour, other: Policy) -> (String, bool) {
    let of = |policy: Policy| -> Vec<&Driven> {
        let those = entries.iter().filter(|at| at.behaviour == behaviour && at.policy == policy);
        those.map(|at| &at.driven).collect()
    };
    let (ours, others) = (of(Policy::Ours), of(other));
    let mut text = String::new();
    let mut is_better = true;
    let count = if behaviour == Behaviour::Reacting { MEASURES.len() } else { 3 };
    for (name, value, more_is_better) in &MEASURES[..count] {
        let differences: Vec<f32> = ours.iter().zip(&others).map(|(a, b)| value(a) - value(b)).collect();
        let (middle, doubt) = mean_and_doubt(&differences);
        let is_ahead = if *more_is_better { middle > 0.0 } else { middle < 0.0 };
        is_better &= is_ahead;
        let verdict = match (middle.abs() > doubt, is_ahead) {
            (false, _) => "no difference shown",
            (true, true) => "better",
            (true, false) => "WORSE",
        };
        let _infallible = writeln!(text, "  {name:28} {middle:+8.2} ± {doubt:.2}  {verdict}");
    }
    (text, is_better)
}

const fn words(behaviour: Behaviour) -> &'static str {
    match behaviour {
        Behaviour::Recorded => "people as recorded",
        Behaviour::Reacting => "people with social forces",
    }
}

fn table(entries: &[Entry]) -> (String, bool) {
    let mut text = String::new();
    let mut holds = !entries.is_empty();
    for behaviour in BEHAVIOURS {
        let _infallible = writeln!(
            text,
            "{}:\nscene    driver                   reached   time s  least m  passing m  driven into  walked into   detour m   delay s",
            words(behaviour)
        );
        for (scene, policy) in SCENES.iter().flat_map(|(scene, _)| Policy::ALL.map(|policy| (*scene, policy)))
        {
            let is_here = |at: &&Entry| (at.scene, at.behaviour, at.policy) == (scene, behaviour, policy);
            let here: Vec<&Entry> = entries.iter().filter(is_here).collect();
            if !here.is_empty() {
                text.push_str(&line(&here, scene, policy));
            }
        }
        for policy in Policy::ALL {
            let is_here = |at: &&Entry| (at.behaviour, at.policy) == (behaviour, policy);
            text.push_str(&line(&entries.iter().filter(is_here).collect::<Vec<_>>(), "all", policy));
        }
        for other in [Policy::Dwa, Policy::Stands, Policy::Unpredicted] {
            let (comparison, is_better) = comparison(entries, behaviour, other);
            let _infallible = write!(text, "ours minus {}:\n{comparison}", other.name());
            holds &= is_better || other == Policy::Unpredicted;
        }
    }
    (text, holds)
}

/// Drives `starts` times through each recording at hand and writes the tables into `folder`. The second value says whether ours is
/// better than the dynamic window and than standing in each measure.
///
/// # Errors
/// A recording that cannot be read, or a folder that cannot be written.
pub fn pedestrians(starts: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let robot = example_robot()?;
    let mut scenes = Vec::new();
    for (name, file) in SCENES {
        if let Some(path) = recording(&format!("trajectories/eth_ucy/{file}.txt.gz")) {
            scenes.push((name, Recording::load(&path)?));
        }
    }
    let mut text =
        format!("{starts} starts a recording, seeds from {SEED}; a drive ends after {LIMIT_S} s\n");
    let jobs: Vec<_> =
        scenes.iter().flat_map(|scene| (SEED..SEED + starts).map(move |seed| (scene, seed))).collect();
    let drives = |((name, recording), seed): &(&(&'static str, Recording), u64)| {
        from_start(&robot, (*name, recording), *seed)
    };
    let entries: Vec<Entry> = jobs.par_iter().flat_map(drives).collect();
    let (part, holds) = table(&entries);
    text.push_str(&part);
    print!("{text}");
    std::fs::write(folder.join("pedestrians.txt"), &text)?;
    Ok((text, holds))
}
