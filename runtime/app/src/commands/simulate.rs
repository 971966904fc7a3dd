//! `floorguard simulate`: a scenario, judged by ground truth.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use floorguard_runtime::shared::RobotStatus;
use floorguard_sim::FaultSpec;
use floorguard_sim::scenario::Scenario;

use super::choices::{FittedImu, FittedLidar, FittedScanner};
use super::exit::{BadInput, NotFinished, VerdictFailed, WrongUsage};
use super::live::status_of;
use super::live_outputs::LiveOutputs;
use super::map_here::MapHere;
use super::ros2::RosWay;
use super::run_lesson::RunLesson;
use super::simulated_places::PlacesArguments;
use super::sinks::{SinkOutputs, open_sinks};
use super::values::{command_address, panel_address, parse_span, simulated_seconds};
use crate::fleets::fleet_broker;
use floorguard_configuration::{CommandAddress, CommandConfiguration, FleetConfiguration, did_you_mean};
use floorguard_laboratory::judge::Outcome;
use floorguard_laboratory::run_report::write_report;
use floorguard_laboratory::world::{
    Observation, Observer, Plan, SeenStop, SimulatedCamera, load_scenario, run_real_recorded, run_recorded,
};
use floorguard_operator::display::LiveDisplay;
use floorguard_operator::report::make_folder;
use floorguard_operator::telemetry::{RunSinks, Tape};
use floorguard_robot::assembly::Stages;
use floorguard_robot::camera::PictureFolder;
use floorguard_robot::cleaner::MissionStrategy;

/// What to simulate.
#[derive(Clone, Debug, Args)]
pub struct SimulateArguments {
    /// Name of the scenario, path of a scenario file, or `list`.
    #[arg(long)]
    pub scenario: String,
    /// Seed of all randomness.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Where to clean: what is dirty until that is guaranteed, lanes over the whole floor, or the scenario's route. Without it:
    /// the guarantee where the scenario has dirt, and the route without a mission elsewhere.
    #[arg(long, value_enum)]
    pub strategy: Option<MissionStrategy>,
    /// Simulated seconds.
    #[arg(long, default_value_t = 120.0, allow_negative_numbers = true, value_parser = simulated_seconds)]
    pub duration: f64,
    /// End as soon as the mission has nothing left to clean; --duration is then the longest that it may take.
    #[arg(long, conflicts_with = "tape")]
    pub until_clean: bool,
    /// Where to drive instead.
    #[command(flatten)]
    pub places: PlacesArguments,
    /// A fault, for example `lidar:drop=5%,from=10s,to=20s`; may be repeated.
    #[arg(long)]
    pub fault: Vec<String>,
    /// Press the emergency stop from one second to another, for example `20..25`; may be repeated.
    #[arg(long)]
    pub emergency_stop: Vec<String>,
    /// Write every byte that reaches the robot to this file, for the emulated board.
    #[arg(long)]
    pub tape: Option<PathBuf>,
    /// In real time over real carriers: UDP on the loopback, pseudo-terminals, SLCAN.
    #[arg(long, conflicts_with = "tape")]
    pub real_io: bool,
    /// In real time, driven from outside by velocities that come here, for example `udp:127.0.0.1:7000`, or `ros2:/cmd_vel` with
    /// the feature `ros2`, instead of the scenario's route.
    #[arg(long, value_name = "udp:ADDRESS:PORT|ros2:TOPIC", value_parser = command_address,
        conflicts_with_all = ["tape", "camera", "strategy", "until_clean"])]
    pub command: Option<CommandConfiguration>,
    /// The robot's lidar.
    #[arg(long, value_enum, default_value_t = FittedLidar::Vlp16)]
    pub lidar: FittedLidar,
    /// The robot's safety scanner.
    #[arg(long, value_enum, default_value_t = FittedScanner::S300)]
    pub scanner: FittedScanner,
    /// The robot's inertial sensor.
    #[arg(long, value_enum, default_value_t = FittedImu::XsensMti)]
    pub imu: FittedImu,
    /// Simulate the robot of this robot.toml: body, base, sensors and mountings, speeds, deadlines, thresholds, fields and
    /// [learning]; the scenario says what to drive and to clean. Sensors that are mounted at an angle are not played.
    #[arg(long, value_name = "robot.toml", conflicts_with_all = ["tape", "scanner", "imu"])]
    pub robot: Option<PathBuf>,
    /// Record the run: ROS 2 messages and every raw byte, for `replay`, `report` and other tools.
    #[arg(long, value_name = "FILE.mcap")]
    pub record: Option<PathBuf>,
    /// The drive as a map.
    #[command(flatten)]
    pub map_here: MapHere,
    /// With --real-io: an interface of the kernel as the CAN bus, for example vcan0, instead of SLCAN.
    #[arg(long, requires = "real_io")]
    pub can_interface: Option<String>,
    /// Render a floor camera: objects on the floor are driven round, and dirt is mapped. Takes as much time as all the
    /// rest.
    #[arg(long, conflicts_with_all = ["tape", "real_io"])]
    pub camera: bool,
    /// With --camera: write its pictures into this folder, from which `run` takes them as from a camera (`camera.toml`).
    #[arg(long, value_name = "FOLDER", requires = "camera")]
    pub pictures: Option<PathBuf>,
    /// Show the run live in a browser, in real time: `--panel 127.0.0.1:8080`.
    #[arg(long, value_name = "ADDRESS:PORT", value_parser = panel_address)]
    pub panel: Option<SocketAddr>,
    /// Keep what the panel keeps over the runs, areas, alerts and days, in this file.
    #[arg(long, value_name = "FILE.json", requires = "panel")]
    pub panel_records: Option<PathBuf>,
    /// What is shown live.
    #[command(flatten)]
    pub live: LiveOutputs,
    /// In real time, drive and clean where the master of a fleet orders (VDA 5050 over MQTT) instead of the mission or the route:
    /// `--fleet 127.0.0.1:1883/robot-7`. Needs the feature `fleet`.
    #[arg(long, value_name = "HOST:PORT/SERIAL", value_parser = fleet_broker, conflicts_with_all = ["tape", "strategy", "until_clean", "real_io", "driven", "command"])]
    pub fleet: Option<FleetConfiguration>,
    /// With --ros2, drive where /goal_pose orders instead of cleaning or the route.
    #[arg(long, requires = "ros2", conflicts_with_all = ["tape", "strategy", "until_clean", "real_io", "driven", "command", "fleet"])]
    pub ros2_goals: bool,
    /// One verdict object on standard output, no live status.
    #[arg(long)]
    pub json: bool,
    /// Let this environment model learn from the robot's list of people; made if there is none.
    #[arg(long)]
    pub learn: Option<PathBuf>,
    /// When the run begins, for what is learned: 2026-04-06T08:00; without it, after what the model knows.
    #[arg(long, requires = "learn")]
    pub start: Option<String>,
    /// Write the report with the picture to this folder.
    #[arg(long)]
    pub report: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Bad input, or a verdict that is not good enough.
