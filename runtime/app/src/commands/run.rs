//! `floorguard run robot.toml`: the robot on real devices, until Ctrl-C.

use std::io::{BufRead, IsTerminal};
use std::mem::Discriminant;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use floorguard_drivers::canopen::NodePhase;
use floorguard_drivers::velodyne::DecodeError;
use floorguard_guard::GuardState;
use floorguard_runtime::clock;
use floorguard_runtime::shared::{BusReport, Complaints, RobotStatus, StopRecord};
use serde_json::json;

use super::exit::BadInput;
use super::interrupt::end_at_ctrl_c;
use super::live::status_of;
use super::live_camera::LiveCamera;
use super::panel::open_panel;
use super::run_begin::{latches_of, learning_of, mission_of};
use super::values::{panel_address, seconds};
use floorguard_configuration::{HostedConfiguration, load};
use floorguard_host::console::Lines;
use floorguard_host::executor::{Ring, StopFlag, take_priority};
use floorguard_host::words::counted;
use floorguard_operator::display::LiveDisplay;
use floorguard_operator::panel::{HeldHistory, Order, remedy};
use floorguard_operator::report::make_folder;
use floorguard_operator::telemetry::{RecordedRun, RunSinks, TelemetrySender, with_telemetry};
use floorguard_robot::assembly::new_shared;
use floorguard_robot::assembly::{HostedShared, Links, run_rings, write_stop_file};
use floorguard_robot::camera::open_source;
use floorguard_robot::cleaner::{MissionPhase, MissionPlan, MissionProgress, MissionSetup};
use floorguard_robot::environment::{Calendar, LiveLearner};
use floorguard_robot::learning::{LearningReport, LearningSetup, LearningWriter};

/// How often the display reads the robot's state.
const POLL_PERIOD: Duration = Duration::from_millis(50);
/// Stands in the recording of a robot without an inertial sensor.
const IMU_BAUD: u32 = 115_200;
/// With `--json` a status comes this often, seconds.
const JSON_STATUS_S: f64 = 1.0;

/// A device on the CAN bus that has not been heard of for so long is named.
const SILENT_AFTER: Duration = Duration::from_secs(3);
/// A word on the mission comes this often, seconds.
const MISSION_WORD_S: f64 = 10.0;

/// What to run.
#[derive(Clone, Debug, Args)]
pub struct RunArguments {
    /// The configuration; `floorguard check` explains its mistakes.
    pub file: PathBuf,
    /// End after so many seconds instead of at Ctrl-C.
    #[arg(long, allow_negative_numbers = true, value_parser = seconds)]
    pub duration: Option<f64>,
    /// One object per line on standard output: a status every second, and every stop.
    #[arg(long)]
    pub json: bool,
    /// Write the last ten seconds before each stop into this folder.
    #[arg(long)]
    pub black_box: Option<PathBuf>,
    /// Let this environment model learn from the list of people, saved every minute; made if there is none. Places are
    /// relative to where the robot was switched on.
    #[arg(long)]
    pub learn: Option<PathBuf>,
    /// Record the run: ROS 2 messages and every raw byte, for `replay`, `report` and other tools.
    #[arg(long, value_name = "FILE.mcap")]
    pub record: Option<PathBuf>,
    /// Show the robot live in a browser: `--panel 127.0.0.1:8080`.
    #[arg(long, value_name = "ADDRESS:PORT", value_parser = panel_address)]
    pub panel: Option<SocketAddr>,
}

