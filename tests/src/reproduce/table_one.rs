//! Table I: 25 dirty cells with expected units of 10, 15, 20 and 25 in about 12 m².

use std::fmt::Write as _;
use std::path::Path;

use floorguard_laboratory::mission::pictures::{Series, line_plot};
use floorguard_laboratory::mission::statistics::paired_t_test;
use floorguard_laboratory::mission::{Guarantee, MissionConfig, Robot, StrategyTrials, run_strategies};
use floorguard_robot::site::{DirtSource, Floor, rooms};

use super::published::{DISTANCE_RATIO, TABLE_ONE};
use super::{SEED, STRATEGIES, protocol};

/// The missions of Table I.
pub struct TableOne {
    /// One entry a strategy, in the order of [`STRATEGIES`].
    pub columns: Vec<StrategyTrials>,
    /// The guarantee for each cell alone instead of for all at once.
    pub per_cell: StrategyTrials,
    /// The rule as printed: the mean alone, no mixture.
    pub as_printed: StrategyTrials,
}

/// Runs Table I.
///
/// # Errors
/// None in practice: rooms and dirt are built in.
pub fn table_one(trials: u64) -> anyhow::Result<TableOne> {
    let floor = Floor::new("laboratory", rooms::laboratory()?, Robot::PUBLISHED.radius_m)?;
    let dirt = DirtSource::Cells { count: 25, units: vec![10.0, 15.0, 20.0, 25.0] };
    let run = |strategies: &[_], config: &MissionConfig| {
        run_strategies(&floor, (strategies, config, &dirt), (trials, SEED), || {})
    };
    let ours = &STRATEGIES[..1];
    let alone =
        |config| run(ours, &config)?.pop().ok_or_else(|| anyhow::anyhow!("a strategy without missions"));
    Ok(TableOne {
        columns: run(&STRATEGIES, &protocol())?,
        per_cell: alone(MissionConfig { guarantee: Guarantee::EachCell, ..protocol() })?,
        as_printed: alone(MissionConfig {
            guarantee: Guarantee::EachCell,
            as_published: true,
            ..protocol()
        })?,
    })
}

impl TableOne {
    /// The table beside the published one.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::from(
            "Table I: 25 dirty cells, expected units 10, 15, 20, 25; success: no dirty cell above 5 units\n\
             strategy                success  95 % interval     way m   time s    q99   published success, way, time\n",
        );
        let mut line = |name: &str, column: &StrategyTrials, published: &str| {
            let s = column.summary();
            let _infallible = writeln!(
                text,
                "{name:<22} {:>6.1} %  {:>5.1} – {:>5.1} %  {:>8.2} {:>8.1} {:>6.2}   {published}",
                100.0 * s.success_rate,
                100.0 * s.success_interval95.0,
                100.0 * s.success_interval95.1,
                s.distance_m,
                s.time_s,
                s.quantile99,
            );
        };
        for (column, published) in self.columns.iter().zip(&TABLE_ONE) {
            let distance_of = published.distance_m.map_or(String::from("–"), |m| format!("{m:.2} m"));
            let beside = format!("{}/10, {distance_of}, {:.2} s", published.successes, published.time_s);
            line(published.strategy, column, &beside);
        }
        line("guarantee, a cell alone", &self.per_cell, "δ for each cell instead of for the mission");
        line("guarantee, as printed", &self.as_printed, "mean alone decides, Poisson collapse");
        let _infallible = writeln!(
            text,
            "systematic drives {:.2} times as far as the guarantee (published {DISTANCE_RATIO:.2})",
            self.distance_ratio()
        );
        for (column, published) in self.columns.iter().zip(&TABLE_ONE).skip(1) {
            let test = paired_t_test(&quantiles(self.columns.first()), &quantiles(Some(column)));
            let _infallible = writeln!(
                text,
                "99 % quantile lower than {}: by {:.2} units, t = {:.2}, p = {:.2e}",
                published.strategy, test.mean_difference, test.t, test.p
            );
        }
        text
    }

    /// Distance of the systematic strategy over ours.
    #[must_use]
    pub fn distance_ratio(&self) -> f64 {
        let distance_of = |index: usize| self.columns.get(index).map_or(f64::NAN, |c| c.summary().distance_m);
        distance_of(2) / distance_of(0)
    }

    /// Ours always succeeds and drives less than the systematic strategy.
    #[must_use]
    pub fn holds(&self) -> bool {
        let always = self.columns.first().is_some_and(|c| c.trials.iter().all(|t| t.success));
        always && self.distance_ratio() > 1.0
    }

    /// Share of the missions against the dirt left.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn draw(&self, path: &Path) -> anyhow::Result<()> {
        let series: Vec<Series> = self.columns.iter().map(cumulated).collect();
        line_plot(path, ("Table I: dirt left in the dirtiest cell", "units", "share of missions"), &series)
    }
}

fn quantiles(column: Option<&StrategyTrials>) -> Vec<f64> {
    column.map_or(Vec::new(), |c| c.trials.iter().map(|t| f64::from(t.quantile99)).collect())
}

fn cumulated(column: &StrategyTrials) -> Series {
    let mut left: Vec<u32> = column.trials.iter().map(|t| t.quantile99).collect();
    left.sort_unstable();
    let count = left.len().max(1) as f64;
    let points = left.iter().enumerate().map(|(i, &u)| (f64::from(u), (i + 1) as f64 / count)).collect();
    Series { name: column.strategy.name().to_owned(), points }
}
