//! `floorguard run robot.toml`: the robot on real devices, until Ctrl-C.

mod drive;
mod service;
mod watch;

use std::io::{BufRead, IsTerminal};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::thread;

use clap::Args;
use floorguard_runtime::clock;

use self::drive::WatchedDrive;
use self::watch::Watch;
use super::exit::BadInput;
use super::goto::navigation_of;
use super::interrupt::end_at_ctrl_c;
use super::live_camera::LiveCamera;
use super::live_outputs::LiveOutputs;
use super::map_here::MapHere;
use super::panel::{PanelOpening, open_panel, records_beside};
use super::ros2::{RosEnds, RosWay};
use super::run_begin::{cleaning_of, latches_of, learning_of, refuse_unaccepted};
use super::tour::TourPlaces;
use super::values::{panel_address, seconds};
use crate::fleets::{CleaningOffer, FleetOpening, join};
use crate::robot_file::say_absences;
use crate::window::leave_window;
use floorguard_configuration::{CommandConfiguration, HostedConfiguration, ImuAddress, load};
use floorguard_host::executor::{Ring, StopFlag, take_priority};
use floorguard_host::words::counted;
use floorguard_operator::report::make_folder;
use floorguard_operator::telemetry::{RecordedRun, RunSinks, with_telemetry};
use floorguard_robot::actuated::{WindowLinks, WindowWatch, watch_window};
use floorguard_robot::assembly::new_shared;
use floorguard_robot::assembly::{HostedShared, Links, run_rings};
use floorguard_robot::camera::open_source;
use floorguard_robot::cleaner::MissionPlan;
use floorguard_robot::environment::{Calendar, LiveLearner};
use floorguard_robot::learning::LearningSetup;
use floorguard_robot::navigator::{DriveOrders, NavigationPlan, NavigationSettings, NavigationSetup};
use floorguard_types::geometry::Pose2;

/// Stands in the recording of a robot without an inertial sensor.
const IMU_BAUD: u32 = 115_200;

/// What to run.
#[derive(Clone, Debug, Args)]
pub struct RunArguments {
    /// The configuration; `floorguard check` explains its mistakes.
    pub file: PathBuf,
    /// Let this environment model learn from the list of people, saved every minute; made if there is none. Places are
    /// relative to where the robot was switched on.
    #[arg(long)]
    pub learn: Option<PathBuf>,
    /// The drive as a map.
    #[command(flatten)]
    pub map_here: MapHere,
    /// How long, and what is written of it.
    #[command(flatten)]
    pub outputs: RunOutputs,
}

/// How long the robot runs on real devices, and what is written of it: the same for `run` and `goto`.
#[derive(Clone, Debug, Default, Args)]
pub struct RunOutputs {
    /// End after so many seconds instead of at Ctrl-C; a drive to a goal is given up then.
    #[arg(long, allow_negative_numbers = true, value_parser = seconds)]
    pub duration: Option<f64>,
    /// One object per line on standard output: a status every second, and every stop. With `goto` the last one says how the
    /// drive ended.
    #[arg(long)]
    pub json: bool,
    /// Write the last ten seconds before each stop into this folder.
    #[arg(long)]
    pub black_box: Option<PathBuf>,
    /// Record the run: ROS 2 messages and every raw byte, for `replay`, `report` and other tools.
    #[arg(long, value_name = "FILE.mcap")]
    pub record: Option<PathBuf>,
    /// Write the window and the plan of the lidar that a motor turns into this folder at the end.
    #[arg(long, value_name = "DIR")]
    pub window: Option<PathBuf>,
    /// Show the robot live in a browser: `--panel 127.0.0.1:8080`.
    #[arg(long, value_name = "ADDRESS:PORT", value_parser = panel_address)]
    pub panel: Option<SocketAddr>,
    /// What is shown live.
    #[command(flatten)]
    pub live: LiveOutputs,
}

/// Runs the command.
///
/// # Errors
/// The configuration is refused, the lidar's port is taken, or a ring failed.
pub fn run(arguments: &RunArguments) -> anyhow::Result<()> {
    arguments.map_here.drive(arguments.outputs.record.as_deref(), |record| {
        let mut arguments = arguments.clone();
        arguments.outputs.record = record;
        run_to(&arguments, None).map(drop)
    })
}

/// Opens the lines to the devices, and the one on which velocities come.
fn bind_links(configuration: &HostedConfiguration) -> anyhow::Result<Links> {
    let links = Links::bind(&configuration.carriers);
    let links = links.and_then(|links| links.commanded(configuration.command.as_ref()));
    Ok(links.map_err(|error| BadInput(error.to_string()))?)
}

/// Opens what the lidar on a motor needs, if there is one.
fn bind_window(configuration: &HostedConfiguration) -> anyhow::Result<(Option<WindowLinks>, WindowWatch)> {
    let links = configuration.carriers.actuated_lidar.as_ref().map(WindowLinks::bind).transpose();
    Ok((links.map_err(|error| BadInput(error.to_string()))?, WindowWatch::default()))
}

