//! Many missions of several strategies on all cores, and one line for each strategy.

use rayon::prelude::*;
use serde::Serialize;

use floorguard_types::random::Pcg32;

use super::config::{MissionConfig, Strategy};
use super::outcome::TrialResult;
use super::statistics::{mean, wilson95};
use super::trial::{Interrupted, MissionStorage, run_keeping};
use floorguard_host::executor::StopFlag;
use floorguard_robot::site::DirtSource;
use floorguard_robot::site::Floor;

/// Trials of one strategy, in the order of their seeds.
pub struct StrategyTrials {
    /// The strategy.
    pub strategy: Strategy,
    /// One result a trial.
    pub trials: Vec<TrialResult>,
}

/// What the trials of one strategy came to.
#[derive(Clone, Debug, Serialize)]
pub struct StrategySummary {
    /// Name of the strategy.
    pub strategy: &'static str,
    /// Missions.
    pub trials: usize,
    /// Share of the missions whose 99 % quantile of dirt left, over the cells dirty at the start, is at most τ.
    pub success_rate: f64,
    /// Wilson 95 % interval of the success rate.
    pub success_interval95: (f64, f64),
    /// Mean over the missions of the 99 % quantile of dirt left, units, over the cells dirty at the start.
    pub quantile99: f64,
    /// The same over all reachable cells.
    pub quantile99_all_cells: f64,
    /// Largest of all missions, units in one cell.
    pub max_left: u32,
    /// Mean distance, metres.
    pub distance_m: f64,
    /// Mean time, s.
    pub time_s: f64,
    /// Mean part of the time that people cost, s.
    pub waited_for_people_s: f64,
    /// Mean number of re-plannings that changed the path.
    pub replannings: f64,
    /// Cells that were dirty at the start, over all missions.
    pub dirty_cells: u64,
    /// Of those, claimed to be clean.
    pub claimed_cells: u64,
    /// Of those, in truth dirtier than τ.
    pub falsely_claimed_cells: u64,
    /// Share of falsely claimed cells, with its Wilson 95 % interval.
    pub falsely_claimed_share: f64,
    /// See `falsely_claimed_share`.
    pub falsely_claimed_interval95: (f64, f64),
    /// Share of the truly cleaned cells that are claimed.
    pub claimed_fraction: f64,
    /// Wilson 95 % interval of the claimed fraction.
    pub claimed_interval95: (f64, f64),
    /// Share of the missions that ended with an empty policy: every reachable cell is guaranteed.
    pub completion: f64,
    /// Reachable cells not claimed because too many of the possible paths missed them, mean.
    pub uncertain_cells: f64,
    /// Reachable cells given up after visits in vain, mean.
    pub given_up_cells: f64,
    /// Dirty cells that cannot be reached, mean.
    pub unreachable_cells: f64,
    /// Mean error of the most likely particle, metres.
    pub localisation_error_m: f64,
    /// Missions that ended more than 0.5 m off their place: the robot believed to be elsewhere, and did not know it.
    pub ended_astray: u64,
    /// How far off its place the worst one ended, metres.
    pub farthest_astray_m: f64,
    /// Contacts with people while moving, over all missions.
    pub avoidable_contacts: u64,
    /// Faults, over all missions.
    pub faults: u64,
}

/// A mission that ends farther off its place than this has lost it, metres.
const ASTRAY_M: f32 = 0.5;

/// The monitor of a campaign: progress and early end.
pub struct RunMonitor<'a> {
    /// Called after every mission with what it came to.
    pub progress: &'a (dyn Fn(Strategy, &TrialResult) + Sync),
    /// Set by somebody who wants the missions to end: those that run are broken off and do not count.
    pub ended: &'a StopFlag,
}

/// Runs `trials` missions of every strategy. The random strategy drives as far as the guarantee did in the same
/// trial, so that is run first where it was not asked for. `progress` is called after every mission.
///
/// # Errors
/// Dirt that cannot be read.
pub fn run_strategies(
    floor: &Floor,
    (strategies, config, dirt): (&[Strategy], &MissionConfig, &DirtSource),
    (trials, seed): (u64, u64),
    progress: impl Fn() + Sync,
) -> anyhow::Result<Vec<StrategyTrials>> {
    let monitor = RunMonitor { progress: &|_, _| progress(), ended: &StopFlag::default() };
    run_strategies_believing(floor, (strategies, config, dirt), None, (trials, seed), &monitor)
}

/// As [`run_strategies`], with a robot that believes in `believed` units in each cell, whatever lies there. Only trials
/// that every strategy has come to the end of count.
///
/// # Errors
/// Dirt that cannot be read.
pub fn run_strategies_believing(
    floor: &Floor,
    (strategies, config, dirt): (&[Strategy], &MissionConfig, &DirtSource),
    believed: Option<&[f32]>,
    (trials, seed): (u64, u64),
    monitor: &RunMonitor<'_>,
) -> anyhow::Result<Vec<StrategyTrials>> {
    let run = |trial| {
        if monitor.ended.is_stopped() {
            return Ok(None);
        }
        let seed = seed.wrapping_add(trial);
        match run_trial(floor, (strategies, config, dirt), believed, (seed, monitor)) {
            Err(error) if error.is::<Interrupted>() => Ok(None),
            row => row.map(Some),
        }
    };
    let rows: Vec<Option<Vec<TrialResult>>> =
        (0..trials).into_par_iter().map(run).collect::<anyhow::Result<_>>()?;
    let mut columns: Vec<StrategyTrials> =
        strategies.iter().map(|&strategy| StrategyTrials { strategy, trials: Vec::new() }).collect();
    for row in rows.into_iter().flatten() {
        for (column, result) in columns.iter_mut().zip(row) {
            column.trials.push(result);
        }
    }
    Ok(columns)
}

