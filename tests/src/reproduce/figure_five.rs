//! Figure 5: four environments, three shares of dirty cells, five ranges of expected units, four strategies.

use std::fmt::Write as _;
use std::path::Path;

use floorguard_laboratory::mission::pictures::{Series, line_plot};
use floorguard_laboratory::mission::statistics::{mean, paired_t_test};
use floorguard_laboratory::mission::{StrategyTrials, TrialResult, run_strategies};
use floorguard_robot::site::{DirtSource, Floor};

use super::environments::Environment;
use super::store::Store;
use super::{SEED, STRATEGIES, protocol};

/// Shares of dirty cells.
pub const SHARES: [f32; 3] = [0.05, 0.10, 0.20];
/// Ranges of the expected units of a dirty cell.
pub const RANGES: [(f32, f32); 5] = [(5.0, 10.0), (10.0, 15.0), (15.0, 20.0), (20.0, 25.0), (25.0, 30.0)];

/// The missions of one environment, share and range.
pub struct Cell {
    /// Name of the environment.
    pub environment: String,
    /// Share of dirty cells.
    pub share: f32,
    /// Range of the expected units.
    pub range: (f32, f32),
    /// One entry a strategy, in the order of [`STRATEGIES`].
    pub columns: Vec<StrategyTrials>,
}

/// All that was run.
pub struct FigureFive {
    /// One entry a combination.
    pub cells: Vec<Cell>,
}

/// Runs one environment. What the `store` holds is not run again.
///
/// # Errors
/// A store that cannot be written; none in practice without one, for the dirt is drawn and not read.
pub fn figure_five(
    environment: &Environment,
    shares: &[f32],
    ranges: &[(f32, f32)],
    (trials, mut store): (u64, Option<&mut Store>),
) -> anyhow::Result<Vec<Cell>> {
    let mut cells = Vec::new();
    for &share in shares {
        for &range in ranges {
            let key = (environment.floor.name.as_str(), share, range);
            let columns = match store.as_ref().and_then(|store| store.get(key, trials)) {
                Some(kept) => {
                    let columns = STRATEGIES.into_iter().zip(kept);
                    columns.map(|(strategy, trials)| StrategyTrials { strategy, trials }).collect()
                }
                None => run(&environment.floor, (share, range), trials)?,
            };
            if let Some(store) = store.as_deref_mut() {
                let missions: Vec<&[TrialResult]> = columns.iter().map(|c| c.trials.as_slice()).collect();
                store.put(key, &missions)?;
            }
            cells.push(Cell { environment: environment.floor.name.clone(), share, range, columns });
        }
    }
    Ok(cells)
}

/// All strategies on one combination, without what the figure does not show: the paths of thousands of missions fill
/// a memory.
fn run(floor: &Floor, (share, units): (f32, (f32, f32)), trials: u64) -> anyhow::Result<Vec<StrategyTrials>> {
    let dirt = DirtSource::Random { share, units };
    let mut columns = run_strategies(floor, (&STRATEGIES, &protocol(), &dirt), (trials, SEED), || {})?;
    for trial in columns.iter_mut().flat_map(|column| &mut column.trials) {
        trial.errors = Vec::new();
        trial.verdicts = Vec::new();
        trial.left = Vec::new();
        trial.path = Vec::new();
        trial.hits = Vec::new();
    }
    Ok(columns)
}

/// A value of every mission of one strategy in one range.
type Value = fn(&TrialResult) -> f64;

/// What is drawn: name, unit, value.
const QUANTITIES: [(&str, &str, Value); 3] = [
    ("success", "share of missions", |t| f64::from(u8::from(t.success))),
    ("quantile", "units", |t| f64::from(t.quantile99)),
    ("distance", "m", |t| f64::from(t.distance_m)),
];

impl FigureFive {
    /// The values of one strategy in one range, over all environments and shares.
    fn values(&self, range: (f32, f32), strategy: usize, value: Value) -> Vec<f64> {
        self.cells
            .iter()
            .filter(|cell| cell.range == range)
            .filter_map(|cell| cell.columns.get(strategy))
            .flat_map(|column| column.trials.iter().map(value))
            .collect()
    }