/// Runs the command.
///
/// # Errors
/// The configuration is refused, the lidar's port is taken, or a ring failed.
pub fn run(arguments: &RunArguments) -> anyhow::Result<()> {
    let configuration = load(&arguments.file)?;
    let folder = arguments.file.parent().unwrap_or(Path::new("."));
    let source =
        configuration.carriers.camera.as_ref().map(|camera| open_source(camera, folder)).transpose()?;
    let mut links = Links::bind(&configuration.carriers).map_err(|error| BadInput(error.to_string()))?;
    let began = clock::now();
    let shared: Box<HostedShared> = new_shared(&configuration.robot, began)
        .map_err(|error| BadInput(format!("{}: {error}", arguments.file.display())))?;
    let flag = StopFlag::default();
    end_at_ctrl_c(&flag, "the robot is brought to a stand")?;
    say!(
        "floorguard run: {}; Ctrl-C ends it; r and Enter resets, s and Enter starts",
        arguments.file.display()
    );
    if let Some(folder) = &arguments.black_box {
        make_folder(folder)?;
    }
    let mut watch = Watch::new(arguments, &shared);
    watch.notices = Some(links.notices());
    if let Some(path) = &arguments.learn {
        let mounting = configuration.robot.guard().scanner.mounting;
        let learner = LiveLearner::open(path, mounting, Calendar::now());
        watch.learner = Some(learner.map_err(|error| BadInput(format!("{}: {error:#}", path.display())))?);
    }
    let learning = learning_of((arguments, folder), &configuration)?;
    watch.learned = learning.as_ref().map(LearningSetup::writer);
    let mission = mission_of((arguments, folder), &configuration)?;
    let plan = mission.as_ref().map(|mission| &mission.plan);
    let mut sinks = open_sinks(arguments, &configuration, (plan, learning.as_ref()))?;
    watch.mission.clone_from(&mission);
    links.mission = mission;
    links.learning = learning;
    links.latches = Some(latches_of(&arguments.file));
    with_telemetry(&mut sinks, &shared, |tap, notes| {
        links.tap = tap.inspect(|tap| tap.began(began));
        let inbox = links.people.clone();
        run_rings((&configuration.robot, links), &shared, &flag, || {
            let typed = typed_lines();
            // The display reads what the rings share; the word for it is on the console already.
            let _ = take_priority(Ring::Telemetry);
            let camera = LiveCamera { configuration: &configuration, notes, has_json: arguments.json };
            camera.watch(source, (&shared, &inbox), || watch.until_stopped(&flag, &typed, notes));
        })
    })?;
    if let Some(learner) = watch.learner.take() {
        let positions = learner.finish(Calendar::now())?;
        say!("floorguard run: learned {positions} positions of people");
    }
    watch.reports_learned_state();
    say!("floorguard run: the robot stands, {}", counted(watch.stops, "stop"));
    all_written(watch.unwritten.as_ref())
}

/// The robot outlives a full disk; the user is notified at the end.
fn all_written(unwritten: Option<&(u64, String)>) -> anyhow::Result<()> {
    let Some((files, first)) = unwritten else { return Ok(()) };
    let files = counted(*files, "file");
    Err(BadInput(format!("the run went on; {files} could not be written, the first: {first}")).into())
}

/// A recording and a panel, where they are wanted.
fn open_sinks(
    arguments: &RunArguments,
    configuration: &HostedConfiguration,
    reported: (Option<&MissionPlan>, Option<&LearningSetup>),
) -> anyhow::Result<RunSinks> {
    let name = arguments.file.display().to_string();
    let robot = &configuration.robot;
    let mut sinks = RunSinks::default();
    if let Some(path) = &arguments.record {
        let text =
            std::fs::read_to_string(&arguments.file).map_err(|error| BadInput(format!("{name}: {error}")))?;
        let imu_baud = configuration.carriers.imu.as_ref().map_or(IMU_BAUD, |line| line.baud);
        let run =
            RecordedRun { robot, robot_toml: &text, imu_baud, mission: reported.0, learning: reported.1 };
        sinks.record_devices(&run, &name, path)?;
    }
    if let Some(address) = arguments.panel {
        let mut panel = open_panel(address, &name, robot)?;
        panel.set_clock_start(clock::now());
        sinks.panel = Some(panel);
    }
    Ok(sinks)
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

/// What is wrong, without the figures, which are others for each datagram.
fn kind(error: &DecodeError) -> Discriminant<DecodeError> {
    std::mem::discriminant(error)
}

/// A line for each device that has not been heard of.
fn silent_devices(report: &BusReport) -> Vec<String> {
    let silent = report.devices.iter().filter(|device| device.phase == NodePhase::Absent);
    silent.map(|device| format!("  {device}")).collect()
}

/// Shows the robot while it runs.
struct Watch<'a> {
    arguments: &'a RunArguments,
    shared: &'a HostedShared,
    display: LiveDisplay,
    began: Instant,
    next_json_s: f64,
    stops: u32,
    last_stop: Option<String>,
    history: HeldHistory,
    bus: Option<BusReport>,
    /// The devices on the bus that have not been heard of are named.
    silent_reported: bool,
    complaints: Complaints,
    learner: Option<LiveLearner>,
    learned: Option<LearningWriter>,
    mission: Option<MissionSetup>,
    reported: u32,
    is_done: bool,
    next_mission_s: f64,
    lines: Lines,
    /// How many files could not be written, and why the first.
    unwritten: Option<(u64, String)>,
    notices: Option<Receiver<String>>,
}