pub fn run(arguments: &SimulateArguments) -> anyhow::Result<()> {
    if arguments.scenario == "list" {
        for name in Scenario::names() {
            tell!("{name:16} {}", Scenario::named(name)?.title)?;
        }
        return Ok(());
    }
    arguments.map_here.drive(arguments.record.as_deref(), |record| simulate(arguments, record.as_deref()))
}

fn simulate(arguments: &SimulateArguments, record: Option<&Path>) -> anyhow::Result<()> {
    let mut plan = plan(arguments)?;
    let ros = RosWay::of(arguments.live.ros2, None, &mut plan.command)?;
    let real_io = arguments.real_io || plan.command.is_some();
    if arguments.tape.is_some() {
        plan.stages = Stages::AsOnBoard;
    }
    if let Some(folder) = &arguments.report {
        make_folder(folder)?;
    }
    let mut sinks = RunSinks::default();
    if let Some(path) = &arguments.tape {
        // A path that cannot be written is reported before the run, and not after it.
        std::fs::write(path, []).map_err(|error| unwritable(path, &error))?;
        sinks.tape = Tape::new(&plan.robot, plan.duration_us);
    }
    let lesson = arguments.learn.as_deref();
    let lesson =
        lesson.map(|path| RunLesson::prepare((path, arguments.start.as_deref()), &plan)).transpose()?;
    let (panel, panel_records) = (arguments.panel, arguments.panel_records.clone());
    let (live, fleet) = (arguments.live.clone(), arguments.fleet.clone());
    open_sinks(&mut sinks, &plan, SinkOutputs { record, panel, panel_records, live, fleet, ros, real_io })?;
    let folder = arguments.pictures.as_deref();
    sinks.pictures =
        folder.map(|folder| PictureFolder::new(folder, SimulatedCamera::PICTURES)).transpose()?;
    let observation = if real_io {
        play_real((&plan, arguments.can_interface.as_deref()), arguments.json, &mut sinks)?
    } else {
        play(&plan, arguments.json, &mut sinks)?
    };
    if let Some(path) = &arguments.tape {
        std::fs::write(path, sinks.tape.finish()).map_err(|error| unwritable(path, &error))?;
    }
    if let Some(folder) = &arguments.report {
        write_report(folder, &plan, &observation)?;
    }
    if let Some(lesson) = lesson {
        lesson.learn(&observation)?;
    }
    conclude((&plan, &repeat(arguments)), &observation, arguments.json)
}