/// All strategies on the same dirt and with the same luck.
fn run_trial(
    floor: &Floor,
    (strategies, config, dirt): (&[Strategy], &MissionConfig, &DirtSource),
    believed: Option<&[f32]>,
    (seed, monitor): (u64, &RunMonitor<'_>),
) -> anyhow::Result<Vec<TrialResult>> {
    let expected = dirt.expected_units(floor, &mut Pcg32::new(seed, 0))?;
    let dirt = (expected.as_slice(), believed.unwrap_or(&expected));
    let run = |strategy, distance_limit_m| {
        let config = MissionConfig { strategy, distance_limit_m, ..*config };
        let storage = MissionStorage { ended: Some(monitor.ended), ..MissionStorage::default() };
        run_keeping(floor, &config, dirt, (seed, storage))
    };
    let mut guarantee_m = None;
    let mut results: Vec<Option<TrialResult>> = strategies.iter().map(|_| None).collect();
    // The guarantee first: it tells how far the random strategy may drive.
    for (slot, &strategy) in results.iter_mut().zip(strategies) {
        if strategy == Strategy::Guarantee {
            let result = run(strategy, None)?;
            guarantee_m = Some(result.distance_m);
            (monitor.progress)(strategy, &result);
            *slot = Some(result);
        }
    }
    for (slot, &strategy) in results.iter_mut().zip(strategies) {
        if slot.is_some() {
            continue;
        }
        let limit = match (strategy, guarantee_m) {
            (Strategy::Random, Some(distance)) => Some(distance),
            (Strategy::Random, None) => Some(run(Strategy::Guarantee, None)?.distance_m),
            _ => None,
        };
        let result = run(strategy, limit)?;
        (monitor.progress)(strategy, &result);
        *slot = Some(result);
    }
    Ok(results.into_iter().flatten().collect())
}

impl StrategyTrials {
    /// Adds up the trials.
    pub fn summary(&self) -> StrategySummary {
        let trials = &self.trials;
        let average = |value: fn(&TrialResult) -> f64| mean(trials.iter().map(value));
        let sum = |value: fn(&TrialResult) -> u32| trials.iter().map(|t| u64::from(value(t))).sum::<u64>();
        let successes = trials.iter().filter(|t| t.success).count() as u64;
        let (claimed, false_claims) = (sum(|t| t.claimed_cells), sum(|t| t.falsely_claimed_cells));
        let (clean, clean_claimed) = (sum(|t| t.truly_clean_cells), sum(|t| t.truly_clean_claimed_cells));
        let share = |part: u64, whole: u64| if whole > 0 { part as f64 / whole as f64 } else { 0.0 };
        StrategySummary {
            strategy: self.strategy.name(),
            trials: trials.len(),
            success_rate: share(successes, trials.len() as u64),
            success_interval95: wilson95(successes, trials.len() as u64),
            quantile99: average(|t| f64::from(t.quantile99)),
            quantile99_all_cells: average(|t| f64::from(t.quantile99_all)),
            max_left: trials.iter().map(|t| t.max_left).max().unwrap_or(0),
            distance_m: average(|t| f64::from(t.distance_m)),
            time_s: average(|t| f64::from(t.time_s)),
            waited_for_people_s: average(|t| f64::from(t.waited_s)),
            replannings: average(|t| f64::from(t.replannings)),
            dirty_cells: sum(|t| t.dirty_cells),
            claimed_cells: claimed,
            falsely_claimed_cells: false_claims,
            falsely_claimed_share: share(false_claims, claimed),
            falsely_claimed_interval95: wilson95(false_claims, claimed),
            claimed_fraction: share(clean_claimed, clean),
            claimed_interval95: wilson95(clean_claimed, clean),
            completion: average(|t| f64::from(u8::from(t.is_complete))),
            uncertain_cells: average(|t| f64::from(t.uncertain_cells)),
            given_up_cells: average(|t| f64::from(t.given_up_cells)),
            unreachable_cells: average(|t| f64::from(t.unreachable_cells)),
            localisation_error_m: average(|t| f64::from(t.mean_error_m)),
            ended_astray: sum(|t| u32::from(t.off_at_end_m() > ASTRAY_M)),
            farthest_astray_m: trials.iter().map(|t| f64::from(t.off_at_end_m())).fold(0.0, f64::max),
            avoidable_contacts: sum(|t| t.avoidable_contacts),
            faults: sum(|t| t.faults),
        }
    }
}
