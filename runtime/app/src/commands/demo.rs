//! `floorguard demo`: three simulated minutes of a supermarket, a verdict, and a report with a picture.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum as _};

use super::exit::BadInput;
use super::ros2::{RosDomain, RosWay, ros_domain};
use super::simulate::{conclude, pace, play, play_real};
use super::sinks::{SinkOutputs, open_sinks};
use super::values::{panel_address, simulated_seconds};
use floorguard_laboratory::run_report::write_report;
use floorguard_laboratory::world::Plan;
use floorguard_operator::report::make_folder;
use floorguard_operator::telemetry::RunSinks;
use floorguard_robot::cleaner::MissionStrategy;

/// How to show the demo.
#[derive(Clone, Debug, Args)]
pub struct DemoArguments {
    /// Seed of all randomness.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Where to clean: what is dirty until that is guaranteed, lanes over the whole floor, or the scenario's route. Without it:
    /// the guarantee where the scenario has dirt, and the route without a mission elsewhere.
    #[arg(long, value_enum)]
    pub strategy: Option<MissionStrategy>,
    /// Simulated seconds.
    #[arg(long, default_value_t = 180.0, allow_negative_numbers = true, value_parser = simulated_seconds)]
    pub duration: f64,
    /// In real time over real carriers: UDP on the loopback, pseudo-terminals, SLCAN.
    #[arg(long)]
    pub real_io: bool,
    /// Where to write the report.
    #[arg(long, default_value = "floorguard-report")]
    pub report: PathBuf,
    /// Record the run: ROS 2 messages and every raw byte, for `replay`, `report` and other tools.
    #[arg(long, value_name = "FILE.mcap")]
    pub record: Option<PathBuf>,
    /// With the robot of this robot.toml: body, base, sensors and mountings, speeds, deadlines, thresholds, fields and [learning].
    #[arg(long, value_name = "robot.toml")]
    pub robot: Option<PathBuf>,
    /// Render a floor camera: objects on the floor are driven round, and dirt is mapped. Takes as much time as all the
    /// rest.
    #[arg(long, conflicts_with = "real_io")]
    pub camera: bool,
    /// Show the run live in a browser, in real time: `--panel 127.0.0.1:8080`.
    #[arg(long, value_name = "ADDRESS:PORT", value_parser = panel_address)]
    pub panel: Option<SocketAddr>,
    /// Show the run live in ROS 2, in real time, as `simulate --ros2` does. Needs the feature `ros2`.
    #[arg(long, value_name = "DOMAIN", num_args = 0..=1, require_equals = true, default_missing_value = "", value_parser = ros_domain)]
    pub ros2: Option<RosDomain>,
}

impl Default for DemoArguments {
    fn default() -> Self {
        Self {
            seed: 1,
            strategy: None,
            duration: 180.0,
            real_io: false,
            camera: false,
            report: PathBuf::from("floorguard-report"),
            record: None,
            robot: None,
            panel: None,
            ros2: None,
        }
    }
}

/// Runs the command.
///
/// # Errors
/// Bad input, or a verdict that is not good enough.
pub fn run(arguments: &DemoArguments) -> anyhow::Result<()> {
    let started = Instant::now();
    let mut plan = Plan::named("supermarket", arguments.seed, (arguments.duration * 1.0e6) as u64)?;
    if let Some(robot) = &arguments.robot {
        plan = plan.with_robot(robot).map_err(|error| BadInput(format!("{error:#}")))?;
    }
    plan = plan.cleaning(arguments.strategy)?;
    plan.has_camera = arguments.camera;
    say!("floorguard demo: {} (seed {})", plan.scenario.title, plan.seed);
    make_folder(&arguments.report)?;
    let mut sinks = RunSinks::default();
    let (record, panel) = (arguments.record.as_deref(), arguments.panel);
    let real_io = arguments.real_io;
    let ros = RosWay::of(arguments.ros2, None, &mut None)?;
    open_sinks(&mut sinks, &plan, SinkOutputs { record, panel, real_io, ros, ..SinkOutputs::default() })?;
    let observation = if arguments.real_io {
        play_real((&plan, None), false, &mut sinks)?
    } else {
        play(&plan, false, &mut sinks)?
    };
    let page = write_report(&arguments.report, &plan, &observation)?;
    say!("{}", pace(&plan, started));
    let repeat = repeat_demo(arguments);
    let outcome = conclude((&plan, &repeat), &observation, false);
    say!("report: {}", page.display());
    outcome
}

/// The command that plays the same demo.
fn repeat_demo(arguments: &DemoArguments) -> String {
    let DemoArguments { seed, duration, .. } = arguments;
    let mut words = format!("floorguard demo --seed {seed} --duration {duration}");
    if let Some(value) = arguments.strategy.and_then(|strategy| strategy.to_possible_value()) {
        words.push_str(&format!(" --strategy {}", value.get_name()));
    }
    if let Some(robot) = &arguments.robot {
        words.push_str(&format!(" --robot {}", robot.display()));
    }
    for (name, wanted) in [(" --camera", arguments.camera), (" --real-io", arguments.real_io)] {
        words.push_str(if wanted { name } else { "" });
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn demo_repeat_command_is_complete() {
        let arguments = DemoArguments {
            strategy: Some(MissionStrategy::Systematic),
            robot: Some(PathBuf::from("mine.toml")),
            camera: true,
            ..DemoArguments::default()
        };
        let words =
            "floorguard demo --seed 1 --duration 180 --strategy systematic --robot mine.toml --camera";
        assert_eq!(repeat_demo(&arguments), words);
    }
}
