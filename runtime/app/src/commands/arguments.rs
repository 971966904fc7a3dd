//! The command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

use crate::recordings::{DecodeArguments, InspectArguments, ReplayArguments};

/// On-robot software for a floor-cleaning robot among people: perceives, guards, records.
#[derive(Debug, Parser)]
#[command(name = "floorguard", version, about)]
#[cfg_attr(not(feature = "laboratory"), command(arg_required_else_help = true))]
pub struct Arguments {
    /// What to do; without a command: the demo.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// One task.
#[derive(Debug, Subcommand)]
pub enum Command {
    #[cfg(feature = "laboratory")]
    /// Three simulated minutes of a supermarket: live status, verdict, and a report with a picture.
    Demo(super::DemoArguments),
    /// Run the robot on real devices.
    Run(super::RunArguments),
    #[cfg(feature = "laboratory")]
    /// Drive the simulated robot through a scenario and judge it by ground truth.
    Simulate(super::SimulateArguments),
    #[cfg(feature = "laboratory")]
    /// Many seeded runs on all cores: encounters with people, faults, worlds judged for contacts by true geometry.
    Campaign(super::CampaignArguments),
    /// Feed a recording, a lidar capture, a ROS 2 bag or a laser log through the same stages as on the robot.
    Replay(ReplayArguments),
    /// Write the report of a recording: one HTML file with map, stops, speeds, people and health.
    Report(super::ReportArguments),
    /// Say why the robot stopped: what each sensor saw, which rule decided, what would have happened otherwise.
    Explain(super::ExplainArguments),
    /// Read the log of a black box and make it a recording.
    Blackbox(super::BlackBoxArguments),
    /// Print every return of a lidar capture, or every sample of an inertial sensor's bytes.
    Decode(DecodeArguments),
    /// Say what is in a recording, what is wrong with it, and what can be done with it.
    Inspect(InspectArguments),
    #[cfg(feature = "laboratory")]
    /// Clean a map in simulation with a guarantee, and compare strategies.
    Mission(super::MissionArguments),
    /// Learn where and when people walk, from recorded tracks, into the environment model of a place.
    Learn(super::LearnArguments),
    /// Ask the environment model: best time, best zone, wet or dry, where dirt, where people.
    Ask(super::AskArguments),
    #[cfg(feature = "laboratory")]
    /// Learn a classifier and write it as a table of the core.
    Train(super::TrainArguments),
    #[cfg(feature = "laboratory")]
    /// Compare a stage with recorded truth or with an independent key.
    Eval(super::EvalArguments),
    /// Check a configuration: every mistake with line, limit and remedy.
    Check {
        /// The configuration.
        file: PathBuf,
    },
}
