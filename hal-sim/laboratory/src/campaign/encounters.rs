//! Random encounters: people cross the robot's path without looking, packets get lost.

use floorguard_sim::FaultSpec;

use super::summary::RunOutcome;
use super::watched;
use crate::world::Plan;

/// Everybody has crossed by then, seconds.
const DURATION_S: u64 = 25;
/// Share of lidar packets that are lost.
const LOSS: &str = "lidar:drop=5%";

/// One encounter: no contact and no missed stop that the sensors could have avoided.
#[must_use]
pub fn encounter(seed: u64) -> RunOutcome {
    let command = format!(
        "floorguard simulate --scenario encounter --seed {seed} --duration {DURATION_S} --fault {LOSS}"
    );
    let plan = Plan::named("encounter", seed, DURATION_S * 1_000_000).map_err(anyhow::Error::from);
    let played = plan.and_then(|mut plan| {
        plan.faults.push(FaultSpec::parse(LOSS)?);
        watched(&plan)
    });
    match played {
        Ok(observation) => {
            let verdict = observation.verdict;
            let failure = (!verdict.passed).then(|| verdict.why_not());
            RunOutcome { command, failure, verdict: Some(verdict), ..RunOutcome::default() }
        }
        Err(error) => RunOutcome { command, failure: Some(error.to_string()), ..RunOutcome::default() },
    }
}