impl<'a> Watch<'a> {
    fn new(arguments: &'a RunArguments, shared: &'a HostedShared) -> Self {
        let display = LiveDisplay::new(arguments.duration.unwrap_or(0.0), arguments.json);
        let began = Instant::now();
        Self {
            arguments,
            shared,
            display,
            began,
            next_json_s: 0.0,
            stops: 0,
            last_stop: None,
            history: HeldHistory::default(),
            bus: None,
            silent_reported: false,
            complaints: Complaints::default(),
            learner: None,
            learned: None,
            mission: None,
            reported: 0,
            is_done: false,
            next_mission_s: 0.0,
            lines: Lines::default(),
            unwritten: None,
            notices: None,
        }
    }

    fn until_stopped(&mut self, flag: &StopFlag, typed: &Receiver<String>, notes: &TelemetrySender<'_>) {
        let ends_s = self.arguments.duration.unwrap_or(f64::INFINITY);
        while !flag.is_stopped() && self.began.elapsed().as_secs_f64() < ends_s {
            thread::sleep(POLL_PERIOD);
            for line in typed.try_iter() {
                match line.trim() {
                    "r" | "R" => notes.order(Order::Reset),
                    "s" | "S" => notes.order(Order::Start),
                    _ => {}
                }
            }
            while let Some(stop) = self.shared.stops.try_pop() {
                notes.stop(&stop);
                self.on_stop(&stop);
            }
            let learned = self.learner.as_mut().map(|learner| learner.learn(self.shared, Calendar::now()));
            self.written(learned.unwrap_or(Ok(())));
            self.on_learning();
            if let Some(progress) = self.news_of_mission() {
                notes.mission(&progress);
                self.on_mission(&progress);
            }
            if let Some(report) = self.shared.bus.get() {
                self.on_bus(&report);
            }
            self.on_complaints(&self.shared.complaints());
            for notice in self.notices.iter().flat_map(Receiver::try_iter) {
                self.display.note(&format!("  {notice}"));
            }
            if let Some(status) = self.shared.status.get() {
                self.on_status(&status);
            }
        }
    }

    /// A failed write is reported and does not hold up the robot.
    fn written(&mut self, outcome: anyhow::Result<()>) {
        let Err(error) = outcome else { return };
        let what = format!("{error:#}");
        // Reported once: a full disk stays full, and the robot may run for months.
        let (files, _) = self.unwritten.get_or_insert_with(|| {
            self.display.note(&format!("  {what}; the robot goes on"));
            (0, what)
        });
        *files = files.saturating_add(1);
    }

    fn news_of_mission(&mut self) -> Option<Arc<MissionProgress>> {
        let watch = &self.mission.as_ref()?.watch;
        let reported = std::mem::replace(&mut self.reported, watch.published());
        if reported == self.reported { None } else { watch.get() }
    }

    /// Accepted updates are written to their file and reported.
    fn on_learning(&mut self) {
        let Some(writer) = &mut self.learned else { return };
        let Some(update) = writer.attend() else { return };
        if self.arguments.json {
            self.print_learned();
        } else {
            self.display.note(&format!("  {update}"));
        }
    }

    fn print_learned(&mut self) {
        let report: Option<LearningReport> = self.learned.as_ref().and_then(LearningWriter::report);
        if let Some(report) = report {
            let elapsed_s = self.began.elapsed().as_secs_f64();
            self.lines.tell(&json!({"type": "learning", "time_s": elapsed_s, "learned": report}));
        }
    }

    /// At the end.
    fn reports_learned_state(&mut self) {
        self.on_learning();
        if let Some(report) = self.learned.as_ref().and_then(LearningWriter::report) {
            if self.arguments.json {
                self.print_learned();
            }
            say!("floorguard run: learned: {}", report.words());
        }
    }

    /// The mission has reported its progress: every ten seconds, and when it is done.
    fn on_mission(&mut self, progress: &MissionProgress) {
        let elapsed_s = self.began.elapsed().as_secs_f64();
        let is_done = progress.phase == MissionPhase::Done && !self.is_done;
        self.is_done |= is_done;
        if self.arguments.json {
            self.lines.tell(&json!({
                "type": "mission",
                "time_s": elapsed_s,
                "phase": progress.phase.name(),
                "completion": progress.completion,
                "claimed_fraction": progress.claimed_fraction,
                "uncertain_cells": progress.uncertain.len(),
                "unreachable_cells": progress.unreachable_cells,
                "distance_m": progress.distance_m,
            }));
        } else if is_done || elapsed_s >= self.next_mission_s {
            self.next_mission_s = elapsed_s + MISSION_WORD_S;
            self.display.note(&format!("  mission: {}", progress.words()));
        }
    }

