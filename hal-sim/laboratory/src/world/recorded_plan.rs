//! Recordings of simulated runs.

use std::path::Path;

use floorguard_operator::telemetry::{IN_REAL_TIME, RecordedRun, RunSinks};
use floorguard_recording::replay::{IMU_BAUD, REPEATABLE};
use floorguard_recording::{MessageListener, RecordError};
use floorguard_sim::{FaultSpec, FaultTarget};

use crate::plan::Plan;

/// A computer that halts or loses its power behaves differently with the same bytes.
fn hits_computer(fault: &FaultSpec) -> bool {
    matches!(fault.target, FaultTarget::Computer | FaultTarget::Guard | FaultTarget::Perception)
}

/// Starts a recording of a plan.
///
/// # Errors
/// The file cannot be made.
pub fn record_plan(sinks: &mut RunSinks, plan: &Plan, path: &Path) -> anyhow::Result<()> {
    let repeatable = match plan.faults.iter().any(hits_computer) {
        true => "no",
        false if plan.drive_orders.is_some() => "no: its goals were ordered from outside",
        false if plan.has_camera => "no: the floor camera's pictures are not recorded",
        false => "yes",
    };
    record(sinks, plan, (path, repeatable))
}

/// Starts a recording of a plan that is played in real time.
///
/// # Errors
/// The file cannot be made.
pub fn record_plan_in_real_time(sinks: &mut RunSinks, plan: &Plan, path: &Path) -> anyhow::Result<()> {
    record(sinks, plan, (path, IN_REAL_TIME))
}

fn record(sinks: &mut RunSinks, plan: &Plan, (path, repeatable): (&Path, &str)) -> anyhow::Result<()> {
    let seed = plan.seed.to_string();
    let texts = [
        ("scenario", plan.name.as_str()),
        ("title", plan.scenario.title.as_str()),
        ("seed", seed.as_str()),
        ("stages", plan.stages.name()),
        (REPEATABLE, repeatable),
    ];
    sinks.record_run(&run_of(plan), &texts, path)
}

/// Every message of a run of this plan reaches a listener, recorded or not.
///
/// # Errors
/// The recording that it listens to could not be written.
pub fn watch_plan(
    sinks: &mut RunSinks,
    plan: &Plan,
    listener: Box<dyn MessageListener>,
) -> Result<(), RecordError> {
    sinks.watch_live(&run_of(plan), listener)
}

/// What a recording says of a plan.
fn run_of(plan: &Plan) -> RecordedRun<'_> {
    RecordedRun {
        robot: &plan.robot,
        robot_toml: &plan.robot_toml,
        imu_baud: IMU_BAUD,
        // A mission that is ordered part by part is repeated by nobody.
        mission: plan.mission.as_ref().filter(|_| plan.cleaning_orders.is_none()),
        navigation: plan.navigation.as_ref(),
        learning: plan.learning.as_ref(),
    }
}