fn unwritable(path: &Path, error: &std::io::Error) -> BadInput {
    BadInput(format!("{}: cannot be written ({error}); give another place", path.display()))
}

/// The command that plays the same run: everything that the run depends on.
fn repeat(arguments: &SimulateArguments) -> String {
    let SimulateArguments { scenario, seed, duration, .. } = arguments;
    let mut words = format!("floorguard simulate --scenario {scenario} --seed {seed} --duration {duration}");
    let mut option = |name: &str, value: &str| words.push_str(&format!(" --{name} {value}"));
    if let Some(value) = arguments.strategy.and_then(|strategy| strategy.to_possible_value()) {
        option("strategy", value.get_name());
    }
    if let Some(value) = arguments.lidar.to_possible_value().filter(|_| arguments.lidar != FittedLidar::Vlp16)
    {
        option("lidar", value.get_name());
    }
    if let Some(value) =
        arguments.scanner.to_possible_value().filter(|_| arguments.scanner != FittedScanner::S300)
    {
        option("scanner", value.get_name());
    }
    if let Some(value) = arguments.imu.to_possible_value().filter(|_| arguments.imu != FittedImu::XsensMti) {
        option("imu", value.get_name());
    }
    arguments.places.repeat(&mut option);
    if let Some(robot) = &arguments.robot {
        option("robot", &robot.display().to_string());
    }
    match arguments.command.as_ref().map(|command| &command.address) {
        Some(CommandAddress::Datagrams(address)) => option("command", &format!("udp:{}", address.local)),
        Some(CommandAddress::Ros(topic)) => option("command", &format!("ros2:{}", topic.name)),
        Some(CommandAddress::Serial(_)) | None => {}
    }
    arguments.fault.iter().for_each(|fault| option("fault", fault));
    arguments.emergency_stop.iter().for_each(|span| option("emergency-stop", span));
    let switches = [
        (" --until-clean", arguments.until_clean),
        (" --camera", arguments.camera),
        (" --real-io", arguments.real_io),
        (" --ros2-goals", arguments.ros2_goals),
    ];
    for (name, wanted) in switches {
        words.push_str(if wanted { name } else { "" });
    }
    words
}

fn plan(arguments: &SimulateArguments) -> anyhow::Result<Plan> {
    let duration_us = (arguments.duration * 1.0e6) as u64;
    let mut plan = if Path::new(&arguments.scenario).extension().is_some() {
        let scenario = load_scenario(Path::new(&arguments.scenario))?;
        Plan::of(&arguments.scenario, scenario, arguments.seed, duration_us)?
    } else {
        Plan::named(&arguments.scenario, arguments.seed, duration_us)
            .map_err(|error| WrongUsage(format!("--scenario: {error}{}", meant(&arguments.scenario))))?
    };
    refuse_on_tape(arguments)?;
    if let Some(robot) = &arguments.robot {
        plan = plan.with_robot(robot).map_err(|error| BadInput(format!("{error:#}")))?;
    }
    if let Some(keys) = arguments.lidar.keys() {
        plan = plan.with_lidar(&keys)?;
    }
    plan = plan.with_scanner(arguments.scanner.model())?.with_imu(arguments.imu.model())?;
    plan.command.clone_from(&arguments.command);
    if arguments.fleet.is_some() {
        plan = plan.ordered()?.cleaning_on_order()?;
    } else if arguments.ros2_goals {
        plan = plan.ordered()?;
    } else if arguments.places.are_given() {
        plan = arguments.places.plan(plan)?;
    } else if arguments.tape.is_none() && plan.command.is_none() {
        plan = plan.cleaning(arguments.strategy)?;
    }
    plan.has_camera = arguments.camera;
    plan.until_clean = arguments.until_clean;
    if plan.until_clean && plan.mission.is_none() {
        let what = format!(
            "--until-clean: the scenario '{}' has no dirt to clean; give --strategy systematic",
            plan.name
        );
        return Err(WrongUsage(what).into());
    }
    for text in &arguments.fault {
        plan.faults.push(FaultSpec::parse(text).map_err(|error| WrongUsage(format!("--fault {error}")))?);
    }
    for text in &arguments.emergency_stop {
        let (from_us, to_us) = parse_span(text)?;
        if from_us >= duration_us {
            let seconds = arguments.duration;
            say!("  --emergency-stop {text}: nobody presses it, the run ends after {seconds} s");
        }
        plan.emergency_stop_us.push((from_us, to_us));
    }
    Ok(plan)
}

