//! Figure 6: the same missions with and without the dirt sensor in the localisation.

use std::fmt::Write as _;
use std::path::Path;

use floorguard_laboratory::mission::pictures::{Series, line_plot};
use floorguard_laboratory::mission::statistics::{PairedTest, mean, paired_t_test};
use floorguard_laboratory::mission::{MissionConfig, Robot, Strategy, StrategyTrials, run_strategies};
use floorguard_robot::site::{DirtSource, Floor, rooms};

use super::{SEED, protocol};

/// Width of a bin of the plot, s.
const BIN_S: f32 = 10.0;

/// The missions of Figure 6, pair by pair.
pub struct FigureSix {
    /// With dirt measurements.
    pub with_dirt: StrategyTrials,
    /// Without.
    pub without: StrategyTrials,
}

/// Runs Figure 6: one tour over the dirt of Table I, without replanning.
///
/// # Errors
/// None in practice: rooms and dirt are built in.
pub fn figure_six(trials: u64) -> anyhow::Result<FigureSix> {
    let floor = Floor::new("laboratory", rooms::laboratory()?, Robot::PUBLISHED.radius_m)?;
    let dirt = DirtSource::Cells { count: 25, units: vec![10.0, 15.0, 20.0, 25.0] };
    let run = |uses_dirt_sensor| {
        let config = MissionConfig { uses_dirt_sensor, ..protocol() };
        run_strategies(&floor, (&[Strategy::NoReplanning], &config, &dirt), (trials, SEED), || {})?
            .pop()
            .ok_or_else(|| anyhow::anyhow!("a strategy without missions"))
    };
    Ok(FigureSix { with_dirt: run(true)?, without: run(false)? })
}

impl FigureSix {
    /// The one-sided paired test over the errors, averaged over time.
    #[must_use]
    pub fn test(&self) -> PairedTest {
        let errors = |column: &StrategyTrials| -> Vec<f64> {
            column.trials.iter().map(|t| f64::from(t.mean_error_m)).collect()
        };
        paired_t_test(&errors(&self.with_dirt), &errors(&self.without))
    }

    /// Both means and the test.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::from(
            "Figure 6: error of the most likely particle, averaged over time (published: smaller with dirt, p < 0.05)\n",
        );
        for (name, column) in [("with dirt", &self.with_dirt), ("without dirt", &self.without)] {
            let _infallible = writeln!(
                text,
                "{name:<14} {:.4} m over {} missions",
                column.summary().localisation_error_m,
                column.trials.len()
            );
        }
        let test = self.test();
        let _infallible =
            writeln!(text, "smaller by {:.4} m, t = {:.2}, p = {:.2e}", test.mean_difference, test.t, test.p);
        text
    }

    /// Smaller with dirt, and not by chance.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.test().p < 0.05
    }

    /// Error against time.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn draw(&self, path: &Path) -> anyhow::Result<()> {
        let series = [over_time("with dirt", &self.with_dirt), over_time("without dirt", &self.without)];
        line_plot(path, ("Figure 6: error of the most likely particle", "s", "m"), &series)
    }
}

fn over_time(name: &str, column: &StrategyTrials) -> Series {
    let all = || column.trials.iter().flat_map(|t| t.errors.iter());
    let last = all().map(|e| e.0).fold(0.0, f32::max);
    let bins = (last / BIN_S) as usize + 1;
    let points = (0..bins)
        .filter_map(|bin| {
            let from = bin as f32 * BIN_S;
            let values: Vec<f64> =
                all().filter(|e| e.0 >= from && e.0 < from + BIN_S).map(|e| f64::from(e.1)).collect();
            (!values.is_empty()).then(|| (f64::from(from + 0.5 * BIN_S), mean(values)))
        })
        .collect();
    Series { name: name.to_owned(), points }
}
