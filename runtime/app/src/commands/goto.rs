//! `floorguard goto X Y YAW`: the robot on real devices drives to a place of its map, and the program ends there.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use clap::Args;
use floorguard_configuration::NavigationConfiguration;
use floorguard_robot::navigator::{NavigationPhase, NavigationPlan, NavigationProgress, NavigationSetup};
use floorguard_types::geometry::Pose2;

use super::exit::{BadInput, NotFinished};
use super::run::{self, RunArguments};
use super::values::{coordinate, panel_address, seconds};
use floorguard_configuration::HostedConfiguration;

/// Where to drive.
#[derive(Clone, Debug, Args)]
pub struct GotoArguments {
    /// Along x of the map, metres.
    #[arg(allow_negative_numbers = true, value_parser = coordinate)]
    pub x: f32,
    /// Along y of the map, metres.
    #[arg(allow_negative_numbers = true, value_parser = coordinate)]
    pub y: f32,
    /// Heading there, degrees counter-clockwise from x.
    #[arg(allow_negative_numbers = true, value_parser = coordinate)]
    pub yaw: f32,
    /// The configuration, with the map in [navigation].
    #[arg(default_value = "robot.toml")]
    pub file: PathBuf,
    /// Give up after so many seconds.
    #[arg(long, allow_negative_numbers = true, value_parser = seconds)]
    pub duration: Option<f64>,
    /// One object per line on standard output; the last one says how the drive ended.
    #[arg(long)]
    pub json: bool,
    /// Write the last ten seconds before each stop into this folder.
    #[arg(long)]
    pub black_box: Option<PathBuf>,
    /// Record the run, with plan and costmap.
    #[arg(long, value_name = "FILE.mcap")]
    pub record: Option<PathBuf>,
    /// Show the robot live in a browser: `--panel 127.0.0.1:8080`.
    #[arg(long, value_name = "ADDRESS:PORT", value_parser = panel_address)]
    pub panel: Option<SocketAddr>,
}

/// Runs the command.
///
/// # Errors
/// As `run`; and the goal was not reached.
pub fn run(arguments: &GotoArguments) -> anyhow::Result<()> {
    let goal = Pose2::new(arguments.x, arguments.y, arguments.yaw.to_radians());
    let run = RunArguments {
        file: arguments.file.clone(),
        duration: arguments.duration,
        json: arguments.json,
        black_box: arguments.black_box.clone(),
        learn: None,
        record: arguments.record.clone(),
        panel: arguments.panel,
    };
    match run::run_to(&run, Some(goal))? {
        Some(progress) => conclude(&progress, arguments.json),
        None => Err(NotFinished("the drive never began".to_owned()).into()),
    }
}

fn conclude(progress: &NavigationProgress, json: bool) -> anyhow::Result<()> {
    let at = progress.pose_in_map;
    if json {
        let line = serde_json::json!({
            "type": "goto", "reached": progress.phase == NavigationPhase::Reached, "phase": progress.phase.name(),
            "reason": progress.words, "x_m": at.x_m, "y_m": at.y_m, "yaw_deg": at.heading_rad.to_degrees(),
            "distance_m": progress.distance_m, "plans": progress.plans,
        });
        tell!("{line}")?;
    }
    say!("floorguard goto: {}, {:.1} m driven", progress.words, progress.distance_m);
    if progress.phase == NavigationPhase::Reached {
        return Ok(());
    }
    Err(NotFinished(format!("the goal is not reached: {}", progress.words)).into())
}

/// The drive of a configuration to a goal; a map that is too small for the robot is reported before anything moves.
pub(super) fn navigation_of(
    (file, folder): (&Path, &Path),
    configuration: &HostedConfiguration,
    goal: Option<Pose2>,
) -> anyhow::Result<Option<NavigationSetup>> {
    let Some(goal) = goal else { return Ok(None) };
    let refuse = |error: anyhow::Error| BadInput(format!("{}: [navigation]: {error:#}", file.display()));
    let section: Option<&NavigationConfiguration> = configuration.navigation.as_ref();
    let missing = || anyhow::anyhow!("the section is missing; write [navigation] with map = \"hall.yaml\"");
    let section = section.ok_or_else(missing).map_err(refuse)?;
    let plan = NavigationPlan::of_configuration(section, folder, goal).map_err(refuse)?;
    let setup = NavigationSetup::new(plan);
    setup.begin(&configuration.robot).map_err(refuse)?;
    Ok(Some(setup))
}
