//! How well people are followed in crowds, in simulation: `cargo xtask reproduce crowds`.
//!
//! Whole sweeps as bytes go through decoder, clusters, classifier and tracker; the truth is the simulator's. Nearest
//! neighbours (NN) and joint probabilities (NNJPDA) see the very same sweeps.

mod causes;
mod play;
mod scenes;
mod sight;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use floorguard_laboratory::metrics::MotSummary;
use floorguard_perception::people::{Association, TrackerParameters};
use rayon::prelude::*;

pub use causes::{Causes, Lost};
pub use play::{Followers, Following, Seen, follow, play, play_all};
pub use scenes::{CROWDS, CrowdScene, WalkPattern};
pub use sight::shares_in_sight;

/// Seconds of each run.
pub const SECONDS: u64 = 30;
/// First seed.
const SEED: u64 = 400;
/// What this stage must reach.
const MOTA_MIN: f64 = 0.85;
const SWITCHES_PER_PERSON_MINUTE_MAX: f64 = 1.0;
const ACQUIRED_S_MAX: f64 = 0.3;
/// What is followed with: the cheapest pair first, joint probabilities, these with the legs that the S300 sees, and all
/// that without appearance.
const DEFAULT: TrackerParameters = TrackerParameters::DEFAULT;
const METHODS: [(&str, TrackerParameters, bool); 4] = [
    ("NN", TrackerParameters { association: Association::Nearest, ..DEFAULT }, false),
    ("NNJPDA", DEFAULT, false),
    ("+ legs", DEFAULT, true),
    ("- appearance", TrackerParameters::WITHOUT_APPEARANCE, true),
];
/// The method of the robot, which uses all of its inputs.
const OURS: usize = 2;

/// All runs of one crowd with one tracker, added up.
#[derive(Clone, Debug, Default)]
pub struct Total {
    /// Objects, misses, false positives, switches.
    pub summary: MotSummary,
    /// Sum of the runs' IDF1, and how many there are.
    idf1: (f64, u64),
    distance_m: f64,
    /// As in [`Following`].
    pub person_minutes: f64,
    /// Sorted.
    pub acquired_s: Vec<f64>,
    /// As in [`Following`].
    pub large_groups: u32,
    /// Changes of identity by what became of the old track; with a fresh one, and with one that had had another person.
    pub causes: BTreeMap<Lost, [u32; 2]>,
}

impl Total {
    /// One run more.
    pub fn add(&mut self, run: &Following) {
        self.summary.objects += run.summary.objects;
        self.summary.matches += run.summary.matches;
        self.summary.misses += run.summary.misses;
        self.summary.false_positives += run.summary.false_positives;
        self.summary.switches += run.summary.switches;
        self.distance_m += run.summary.motp.unwrap_or(0.0) * run.summary.matches as f64;
        self.idf1 = (self.idf1.0 + run.summary.idf1.unwrap_or(0.0), self.idf1.1 + 1);
        self.person_minutes += run.person_minutes;
        self.acquired_s.extend(&run.acquired_s);
        self.acquired_s.sort_by(f64::total_cmp);
        self.large_groups += run.large_groups;
        add_causes(&mut self.causes, &run.causes.counts);
    }

    /// Multi-object tracking accuracy.
    #[must_use]
    pub fn mota(&self) -> f64 {
        let wrong = self.summary.misses + self.summary.false_positives + self.summary.switches;
        1.0 - wrong as f64 / self.summary.objects.max(1) as f64
    }

    /// Mean IDF1 of the runs.
    #[must_use]
    pub fn idf1(&self) -> f64 {
        self.idf1.0 / self.idf1.1.max(1) as f64
    }

    /// Changes of identity per minute that a person is in sight.
    #[must_use]
    pub fn switches_per_person_minute(&self) -> f64 {
        self.summary.switches as f64 / self.person_minutes.max(1.0e-9)
    }

    /// Time to acquire that a share of all people stays below, seconds.
    #[must_use]
    pub fn acquired_within_s(&self, share: f64) -> f64 {
        let last = self.acquired_s.len().saturating_sub(1);
        self.acquired_s.get((share * last as f64) as usize).copied().unwrap_or(f64::INFINITY)
    }

