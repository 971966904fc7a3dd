//! `floorguard explore`: the robot drives over floor of which nothing is known until nothing that it can reach is unknown, and
//! the map is written.

use std::path::PathBuf;

use clap::Args;
use floorguard_host::words::counted;
use floorguard_mapping_host::output::{check_place, replace_folder};
use floorguard_robot::navigator::{NavigationPhase, NavigationProgress, SurveyedMap, locked};

use super::exit::{BadInput, NotFinished, WrongUsage};
use super::map_here::MapHere;
use super::run::{self, Errand, RunArguments, RunOutputs};
use super::values::side_m;

/// What to explore.
#[derive(Clone, Debug, Args)]
pub struct ExploreArguments {
    /// The configuration of the robot; of a simulated one, as --robot of `simulate`. Its [navigation] says how to drive.
    pub file: Option<PathBuf>,
    /// Write the map into this folder: `map.yaml` and `map.pgm` for `map_server`, the trajectory, the pose graph, a picture. A
    /// former map there is replaced.
    #[arg(long)]
    pub out: PathBuf,
    /// The robot stays within a square of this side around its start, metres.
    #[arg(long, default_value_t = 60.0, allow_negative_numbers = true, value_parser = side_m)]
    pub side: f32,
    #[cfg(feature = "laboratory")]
    /// Explore this scenario with a simulated robot instead: a name, or the path of a scenario file.
    #[arg(long, conflicts_with = "black_box")]
    pub scenario: Option<String>,
    #[cfg(feature = "laboratory")]
    /// Seed of all randomness of the simulation.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// How long, and what is written of it.
    #[command(flatten)]
    pub outputs: RunOutputs,
}

/// Runs the command.
///
/// # Errors
/// As `run`; the folder cannot take a map; and something that can be reached is still unknown (what is known is written all the
/// same).
pub fn run(arguments: &ExploreArguments) -> anyhow::Result<()> {
    check_place(&arguments.out).map_err(|error| WrongUsage(error.to_string()))?;
    #[cfg(feature = "laboratory")]
    if let Some(scenario) = &arguments.scenario {
        return super::explore_simulated::run(arguments, scenario);
    }
    let file = arguments.file.clone().unwrap_or_else(|| PathBuf::from("robot.toml"));
    let outputs = arguments.outputs.clone();
    let errand = Errand::Explore { side_m: arguments.side };
    let drive = run::run_to(
        &RunArguments { file, learn: None, map_here: MapHere::default(), outputs },
        Some(errand),
    )?;
    let never = || NotFinished("the exploration never began".to_owned());
    let drive = drive.ok_or_else(never)?;
    let progress = drive.watch.get().ok_or_else(never)?;
    let survey = drive.survey.as_ref().ok_or_else(never)?;
    let surveyed = locked(survey).finish().map_err(|error| NotFinished(format!("no map: {error:#}")))?;
    write(arguments, &surveyed)?;
    conclude(&progress, arguments.outputs.json)
}

/// Writes the map.
pub(super) fn write(arguments: &ExploreArguments, surveyed: &SurveyedMap) -> anyhow::Result<()> {
    replace_folder(&arguments.out, &surveyed.files).map_err(|error| BadInput(error.to_string()))?;
    let map = &surveyed.map;
    say!(
        "floorguard explore: {} ({} × {} cells of {:.2} m, {:.0} m² free; {} kept, {} recognised)",
        arguments.out.join("map.yaml").display(),
        map.columns,
        map.rows,
        map.cell_m,
        map.area_m2(floorguard_mapping::Occupancy::Free),
        counted(surveyed.kept_scans as u64, "scan"),
        counted(surveyed.loops as u64, "place")
    );
    Ok(())
}

fn conclude(progress: &NavigationProgress, json: bool) -> anyhow::Result<()> {
    let explored = progress.phase == NavigationPhase::Explored;
    if json {
        let exploration = progress.exploration.unwrap_or_default();
        let line = serde_json::json!({
            "type": "explore", "explored": explored, "phase": progress.phase.name(), "reason": progress.words,
            "known_m2": exploration.known_m2, "frontiers": exploration.frontiers,
            "left_out": exploration.left_out, "goals": exploration.goals, "distance_m": progress.distance_m,
        });
        tell!("{line}")?;
    }
    say!("floorguard explore: {}, {:.1} m driven", progress.words, progress.distance_m);
    if explored {
        return Ok(());
    }
    Err(NotFinished(format!("not everything is explored: {}", progress.words)).into())
}