/// What a run is for, where it ends by itself.
#[derive(Clone, Debug)]
pub(super) enum Errand {
    /// To drive there.
    Goal(Pose2),
    /// To drive there and back to where it was switched on.
    Dock(Pose2),
    /// To look from these places, one after another.
    Tour(TourPlaces),
    /// To drive where somebody outside orders.
    Ordered,
    /// To map a square of this side around the start, metres.
    Explore { side_m: f32 },
}

/// Who learns where people walk, into the file of `--learn`.
fn learner_of(
    arguments: &RunArguments,
    configuration: &HostedConfiguration,
) -> Result<Option<LiveLearner>, BadInput> {
    let open = |path: &PathBuf| {
        let mounting = configuration.robot.guard().scanner.mounting;
        LiveLearner::open(path, mounting, Calendar::now())
            .map_err(|error| BadInput(format!("{}: {error:#}", path.display())))
    };
    arguments.learn.as_ref().map(open).transpose()
}

/// The same on an errand: the run ends with it, or where it is given up. Gives the drive with its last progress.
///
/// # Errors
/// As [`run`]; and the configuration has no map.
pub(super) fn run_to(
    arguments: &RunArguments,
    errand: Option<Errand>,
) -> anyhow::Result<Option<NavigationSetup>> {
    let mut configuration = load(&arguments.file)?;
    refuse_unaccepted(&arguments.file, &configuration)?;
    let folder = arguments.file.parent().unwrap_or(Path::new("."));
    let source =
        configuration.carriers.camera.as_ref().map(|camera| open_source(camera, folder)).transpose()?;
    let (ros, driver) = ros_way(arguments, &mut configuration)?;
    let mut links = bind_links(&configuration)?;
    let (window_links, window) = bind_window(&configuration)?;
    let began = clock::now();
    let shared: Box<HostedShared> = new_shared(&configuration.robot, began)
        .map_err(|error| BadInput(format!("{}: {error}", arguments.file.display())))?;
    let flag = StopFlag::default();
    end_at_ctrl_c(&flag, "the robot is brought to a stand")?;
    introduce(&arguments.file, &configuration, driver.as_deref());
    if let Some(folder) = &arguments.outputs.black_box {
        make_folder(folder)?;
    }
    let mut watch = Watch::new(arguments, &shared);
    watch.notices = Some(links.notices());
    watch.learner = learner_of(arguments, &configuration)?;
    let learning = learning_of((arguments, folder), &configuration)?;
    watch.learned = learning.as_ref().map(LearningSetup::writer);
    let errand = errand.or_else(|| takes_orders(&configuration).then_some(Errand::Ordered));
    let navigation = navigation_of((&arguments.file, folder), &configuration, errand)?;
    let (mission, offer) = cleaning_of((arguments, folder), &configuration, navigation.as_ref())?;
    let reported = Reported {
        mission: mission.as_ref().filter(|one| one.ordered.is_none()).map(|one| &one.plan),
        navigation: navigation.as_ref().map(|drive| &drive.plan),
        learning: learning.as_ref(),
        ros: ros.open(navigation.as_ref().and_then(orders_of))?,
    };
    let mut sinks = open_sinks(arguments, &configuration, reported)?;
    join_fleet(&mut sinks, (&configuration, folder), navigation.as_ref().zip(Some(offer)))?;
    watch.drive = navigation.clone().map(WatchedDrive::new);
    links.navigation.clone_from(&navigation);
    watch.mission.clone_from(&mission);
    mission.iter().for_each(|mission| sinks.set_mission(mission));
    links.mission = mission;
    links.learning = learning;
    links.latches = Some(latches_of(&arguments.file));
    let lateness = links.lateness.clone();
    with_telemetry(&mut sinks, &shared, |tap, notes| {
        links.tap = tap.inspect(|tap| tap.began(began));
        let inbox = links.people.clone();
        run_rings((&configuration.robot, links), &shared, &flag, || {
            let typed = typed_lines();
            // The display reads what the rings share; the word for it is on the console already.
            let _ = take_priority(Ring::Telemetry);
            let camera =
                LiveCamera { configuration: &configuration, notes, has_json: arguments.outputs.json };
            let looked = || watch.until_stopped(&flag, &typed, notes);
            watch_window(window_links, (&shared, &inbox), &window, || {
                camera.watch(source, (&shared, &inbox), looked);
            });
        })
    })?;
    finish(&mut watch, &window, arguments.outputs.window.as_deref())?;
    say!("floorguard run: guard ring {}", lateness.figures());
    say!("floorguard run: the robot stands, {}", counted(watch.stops, "stop"));
    all_written(watch.unwritten.as_ref())?;
    Ok(navigation)
}

