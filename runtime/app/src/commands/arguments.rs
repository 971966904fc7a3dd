//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

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
    /// Read the log of a black box and make it a recording.
    Blackbox(super::BlackBoxArguments),
    /// Print every return of a lidar capture, or every sample of an inertial sensor's bytes.
    Decode(DecodeArguments),
    /// Say what is in a recording, what is wrong with it, and what can be done with it.
    Inspect(super::InspectArguments),
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

/// What to decode.
#[derive(Clone, Debug, Args)]
pub struct DecodeArguments {
    /// The capture: .pcap, .pcapng, either of them .gz; or the bytes of an MTi's line.
    pub file: PathBuf,
    /// Which lidar made it.
    #[arg(long, default_value = "auto")]
    pub model: ModelArgument,
    /// Comma-separated values on standard output.
    #[arg(long)]
    pub csv: bool,
}

/// What to replay.
#[derive(Clone, Debug, Args)]
pub struct ReplayArguments {
    /// A recording of `--record` or a ROS 2 bag (.mcap), a lidar capture (.pcap, .pcapng, .gz), a CARMEN log (.clf,
    /// .log, .gz, .bz2), or the bytes of an S300's line.
    pub file: PathBuf,
    /// Which lidar made a capture.
    #[arg(long, default_value = "auto")]
    pub model: ModelArgument,
    /// One object per sweep or scan and line on standard output.
    #[arg(long)]
    pub json: bool,
    /// Of a bag, only this topic of point clouds or scans.
    #[arg(long)]
    pub topic: Option<String>,
    /// Of a capture, a bag or a log: write what it holds and what was found as a recording, for viewers and `report`.
    #[arg(long, value_name = "FILE.mcap")]
    pub record: Option<PathBuf>,
    /// As fast as it was recorded instead of as fast as possible.
    #[arg(long)]
    pub realtime: bool,
}

/// Lidar models by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ModelArgument {
    /// Tell from the packets.
    #[default]
    Auto,
    /// VLP-16 or Puck LITE.
    Vlp16,
    /// Puck Hi-Res.
    PuckHiRes,
    /// VLP-32C.
    Vlp32c,
    /// HDL-32E.
    Hdl32e,
}