    /// Says what has changed on the CAN bus, and which devices have sent nothing since the start.
    fn on_bus(&mut self, report: &BusReport) {
        if !self.silent_reported && self.began.elapsed() >= SILENT_AFTER {
            self.silent_reported = true;
            silent_devices(report).iter().for_each(|line| self.display.note(line));
        }
        for (index, device) in report.devices.iter().enumerate() {
            let known = self.bus.and_then(|known| known.devices.get(index).copied());
            let silent_at_start = known.is_none() && device.phase == NodePhase::Absent;
            if known != Some(*device) && !silent_at_start {
                self.display.note(&format!("  {device}"));
            }
        }
        self.bus = Some(*report);
    }

    /// Says why a device is of no use, once for each reason.
    fn on_complaints(&mut self, complaints: &Complaints) {
        let known = std::mem::replace(&mut self.complaints, *complaints);
        let lidar = complaints.lidar.filter(|now| known.lidar.map(|then| kind(&then)) != Some(kind(now)));
        // Its edges wander by a block from turn to turn: once is enough.
        let closed = complaints.lidar_closed.filter(|_| known.lidar_closed.is_none());
        let scanner = complaints.scanner.filter(|_| known.scanner != complaints.scanner);
        let message = complaints.scanner_message;
        let message = message.filter(|_| known.scanner_message != complaints.scanner_message);
        let imu = complaints.imu.filter(|_| known.imu != complaints.imu);
        let reasons = [
            ("lidar", lidar.map(|error| error.to_string())),
            ("lidar", closed.map(|sector| format!("{sector}; what lies in the closed sector stays unknown"))),
            ("safety scanner", scanner.map(|error| error.to_string())),
            ("safety scanner", message.map(|error| error.to_string())),
            ("inertial sensor", imu.map(|fault| fault.to_string())),
        ];
        for (device, reason) in reasons {
            if let Some(reason) = reason {
                self.display.note(&format!("  {device}: {reason}"));
            }
        }
    }

    fn on_stop(&mut self, stop: &StopRecord) {
        self.stops += 1;
        let at_s = stop.stamp.as_micros() as f64 * 1.0e-6;
        self.last_stop = Some(format!("{at_s:.1} s: {}", stop.cause));
        if let Some(folder) = &self.arguments.black_box {
            let outcome = write_stop_file(folder, self.stops, (stop, self.shared));
            self.written(outcome.map(drop));
        }
        if self.arguments.json {
            let cause = stop.cause.to_string();
            let latched = stop.state == GuardState::Latched;
            let line = json!({"type": "stop", "time_s": at_s, "cause": cause, "speed_mps": stop.speed_mps, "latched": latched});
            self.lines.tell(&line);
        }
    }

    /// What holds the robot has changed, or a reset was answered.
    fn on_history(&mut self, status: &RobotStatus) {
        for event in self.history.news(status) {
            let (at_s, line) = (event.at.as_micros() as f64 * 1.0e-6, event.line());
            if self.arguments.json {
                self.lines
                    .tell(&json!({"type": event.kind, "time_s": at_s, "text": line, "remedy": event.remedy}));
            } else {
                self.display.note(&format!("  {at_s:.1} s: {line}. {}", event.remedy));
            }
        }
    }

    fn on_status(&mut self, status: &RobotStatus) {
        self.on_history(status);
        let elapsed_s = self.began.elapsed().as_secs_f64();
        let people = self.shared.people.get().map_or(0, |report| report.people.len());
        let seen = status_of(elapsed_s, status, (people, self.stops, self.last_stop.clone()));
        if self.arguments.json && elapsed_s >= self.next_json_s {
            self.next_json_s = elapsed_s + JSON_STATUS_S;
            let sources: serde_json::Map<String, serde_json::Value> = seen
                .sources
                .iter()
                .map(|source| (source.name.clone(), source.health.clone().into()))
                .collect();
            let links = self.shared.links();
            self.lines.tell(
                &json!({"type": "status", "time_s": elapsed_s, "state": format!("{:?}", status.decision.state),
                "speed_mps": seen.speed_mps, "limit_mps": seen.limit_mps, "people": seen.people,
                "held_by": status.decision.holding_cause.map(|record| record.to_string()),
                "remedy": status.decision.holding_cause.map(|record| remedy(&record)),
                "first_cause": status.decision.primary_cause.map(|record| record.to_string()),
                "sources": sources, "can_sent": links.can_sent, "can_errors": links.can_errors}),
            );
        }
        if self.display.is_due(elapsed_s) {
            self.display.show(&seen);
        }
    }
}

#[cfg(test)]
#[path = "run_tests.rs"]
mod tests;
