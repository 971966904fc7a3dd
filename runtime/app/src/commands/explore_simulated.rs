//! `floorguard explore --scenario`: a simulated robot explores, and its map is judged by the true building.

use std::path::Path;

use floorguard_laboratory::world::{Plan, load_scenario};
use floorguard_operator::telemetry::RunSinks;

use super::exit::{BadInput, WrongUsage};
use super::explore::{ExploreArguments, write};
use super::ros2::RosWay;
use super::simulate::{conclude, play};
use super::sinks::{SinkOutputs, open_sinks};

/// The longest that a simulated exploration takes without --duration, seconds.
const LONGEST_S: f64 = 1_800.0;

/// Runs the command.
///
/// # Errors
/// Bad input, or a verdict that is not good enough; a map that was begun is written all the same.
pub(super) fn run(arguments: &ExploreArguments, scenario: &str) -> anyhow::Result<()> {
    let ExploreArguments { seed, side, outputs, .. } = arguments;
    let duration_s = outputs.duration.unwrap_or(LONGEST_S);
    let duration_us = (duration_s * 1.0e6) as u64;
    let mut plan = if Path::new(scenario).extension().is_some() {
        Plan::of(scenario, load_scenario(Path::new(scenario))?, *seed, duration_us)?
    } else {
        Plan::named(scenario, *seed, duration_us)
            .map_err(|error| WrongUsage(format!("--scenario: {error}")))?
    };
    if let Some(robot) = &arguments.file {
        plan = plan.with_robot(robot).map_err(|error| BadInput(format!("{error:#}")))?;
    }
    let plan = plan.exploring(*side)?;
    let mut sinks = RunSinks::default();
    let (record, panel, live) = (outputs.record.as_deref(), outputs.panel, outputs.live.clone());
    let ros = RosWay::of(outputs.live.ros2, None, &mut None)?;
    open_sinks(&mut sinks, &plan, SinkOutputs { record, panel, live, ros, ..SinkOutputs::default() })?;
    let observation = play(&plan, outputs.json, &mut sinks)?;
    if let Some(surveyed) = &observation.surveyed {
        write(arguments, surveyed)?;
    }
    let out = arguments.out.display();
    let repeat = format!(
        "floorguard explore --scenario {scenario} --seed {seed} --side {side} --duration {duration_s} --out {out}"
    );
    conclude((&plan, &repeat), &observation, outputs.json)
}
