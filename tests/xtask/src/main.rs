//! `cargo xtask`: everything that a developer, CI or an auditor does with the project, one word each.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use embedded_audit::{audit, campaign, facts, records, shell, structure};

mod bench;
#[cfg(test)]
mod book;
mod check_recording;
mod check_ros2;
#[cfg(test)]
mod citations;
#[cfg(test)]
mod features;
mod figures;
mod firmware;
mod firmware_replay;
mod image_size;
mod lateness;
mod machine;
mod mapping_counts;
mod package;
mod panel_check;
mod program;
mod reproduce;
mod same_bits;
mod setup;
mod stack;
mod targets;
mod test;
mod vcan;
#[cfg(test)]
mod vocabulary;
mod worst;

/// Automation of floorguard. Exit codes: 0 good, 1 verdict negative, 2 usage, 3 bad input.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Install what is missing on a bare machine, and say what was done.
    Setup,
    /// Set up, then run everything that CI runs.
    Test(test::Options),
    /// Check every claim of the safety evidence and write it to target/audit.
    Audit(audit::Options),
    /// Let the records of docs/evidence follow code that only moved since a commit.
    Moved(records::Options),
    /// Check which crate and module knows which, and how long files are; --write draws the graph.
    Structure(structure::Options),
    /// Run one of the long campaigns on all cores, or go on where it was cut.
    Campaign(campaign::Options),
    /// Play a scenario on the emulated Cortex-M7 and compare with the host, bit for bit.
    Firmware(firmware::Options),
    /// Count the instructions of mapping on the emulated Cortex-M7: odometry in space, and the map in fixed memory.
    MappingCounts,
    /// Try the SocketCAN carrier on vcan0 of a Linux that runs as a process.
    Vcan(vcan::Options),
    /// Measure the stages of the lidar path on the recordings.
    Bench(bench::Options),
    /// Read a recording with readers that others wrote: Python's mcap and rosbags, Rerun's importer.
    CheckRecording(check_recording::Options),
    /// Play the robot in ROS 2 against another implementation of DDS: Cyclone DDS, or ROS 2 itself.
    CheckRos2(check_ros2::Options),
    /// Measure how late the guard is while the robot is recorded, shown and read by everybody at once.
    Lateness(lateness::Options),
    /// Walk through the operator's panel in a headless browser: by keyboard, touch and mouse, in five languages, judged by axe.
    PanelCheck(panel_check::Options),
    /// Build the crates of the core and the drivers for every kind of processor that they are meant for.
    Targets(targets::Options),
    /// Pack the robot's program for Debian, with unit, device rules and example.
    Package(package::Options),
    /// Play a run and map a log with the program for arm64, emulated, and compare with this computer's, bit for bit.
    SameBits(same_bits::Options),
    /// Write the book's pages of measured figures from docs/evidence/figures; --check only compares.
    Figures(figures::Options),
    /// Repeat published experiments, beside the published figures.
    Reproduce(reproduce::Options),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let outcome = facts::check().and_then(|()| run(arguments.command));
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(3)
        }
    }
}

fn run(command: Command) -> anyhow::Result<bool> {
    match command {
        Command::Setup => setup::run(),
        Command::Test(options) => test::run(&options),
        // Without the target no claim on compiled code could be judged, and the sources would be blamed for it.
        Command::Audit(options) => setup::need_target().and_then(|()| audit::run(&options)),
        Command::Moved(options) => records::run(&options),
        Command::Structure(options) => structure::run(&options),
        Command::Campaign(options) if options.name == "worst" => worst::search(options.trials, options.seed),
        Command::Campaign(options) => campaign::run(&options),
        Command::Firmware(options) => firmware::run(&options),
        Command::MappingCounts => mapping_counts::run(),
        Command::Vcan(options) => vcan::run(&options),
        Command::Bench(options) => bench::run(&options),
        Command::CheckRecording(options) => check_recording::run(&options),
        Command::CheckRos2(options) => check_ros2::run(&options),
        Command::Lateness(options) => lateness::run(&options),
        Command::PanelCheck(options) => panel_check::run(&options),
        Command::Targets(options) => targets::run(&options),
        Command::Package(options) => package::run(&options),
        Command::SameBits(options) => same_bits::run(&options),
        Command::Figures(options) => figures::run(&options),
        Command::Reproduce(options) => reproduce::run(&options),
    }
}
