//! What a second look for people is worth, in the rings of large lidars that a sweep does not have: `cargo xtask reproduce
//! second-look`.
//!
//! Whole datagrams of the simulator go through the robot's own stages, in 16 and in 32 rings; the truth is the
//! simulator's.

mod halls;
mod play;

use std::fmt::Write as _;
use std::path::Path;

use floorguard_configuration::{ouster_example, ouster_keys};
use floorguard_drivers::ouster::{Beams, DataFormat};
use rayon::prelude::*;

pub use halls::hall;
pub use play::{BANDS_M, Band, Counts, play};

/// Seconds of each run.
const SECONDS: u64 = 20;
/// First seed: nothing was tuned in these halls.
const SEED: u64 = 5_000;
/// More people far away must have a track: percentage points.
const GAIN_MIN: f64 = 1.0;
/// False people more than with 16 rings: so many a sweep are no gain.
const FALSE_MORE_MAX: f64 = 0.05;

/// Name and keys of each lidar.
#[must_use]
pub fn lidars() -> [(&'static str, String); 4] {
    let ouster = |beams: &Beams| ouster_keys(beams);
    let even = |channels| Beams { format: DataFormat::Single, ..Beams::even(channels, (22_500, -22_500)) };
    [
        ("PandarXT-32", String::from("model = \"pandar-xt32\"")),
        ("OS1 of 32 beams", ouster(&ouster_example())),
        ("OS1 of 64 beams", ouster(&even(64))),
        ("OS1 of 128 beams", ouster(&even(128))),
    ]
}

/// All runs of one lidar, in 16 and in 32 rings.
///
/// # Errors
/// None in practice: the keys are those of above.
pub fn totals(keys: &str, seeds: std::ops::Range<u64>, seconds: u64) -> anyhow::Result<[Counts; 2]> {
    let runs: Vec<[Counts; 2]> =
        seeds.into_par_iter().map(|seed| play(keys, seed, seconds)).collect::<anyhow::Result<_>>()?;
    let mut totals = [Counts::default(), Counts::default()];
    for run in &runs {
        totals.iter_mut().zip(run).for_each(|(total, counts)| total.add(counts));
    }
    Ok(totals)
}

/// Share of the people in sight, per cent.
fn share(part: u32, band: &Band) -> f64 {
    100.0 * f64::from(part) / f64::from(band.visible.max(1))
}

/// False people of all bands, a sweep.
fn false_people(counts: &Counts) -> f64 {
    let count: u32 = counts.bands.iter().map(|band| band.false_people).sum();
    f64::from(count) / f64::from(counts.sweeps.max(1))
}

fn lines(name: &str, totals: &[Counts; 2]) -> String {
    let mut text = String::new();
    for (look, counts) in ["16 rings", "32 rings"].iter().zip(totals) {
        let per_sweep = |count: u32| f64::from(count) / f64::from(counts.sweeps.max(1));
        let mut from_m = 0.0;
        for (band, end_m) in counts.bands.iter().zip(BANDS_M) {
            let _infallible = writeln!(
                text,
                "{name:<17} {look:<10} {from_m:>2}-{end_m:<2} m {:>7} {:>7.1} % {:>7.1} % {:>12.3} {:>12.3}",
                band.visible,
                share(band.tracked, band),
                share(band.named, band),
                per_sweep(band.false_tracks),
                per_sweep(band.false_people)
            );
            from_m = end_m;
        }
        let _infallible =
            writeln!(text, "{:<17} {} sweeps, {} people with two tracks", "", counts.sweeps, counts.twice);
    }
    text
}

/// Runs everything, writes the table into `folder` and returns it. The second value says whether everything that must show
/// did.
///
/// # Errors
/// A folder that cannot be written.
pub fn second_look(seeds: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let mut text = format!(
        "{seeds} halls of {SECONDS} s each, seeds from {SEED}, in every second one the robot drives; people with at least a \
         third of the body in sight; a track within 0.5 m\n\
         lidar             rings      distance  people   track    person  false tracks false people per sweep\n"
    );
    let mut holds = true;
    for (name, keys) in lidars() {
        let totals = totals(&keys, SEED..SEED + seeds, SECONDS)?;
        let part = lines(name, &totals);
        eprint!("{part}");
        text.push_str(&part);
        let [one, two] = &totals;
        let [_, _, far] = [0, 1, 2].map(|band| {
            let of = |counts: &Counts| share(counts.bands[band].tracked, &counts.bands[band]);
            of(two) - of(one)
        });
        holds &= far >= GAIN_MIN && false_people(two) <= false_people(one) + FALSE_MORE_MAX;
    }
    std::fs::write(folder.join("second-look.txt"), &text)?;
    Ok((text, holds))
}
