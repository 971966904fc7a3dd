//! Many seeded runs in parallel, each in its own virtual time, and one table of what came of them.

mod contacts;
mod dead_end_world;
mod dead_ends;
mod driving;
mod encounters;
mod fault_class;
mod fault_matrix;
mod fault_phase;
#[cfg(test)]
mod rear_tests;
mod removal;
#[cfg(test)]
mod removal_tests;
mod single_faults;
mod summary;
#[cfg(test)]
mod true_path;

pub use contacts::{
    ContactRow, ContactSummary, FamilyCounts, TapedContactTrial, contact_plan, contact_trial,
    contact_trial_with, taped_contact_trial,
};
pub use dead_end_world::DeadEndWorld;
pub use dead_ends::{Way, dead_end_drive, dead_end_observation, judge_dead_end, way_to};
pub use driving::{DRIVE_S, DrivingPlace, drive, rate95};
pub use encounters::encounter;
pub use fault_class::random_fault;
pub use fault_matrix::{Cell, cell_of, cells, coverage, fault_trial, name, taped_fault_trial};
pub use fault_phase::box_on_path;
pub use removal::Removal;
pub use single_faults::single_fault;
pub use summary::{CampaignSummary, RunOutcome, WorldFile, run_all, run_some};

use crate::world::{Observation, Observer, Plan, run_recorded};
use floorguard_host::executor::StopFlag;
use floorguard_operator::telemetry::RunSinks;

/// Large state is moved by value when a run begins.
const STACK_BYTES: usize = 32 << 20;

/// Plays a plan without showing anything, on a thread with room for the robot's state.
///
/// # Errors
/// The robot cannot be configured, or one of its tasks spins.
pub fn played(plan: &Plan) -> anyhow::Result<Observation> {
    watched(plan)
}

/// Plays a plan without showing anything.
fn watched(plan: &Plan) -> anyhow::Result<Observation> {
    watched_by(plan, &mut RunSinks::default())
}

/// The same, with run sinks.
fn watched_by(plan: &Plan, sinks: &mut RunSinks) -> anyhow::Result<Observation> {
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(plan, &mut show);
    run_recorded(plan, &mut observer, sinks)?;
    Ok(observer.into_observation())
}

/// Runs cases on all cores, on threads whose stacks hold the robot's state.
///
/// # Errors
/// The system gives no threads.
pub fn run_seeds(
    seeds: std::ops::Range<u64>,
    run: impl Fn(u64) -> RunOutcome + Send + Sync,
) -> anyhow::Result<CampaignSummary> {
    run_seeds_until(seeds, &StopFlag::default(), run)
}

/// The same, until somebody wants it to end: what is running is run to its end, and nothing else begins.
///
/// # Errors
/// The system gives no threads.
pub fn run_seeds_until(
    seeds: std::ops::Range<u64>,
    ended: &StopFlag,
    run: impl Fn(u64) -> RunOutcome + Send + Sync,
) -> anyhow::Result<CampaignSummary> {
    let seeds: Vec<u64> = seeds.collect();
    let pool = rayon::ThreadPoolBuilder::new().stack_size(STACK_BYTES).build()?;
    Ok(pool.install(|| run_some(&seeds, |seed| (!ended.is_stopped()).then(|| run(*seed)))))
}