    fn ranges(&self) -> impl Iterator<Item = (f32, f32)> + '_ {
        RANGES.into_iter().filter(|range| self.cells.iter().any(|cell| cell.range == *range))
    }

    /// Means over environments and shares for every range, with tests against ours.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::from(
            "Figure 5: means over environments and shares of dirty cells; p: one-sided paired t-test against ours.\n\
             Published: ours 100 % in every range, the others fall with the amount; no replanning < ours < systematic \
             in distance.\n\
             units    strategy        missions  success    q99        p    way m        p   claimed falsely\n",
        );
        for range in self.ranges() {
            for (index, strategy) in STRATEGIES.iter().enumerate() {
                let values = |value: Value| self.values(range, index, value);
                let ours = |value: Value| self.values(range, 0, value);
                let [success, quantile, distance] = QUANTITIES.map(|(_, _, value)| values(value));
                let p = |value: Value| {
                    let test = paired_t_test(&ours(value), &values(value));
                    if index == 0 { String::from("–") } else { format!("{:.1e}", test.p) }
                };
                let claimed: f64 = values(|t| f64::from(t.claimed_cells)).iter().sum();
                let falsely: f64 = values(|t| f64::from(t.falsely_claimed_cells)).iter().sum();
                let _infallible = writeln!(
                    text,
                    "{:>2}-{:<3}  {:<16} {:>7}  {:>5.1} %  {:>5.2}  {:>7}  {:>7.1}  {:>7}   {falsely:.0} of {claimed:.0}",
                    range.0,
                    range.1,
                    strategy.name(),
                    success.len(),
                    100.0 * mean(success.iter().copied()),
                    mean(quantile),
                    p(QUANTITIES[1].2),
                    mean(distance),
                    p(QUANTITIES[2].2),
                );
            }
        }
        let covered: Vec<f64> =
            self.ranges().flat_map(|range| self.values(range, 2, |t| f64::from(t.covered_share))).collect();
        let _infallible = writeln!(
            text,
            "systematic really passes over {:.1} % of the cells that can be reached (worst mission {:.1} %)",
            100.0 * mean(covered.iter().copied()),
            100.0 * covered.iter().copied().fold(1.0, f64::min),
        );
        text.push_str(&self.by_environment());
        text
    }

    fn by_environment(&self) -> String {
        let mut text =
            String::from("by environment and share: success and distance of ours, distance of systematic\n");
        for cell in &self.cells {
            let [ours, _, systematic, _] = cell.columns.as_slice() else { continue };
            let (ours, systematic) = (ours.summary(), systematic.summary());
            let _infallible = writeln!(
                text,
                "{:<28} {:>3.0} %  {:>2}-{:<3} {:>5.1} %  {:>7.1} m  {:>7.1} m",
                cell.environment,
                100.0 * cell.share,
                cell.range.0,
                cell.range.1,
                100.0 * ours.success_rate,
                ours.distance_m,
                systematic.distance_m,
            );
        }
        text
    }

    /// Ours always succeeds, and drives less than the systematic strategy in every range.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.ranges().all(|range| {
            let always = self.values(range, 0, QUANTITIES[0].2).iter().all(|&success| success > 0.0);
            let distance_of = |strategy| mean(self.values(range, strategy, QUANTITIES[2].2));
            always && distance_of(0) < distance_of(2)
        })
    }

    /// One plot for each quantity.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, folder: &Path) -> anyhow::Result<()> {
        for (name, unit, value) in QUANTITIES {
            let series: Vec<Series> = STRATEGIES
                .iter()
                .enumerate()
                .map(|(index, strategy)| Series {
                    name: strategy.name().to_owned(),
                    points: self
                        .ranges()
                        .map(|range| {
                            let middle = f64::from(0.5 * (range.0 + range.1));
                            (middle, mean(self.values(range, index, value)))
                        })
                        .collect(),
                })
                .collect();
            let title = format!("Figure 5: {name}");
            let path = folder.join(format!("figure_five_{name}.svg"));
            line_plot(&path, (&title, "expected units of a dirty cell", unit), &series)?;
        }
        Ok(())
    }
}
