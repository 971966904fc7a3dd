//! What a robot goes on with when it begins to run: what was latched, what it has learned, its mission.

use std::path::Path;

use floorguard_runtime::clock;

use super::exit::BadInput;
use super::run::RunArguments;
use crate::fleets::CleaningOffer;
use crate::robot_file::listed;
use floorguard_configuration::HostedConfiguration;
use floorguard_robot::assembly::{LatchFile, latched_words};
use floorguard_robot::cleaner::{CleaningOrders, MissionPlan, MissionSetup, Store};
use floorguard_robot::learning::LearningSetup;
use floorguard_robot::navigator::NavigationSetup;

/// Nothing drives with gaps of its sensors that the file does not accept by name.
pub(super) fn refuse_unaccepted(
    robot_toml: &Path,
    configuration: &HostedConfiguration,
) -> anyhow::Result<()> {
    let (_, refusals) = configuration.coverage();
    if refusals.is_empty() {
        return Ok(());
    }
    let file = robot_toml.display();
    let what =
        format!("{file}: {}\n`floorguard check {file} --picture unseen.svg` draws it", listed(&refusals));
    Err(BadInput(what).into())
}

/// What is latched outlives the computer, beside the robot's file.
pub(super) fn latches_of(robot_toml: &Path) -> LatchFile {
    let file = LatchFile::beside(robot_toml);
    let latches = file.read();
    if latches != 0 {
        say!("  latched when it ran last ({}): {}", file.path().display(), latched_words(latches));
    }
    file
}

/// How the robot learns what people look like, if the file says so.
pub(super) fn learning_of(
    (arguments, folder): (&RunArguments, &Path),
    configuration: &HostedConfiguration,
) -> anyhow::Result<Option<LearningSetup>> {
    let Some(learning) = &configuration.learning else { return Ok(None) };
    let setup = LearningSetup::open(learning, folder, &mut |what| say!("  {what}"));
    setup.map_err(|error| BadInput(format!("{}: {error:#}", arguments.file.display())).into())
}

/// What the robot cleans: the mission of the file, or beside a drive what a fleet's master orders of it.
pub(super) fn cleaning_of(
    (arguments, folder): (&RunArguments, &Path),
    configuration: &HostedConfiguration,
    drive: Option<&NavigationSetup>,
) -> anyhow::Result<(Option<MissionSetup>, Result<CleaningOffer, String>)> {
    let unordered = "no fleet orders what this robot cleans";
    let Some(drive) = drive else {
        return Ok((mission_of((arguments, folder), configuration)?, Err(unordered.to_owned())));
    };
    let setup = match ordered_mission_of(folder, configuration, drive) {
        Ok(setup) => setup,
        Err(why) => return Ok((None, Err(why))),
    };
    let offer = CleaningOffer::of(&setup.plan, setup.ordered.clone()).ok_or_else(|| unordered.to_owned());
    Ok((Some(setup), offer))
}

/// The mission of the file, begun or gone on with where it was broken off.
fn mission_of(
    (arguments, folder): (&RunArguments, &Path),
    configuration: &HostedConfiguration,
) -> anyhow::Result<Option<MissionSetup>> {
    let Some(mission) = &configuration.mission else { return Ok(None) };
    let refuse =
        |error: anyhow::Error| BadInput(format!("{}: [mission]: {error:#}", arguments.file.display()));
    let plan = MissionPlan::of_configuration(mission, folder).map_err(refuse)?;
    let setup = MissionSetup::new(plan, Store::File(folder.join(&mission.save)));
    // Before anything moves: a floor that is too small for the robot is reported now.
    let begun = setup.begin(&configuration.robot).map_err(refuse)?;
    say!("  mission: {}", begun.progress(clock::now()).words());
    Ok(Some(setup))
}

/// The mission of the file as a fleet's master orders it, part by part, beside a drive; or why it orders none.
fn ordered_mission_of(
    folder: &Path,
    configuration: &HostedConfiguration,
    drive: &NavigationSetup,
) -> Result<MissionSetup, String> {
    if configuration.fleet.is_none() || drive.orders.is_none() {
        return Err("no fleet orders what this robot does".to_owned());
    }
    let Some(mission) = &configuration.mission else {
        return Err("robot.toml has no [mission]; write one with the map of [navigation]".to_owned());
    };
    let map = configuration.navigation.as_ref().and_then(|navigation| navigation.map.as_ref());
    if map != Some(&mission.map) {
        return Err("the map of [mission] is not that of [navigation]; name the same file in both".to_owned());
    }
    let refuse = |error: anyhow::Error| format!("[mission]: {error:#}");
    let plan = MissionPlan::of_configuration(mission, folder).map_err(refuse)?;
    let orders = Some(CleaningOrders::default());
    let setup = MissionSetup::new(plan, Store::File(folder.join(&mission.save))).ordered_by(orders);
    // Before anything moves: a floor that is too small for the robot is reported now.
    setup.begin(&configuration.robot).map_err(refuse)?;
    Ok(setup)
}