/// Refuses what the emulated board, which plays the tape, cannot hold.
fn refuse_on_tape(arguments: &SimulateArguments) -> Result<(), WrongUsage> {
    let beyond_the_board = [
        (arguments.strategy.is_some(), "drives the route and cannot hold a mission; leave --strategy out"),
        (arguments.scanner != FittedScanner::S300, "can hold the beams of an S300 only; leave --scanner out"),
        (arguments.imu != FittedImu::XsensMti, "reads an Xsens MTi only; leave --imu out"),
        (arguments.lidar != FittedLidar::Vlp16, "decodes Velodyne lidars only; leave --lidar out"),
    ];
    match beyond_the_board.into_iter().find(|(is_asked, _)| *is_asked && arguments.tape.is_some()) {
        Some((_, what)) => Err(WrongUsage(format!("--tape: the emulated board {what}"))),
        None => Ok(()),
    }
}

/// The scenario that was meant, if one is called nearly so.
fn meant(name: &str) -> String {
    let names: Vec<&str> = Scenario::names().collect();
    did_you_mean(name, &names).map(|meant| format!("; {meant}")).unwrap_or_default()
}

/// Plays a plan with a live display.
pub(super) fn play(plan: &Plan, quiet: bool, sinks: &mut RunSinks) -> anyhow::Result<Observation> {
    watched(plan, quiet, |observer| run_recorded(plan, observer, sinks)).map(|(observation, ())| observation)
}

/// The same in real time over real carriers.
pub(super) fn play_real(
    (plan, can_interface): (&Plan, Option<&str>),
    quiet: bool,
    sinks: &mut RunSinks,
) -> anyhow::Result<Observation> {
    let (observation, figures) =
        watched(plan, quiet, |observer| run_real_recorded((plan, can_interface), observer, sinks))?;
    let late_ms = figures.latest_us as f64 / 1_000.0;
    say!(
        "  real carriers: the simulator was late by {late_ms:.1} ms at most, {} messages refused by full lines",
        figures.refused
    );
    say!("  guard ring: {}", figures.guard);
    figures.window.iter().for_each(|window| say!("  window: {}", window.words()));
    Ok(observation)
}

fn watched<T>(
    plan: &Plan,
    quiet: bool,
    run: impl FnOnce(&mut Observer<'_>) -> anyhow::Result<T>,
) -> anyhow::Result<(Observation, T)> {
    let mut display = LiveDisplay::new(plan.duration_us as f64 * 1.0e-6, quiet);
    let mut show = |seconds: f64, status: &RobotStatus, people: usize, stops: &[SeenStop]| {
        if display.is_due(seconds) {
            let last = stops.last().map(|stop| format!("{:.1} s: {}", stop.at_s, stop.cause));
            display.show(&status_of(seconds, status, (people, stops.len() as u32, last)));
        }
    };
    let mut observer = Observer::new(plan, &mut show);
    let outcome = run(&mut observer)?;
    let observation = observer.into_observation();
    display.finish();
    Ok((observation, outcome))
}

/// Prints the verdict; an error when it is not good enough, with the command that repeats the run.
pub(super) fn conclude(
    (plan, repeat): (&Plan, &str),
    observation: &Observation,
    json: bool,
) -> anyhow::Result<()> {
    let verdict = &observation.verdict;
    if json {
        tell!("{}", serde_json::to_string(verdict)?)?;
    } else {
        say!("{}", floorguard_laboratory::run_report::summary(plan, observation).trim_end());
    }
    // The reason stands in the summary, right above.
    let reason = if json { &verdict.reason } else { "as above" };
    let what = format!("{reason}; repeat it with: {repeat}");
    match verdict.verdict {
        Outcome::Good => Ok(()),
        Outcome::Failed => Err(VerdictFailed(what).into()),
        Outcome::NotFinished => Err(NotFinished(what).into()),
    }
}

/// How long a run took, for people.
pub(super) fn pace(plan: &Plan, started: Instant) -> String {
    let took_s = started.elapsed().as_secs_f64();
    let robot_s = plan.duration_us as f64 * 1.0e-6;
    format!(
        "{robot_s:.0} s of robot time in {took_s:.1} s ({:.0} times real time)",
        robot_s / took_s.max(1.0e-3)
    )
}

#[cfg(test)]
#[path = "simulate_tests.rs"]
mod tests;