    /// All that must show.
    fn holds(&self) -> bool {
        self.mota() >= MOTA_MIN
            && self.switches_per_person_minute() <= SWITCHES_PER_PERSON_MINUTE_MAX
            && self.acquired_within_s(0.5) <= ACQUIRED_S_MAX
    }

    fn line(&self, scene: &str, tracker: &str) -> String {
        format!(
            "{scene:<18} {tracker:<7} {:>6.3} {:>6.3} {:>7.3} {:>6.2} % {:>6.2} % {:>8} {:>10.3} {:>7.2} {:>7.2} {:>7}\n",
            self.mota(),
            self.idf1(),
            self.distance_m / self.summary.matches.max(1) as f64,
            100.0 * self.summary.misses as f64 / self.summary.objects.max(1) as f64,
            100.0 * self.summary.false_positives as f64 / self.summary.objects.max(1) as f64,
            self.summary.switches,
            self.switches_per_person_minute(),
            self.acquired_within_s(0.5),
            self.acquired_within_s(0.95),
            self.large_groups
        )
    }
}

/// Follows `seeds` crowds of a scene; one total for each method: NN, NNJPDA, NNJPDA with lidar and scanner, the same
/// without appearance.
///
/// # Errors
/// None in practice: the scenes are built in.
pub fn totals(scene: &CrowdScene, seeds: u64, seconds: u64) -> anyhow::Result<[Total; 4]> {
    let trackers = METHODS.map(|(_, parameters, legs)| (parameters, legs));
    let runs: Vec<Vec<Following>> = (SEED..SEED + seeds)
        .into_par_iter()
        .map(|seed| follow(scene, (seed, seconds), &trackers))
        .collect::<anyhow::Result<_>>()?;
    let mut totals = [(); 4].map(|()| Total::default());
    for run in runs {
        totals.iter_mut().zip(&run).for_each(|(total, run)| total.add(run));
    }
    Ok(totals)
}

fn add_causes(sum: &mut BTreeMap<Lost, [u32; 2]>, more: &BTreeMap<Lost, [u32; 2]>) {
    for (cause, counts) in more {
        let total = sum.entry(*cause).or_default();
        total.iter_mut().zip(counts).for_each(|(total, count)| *total += count);
    }
}

/// Why identities changed, with lidar and scanner, in all the crowds.
fn causes_text(causes: &BTreeMap<Lost, [u32; 2]>) -> String {
    let mut text =
        String::from("  what had become of the old track     new one fresh   somebody else's before\n");
    for (cause, name) in Lost::ALL {
        let [fresh, known] = causes.get(&cause).copied().unwrap_or_default();
        let _infallible = writeln!(text, "  {name:<36} {fresh:>13} {known:>24}");
    }
    text
}

/// Runs everything, writes the table into `folder` and returns it. The second value says whether everything that must
/// show did, with the association that the robot uses.
///
/// # Errors
/// A folder that cannot be written.
pub fn crowds(seeds: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let mut text = format!(
        "{seeds} runs of {SECONDS} s each, seeds from {SEED}; people within 12 m of whom a third is in sight; gate 0.5 m\n\
         crowd              tracker   MOTA   IDF1  MOTP m   missed    false switches per minute  50 % s  95 % s  large\n"
    );
    let mut holds = true;
    for varied in [false, true] {
        let bodies = if varied { "bodies and clothes of their own" } else { "all adults the same" };
        let _infallible = writeln!(text, "{bodies}:");
        let mut causes: BTreeMap<Lost, [u32; 2]> = BTreeMap::new();
        for scene in CROWDS.map(|scene| CrowdScene { varied, ..scene }) {
            let totals = totals(&scene, seeds, SECONDS)?;
            for ((name, ..), total) in METHODS.iter().zip(&totals) {
                text.push_str(&total.line(scene.name, name));
            }
            let ours = &totals[OURS];
            add_causes(&mut causes, &ours.causes);
            // Real people differ; those who do not are there to show what it is worth.
            holds &= !varied || ours.holds();
            eprint!("{}", ours.line(scene.name, METHODS[OURS].0));
        }
        text.push_str(&causes_text(&causes));
    }
    text.push_str(
        "\"per minute\": switches per minute that a person is in sight; 50 % and 95 %: of all people are named within;\n\
         \"large\": groups too large for joint probabilities, which fall back to the nearest\n",
    );
    std::fs::write(folder.join("crowds.txt"), &text)?;
    Ok((text, holds))
}
