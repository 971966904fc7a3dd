//! What the environment model learns, judged by patterns that were built in: `cargo xtask reproduce environment`.
//!
//! Visitors of six kinds of places are drawn at random from known rates; the model, a plain histogram of the hours of
//! the day, and the others predict the weeks after. Then the recorded tracks of three places become heat maps, and an
//! independent count says whether anything was lost.

mod dirt;
mod patterns;
mod recorded;
mod recovery;
mod trials;

use std::path::Path;

pub use dirt::{Evening, dirt_days, holds as dirt_holds};
pub use patterns::{PATTERNS, Pattern};
pub use recorded::{RECORDED, Recorded, recorded};
pub use recovery::{Recovery, recovery};
pub use trials::{Row, Watching, totals, trial, trials};

/// Seed of the first run of the tests, and of what was examined while the model was made.
pub const SEED: u64 = 2_017;

/// Runs everything with `runs` runs from `seed` on for each combination, writes tables and pictures into `folder`, and returns the
/// text. The second value says whether everything that must show did.
///
/// # Errors
/// A folder that cannot be written, or a recording that cannot be read.
pub fn environment(runs: u64, seed: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let mut text = String::new();
    let mut holds = true;
    let mut add = |part: (String, bool)| {
        eprintln!("{}", part.0);
        text.push_str(&part.0);
        text.push('\n');
        holds &= part.1;
    };
    let recovered: Vec<Recovery> = PATTERNS.iter().map(|pattern| recovery(pattern, seed)).collect();
    add((recovery::table(&recovered), recovered.iter().all(Recovery::holds)));
    recovered.iter().try_for_each(|one| one.draw(&folder.join(format!("{}.svg", one.pattern.name))))?;
    let rows = trials(runs, seed);
    add((trials::table(&rows, runs), trials::holds(&rows)));
    let mut places = Vec::new();
    for file in RECORDED {
        places.extend(recorded(file, Some(folder))?);
    }
    add((recorded::table(&places), places.iter().all(Recorded::holds)));
    // Whole missions: a few runs of seven evenings each.
    let runs = runs.min(4);
    let evenings = dirt_days(runs, seed)?;
    add((dirt::table(&evenings, runs), dirt::holds(&evenings)));
    std::fs::write(folder.join("environment.txt"), &text)?;
    Ok((text, holds))
}
