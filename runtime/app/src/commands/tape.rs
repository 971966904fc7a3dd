//! `floorguard tape`: a recorded lidar as a tape for the emulated board.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use floorguard_laboratory::plan::{Plan, RecordedLidar};
use floorguard_laboratory::world::{Observer, run_recorded};
use floorguard_operator::telemetry::{RunSinks, Tape};
use floorguard_robot::assembly::Stages;
use floorguard_runtime::mission::Route;

use super::exit::BadInput;
use super::values::simulated_seconds;

/// Where the robot stands; its other devices see this world.
const WORLD: &str = "crossing";
/// The run goes on for so long after the last packet, microseconds.
const AFTER_US: u64 = 200_000;

/// What to put on the tape.
#[derive(Clone, Debug, Args)]
pub struct TapeArguments {
    /// A capture of a lidar: .pcap, .pcapng, either of them .gz.
    pub file: PathBuf,
    /// The tape.
    #[arg(long)]
    pub out: PathBuf,
    /// Seconds at most.
    #[arg(long, default_value_t = 12.0, value_parser = simulated_seconds)]
    pub duration: f64,
}

/// Runs the command: a robot stands, hears the recorded lidar, and its other devices see a simulated world. Everything that
/// reaches it goes onto the tape, and the fingerprint of what it put out to standard output.
///
/// # Errors
/// Bad input.
pub fn run(arguments: &TapeArguments) -> anyhow::Result<()> {
    let until_us = (arguments.duration * 1.0e6) as u64;
    let bad = |error: anyhow::Error| BadInput(format!("{error:#}"));
    let lidar = RecordedLidar::read(&arguments.file, until_us).map_err(bad)?;
    let packets = lidar.packets.len();
    let duration_us = lidar.end_us().saturating_add(AFTER_US).min(until_us);
    let mut plan = Plan::named(WORLD, 1, duration_us)?;
    plan.lidar = Some(Arc::new(lidar));
    plan.robot.route = Route::default();
    plan.stages = Stages::AsOnBoard;
    let mut sinks = RunSinks::default();
    sinks.tape = Tape::new(&plan.robot, duration_us);
    let mut show = |_, _: &_, _, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_recorded(&plan, &mut observer, &mut sinks)?;
    let digest = observer.digest().value();
    let path = &arguments.out;
    std::fs::write(path, sinks.tape.finish())
        .map_err(|error| BadInput(format!("{}: cannot be written ({error})", path.display())))?;
    let digest = format!("{digest:016x}");
    tell!("{}", serde_json::json!({ "digest": digest, "packets": packets, "duration_us": duration_us }))?;
    Ok(())
}
