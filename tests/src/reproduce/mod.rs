//! The published experiments, repeated in simulation: `cargo xtask reproduce cleaning`, `motion` and `sliding-window`.
//!
//! Every table stands beside the published figures, and every number comes from the missions that were just run. The
//! protocol of cleaning is that of the book, Cleaning: Published protocol; what it leaves open is stated in the
//! table concerned.

mod environments;
mod figure_five;
mod figure_six;
mod motion;
mod published;
pub mod sliding_window;
mod store;
mod table_one;
mod tours;

use std::path::Path;

use floorguard_laboratory::mission::{Guarantee, MissionConfig, Strategy};

pub use environments::{Environment, environments};
pub use figure_five::{Cell, FigureFive, figure_five};
pub use figure_six::{FigureSix, figure_six};
pub use motion::{MotionFigures, motion, motion_figures};
pub use store::Store;
pub use table_one::{TableOne, table_one};
pub use tours::tours;

/// Seed of the first mission of every experiment.
pub const SEED: u64 = 2_014;

/// The strategies of the published comparison, ours first.
pub const STRATEGIES: [Strategy; 4] =
    [Strategy::Guarantee, Strategy::NoReplanning, Strategy::Systematic, Strategy::Random];

/// Risk that a mission misses the published criterion, the 99 % quantile over the dirty cells. The protocol has thousands
/// of missions and asks that none fails; δ = 0.01 for each cell alone would let one in four fail with 25 cells
/// (book, Cleaning: Mission risk).
const MISSION_RISK: f64 = 0.001;

/// The published robot and rule, with the risk of a whole mission beside the δ of each cell.
#[must_use]
pub fn protocol() -> MissionConfig {
    MissionConfig {
        guarantee: Guarantee::Mission,
        mission_risk: MISSION_RISK,
        ..MissionConfig::published(Strategy::Guarantee)
    }
}

/// Runs everything with `trials` missions for each combination, writes tables and pictures into `folder`, and returns
/// the text. The second value says whether everything that must show did.
///
/// # Errors
/// A map that cannot be read, or a folder that cannot be written.
pub fn cleaning(trials: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let mut text = format!("{trials} missions for each combination, seeds from {SEED}\n\n");
    let mut holds = true;
    let mut add = |part: (String, bool)| {
        eprintln!("{}", part.0);
        text.push_str(&part.0);
        text.push('\n');
        holds &= part.1;
    };
    let table = table_one(trials)?;
    table.draw(&folder.join("table_one.svg"))?;
    add((table.text(), table.holds()));
    let six = figure_six(trials)?;
    six.draw(&folder.join("figure_six.svg"))?;
    add((six.text(), six.holds()));
    let mut store = Store::open(folder.join("figure_five.jsonl"))?;
    eprintln!("{} of the combinations of Figure 5 are there from an earlier run", store.count());
    let mut cells = Vec::new();
    for environment in environments()? {
        cells.extend(figure_five(
            &environment,
            &figure_five::SHARES,
            &figure_five::RANGES,
            (trials, Some(&mut store)),
        )?);
        eprintln!("{} done", environment.floor.name);
    }
    let five = FigureFive { cells };
    five.draw(folder)?;
    add((five.text(), five.holds()));
    std::fs::write(folder.join("cleaning.txt"), &text)?;
    Ok((text, holds))
}