/// What was learned, and the window that the lidar on a motor has left.
fn finish(watch: &mut Watch<'_>, window: &WindowWatch, folder: Option<&Path>) -> anyhow::Result<()> {
    if let Some(learner) = watch.learner.take() {
        let positions = learner.finish(Calendar::now())?;
        say!("floorguard run: learned {positions} positions of people");
    }
    watch.reports_learned_state();
    window.report().iter().for_each(|report| say!("floorguard run: window: {}", report.words()));
    leave_window(folder, window)
}

/// How to operate it, what this robot does without, and who drives it.
fn introduce(file: &Path, configuration: &HostedConfiguration, driver: Option<&str>) {
    say!("floorguard run: {}; Ctrl-C ends it; r and Enter resets, s and Enter starts", file.display());
    say_absences(configuration);
    if let Some(driver) = driver {
        say!("  driven from outside: {driver}");
    }
}

/// The robot outlives a full disk; the user is notified at the end.
fn all_written(unwritten: Option<&(u64, String)>) -> anyhow::Result<()> {
    let Some((files, first)) = unwritten else { return Ok(()) };
    let files = counted(*files, "file");
    Err(BadInput(format!("the run went on; {files} could not be written, the first: {first}")).into())
}

/// What a recording says of the run, and ROS 2 where it hears it.
struct Reported<'a> {
    mission: Option<&'a MissionPlan>,
    navigation: Option<&'a NavigationPlan>,
    learning: Option<&'a LearningSetup>,
    ros: Option<RosEnds>,
}

/// The bridge to ROS 2 that is asked for, and who drives from outside, in words.
fn ros_way(
    arguments: &RunArguments,
    configuration: &mut HostedConfiguration,
) -> anyhow::Result<(RosWay, Option<String>)> {
    let driver = configuration.command.as_ref().map(CommandConfiguration::in_words);
    let asked = arguments.outputs.live.ros2;
    Ok((RosWay::of(asked, configuration.ros2.as_ref(), &mut configuration.command)?, driver))
}

/// Where a drive takes its orders, if it does.
fn orders_of(drive: &NavigationSetup) -> Option<(DriveOrders, NavigationSettings)> {
    Some((drive.orders.clone()?, drive.plan.settings))
}

/// Somebody outside orders where the robot drives: a fleet's master, or a program of ROS 2.
fn takes_orders(configuration: &HostedConfiguration) -> bool {
    configuration.fleet.is_some() || configuration.ros2.is_some_and(|section| section.goals)
}

/// A recording and a panel, where they are wanted.
fn open_sinks(
    arguments: &RunArguments,
    configuration: &HostedConfiguration,
    reported: Reported<'_>,
) -> anyhow::Result<RunSinks> {
    let name = arguments.file.display().to_string();
    let robot = &configuration.robot;
    let mut sinks = RunSinks::default();
    let text =
        std::fs::read_to_string(&arguments.file).map_err(|error| BadInput(format!("{name}: {error}")))?;
    let imu_line = configuration.carriers.imu.as_ref().and_then(ImuAddress::line);
    let imu_baud = imu_line.map_or(IMU_BAUD, |line| line.baud);
    let Reported { mission, navigation, learning, ros } = reported;
    let run = RecordedRun { robot, robot_toml: &text, imu_baud, mission, navigation, learning };
    let live = &arguments.outputs.live;
    sinks.compression = live.record_compression.into();
    if let Some(path) = &arguments.outputs.record {
        sinks.record_devices(&run, &name, path)?;
    }
    if let Some(listener) = live.open(&name)? {
        sinks.watch_live(&run, listener)?;
    }
    if let Some((listener, link)) = ros {
        sinks.watch_live(&run, listener)?;
        sinks.links.push(link);
    }
    if let Some(address) = arguments.outputs.panel {
        let records = Some(records_beside(&arguments.file));
        let mut panel = open_panel(
            address,
            PanelOpening { title: &name, robot, records, configured: configuration.panel.clone() },
        )?;
        panel.set_clock_start(clock::now());
        sinks.panel = Some(panel);
    }
    Ok(sinks)
}

/// A robot with `[fleet]` drives and cleans where its master orders.
fn join_fleet(
    sinks: &mut RunSinks,
    (configuration, folder): (&HostedConfiguration, &Path),
    ordered: Option<(&NavigationSetup, Result<CleaningOffer, String>)>,
) -> anyhow::Result<()> {
    let orders = ordered.and_then(|(drive, cleaning)| Some((drive, drive.orders.clone()?, cleaning)));
    let (Some(fleet), Some((drive, orders, cleaning))) = (&configuration.fleet, orders) else {
        return Ok(());
    };
    let (robot, settings) = (&configuration.robot, drive.plan.settings);
    sinks.links.push(join(FleetOpening { fleet, folder: Some(folder), robot, settings, orders, cleaning })?);
    Ok(())
}

/// Lines from a terminal; a pipe is not an operator.
fn typed_lines() -> Receiver<String> {
    let (sender, receiver) = channel();
    if std::io::stdin().is_terminal() {
        thread::spawn(move || {
            for line in std::io::stdin().lock().lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
    }
    receiver
}

#[cfg(test)]
#[path = "run_tests.rs"]
mod tests;
