//! `floorguard goto X Y YAW`: the robot on real devices drives to a place of its map, and the program ends there.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use floorguard_configuration::NavigationConfiguration;
use floorguard_robot::navigator::{
    DriveOrders, NavigationPhase, NavigationPlan, NavigationProgress, NavigationSettings, NavigationSetup,
};
use floorguard_types::geometry::Pose2;

use super::exit::{BadInput, NotFinished};
use super::map_here::MapHere;
use super::run::{self, Errand, RunArguments, RunOutputs};
use super::values::coordinate;
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
    /// Then come back to where it was switched on, and stand there within a centimetre and a degree, by what its scanner saw there.
    #[arg(long)]
    pub dock: bool,
    /// The configuration, with the map in [navigation].
    #[arg(default_value = "robot.toml")]
    pub file: PathBuf,
    /// How long, and what is written of it.
    #[command(flatten)]
    pub outputs: RunOutputs,
}

/// Runs the command.
///
/// # Errors
/// As `run`; and the goal was not reached.
pub fn run(arguments: &GotoArguments) -> anyhow::Result<()> {
    let goal = Pose2::new(arguments.x, arguments.y, arguments.yaw.to_radians());
    let GotoArguments { file, outputs, .. } = arguments.clone();
    let json = outputs.json;
    let errand = if arguments.dock { Errand::Dock(goal) } else { Errand::Goal(goal) };
    conclude(&*driven((file, outputs), errand)?, json)
}

/// Runs the robot on an errand of driving, and gives how far it came.
///
/// # Errors
/// As `run`; and the drive never began.
pub(super) fn driven(
    (file, outputs): (PathBuf, RunOutputs),
    errand: Errand,
) -> anyhow::Result<Arc<NavigationProgress>> {
    let arguments = RunArguments { file, learn: None, map_here: MapHere::default(), outputs };
    let drive = run::run_to(&arguments, Some(errand))?;
    let progress = drive.and_then(|drive| drive.watch.get());
    progress.ok_or_else(|| NotFinished("the drive never began".to_owned()).into())
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

/// The drive of a configuration; a map that is too small for the robot is reported before anything moves.
pub(super) fn navigation_of(
    (file, folder): (&Path, &Path),
    configuration: &HostedConfiguration,
    errand: Option<Errand>,
) -> anyhow::Result<Option<NavigationSetup>> {
    let Some(errand) = errand else { return Ok(None) };
    let refuse = |error: anyhow::Error| BadInput(format!("{}: [navigation]: {error:#}", file.display()));
    let section: Option<&NavigationConfiguration> = configuration.navigation.as_ref();
    let missing = || anyhow::anyhow!("the section is missing; write [navigation] with map = \"hall.yaml\"");
    let docks = matches!(errand, Errand::Dock(_));
    let orders = matches!(errand, Errand::Ordered).then(DriveOrders::default);
    let plan = match errand {
        Errand::Goal(goal) | Errand::Dock(goal) => {
            let section = section.ok_or_else(missing).map_err(refuse)?;
            let plan = NavigationPlan::of_configuration(section, folder, goal);
            plan.map(|plan| if docks { plan.docking() } else { plan })
        }
        Errand::Tour(tour) => {
            let section = section.ok_or_else(missing).map_err(refuse)?;
            let places = tour.of_robot(&configuration.robot.lidar.mounting);
            let first = places.first().copied().unwrap_or_default();
            let plan = NavigationPlan::of_configuration(section, folder, first);
            plan.map(|plan| plan.touring(places.get(1..).unwrap_or_default()))
        }
        Errand::Ordered => {
            let section = section.ok_or_else(missing).map_err(refuse)?;
            let [x_m, y_m, heading_rad] = section.start;
            NavigationPlan::of_configuration(section, folder, Pose2::new(x_m, y_m, heading_rad))
        }
        Errand::Explore { side_m } => {
            let limits = &configuration.robot.limits;
            let section = section.cloned().unwrap_or_else(|| NavigationConfiguration::of_limits(limits));
            let [x_m, y_m, heading_rad] = section.start;
            let start = Pose2::new(x_m, y_m, heading_rad);
            NavigationPlan::exploring(NavigationSettings::from(&section), start, (side_m, 1))
        }
    };
    let plan = plan.map_err(refuse)?;
    let setup = NavigationSetup::new(plan).ordered_by(orders);
    setup.begin(&configuration.robot).map_err(refuse)?;
    Ok(Some(setup))
}
