//! One line per task: which ring it runs on and what it talks to.

use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::{Read, Write};
use floorguard_drivers::motor_drives::MotorDrives;
use floorguard_drivers::three_wheel_base::ThreeWheelBase;
use floorguard_drivers::wheel_drives::WheelDrives;
use floorguard_drivers::{microscan3, s300};
use floorguard_guard::{GuardConfig, GuardConfigError};
use floorguard_localisation::odometry::{BaseModel, PoseHistory};
use floorguard_perception::motion::{MotionDetector, MotionParameters, find_moving_people_with_second_look};
use floorguard_perception::people::{
    ClusterLimits, PeopleOutput, PeoplePipeline, SweepContext, Track, TrackerParameters,
};
use floorguard_runtime::configuration::{DriveTrain, RangingModel, RobotConfiguration, ScannerModel};
use floorguard_runtime::io::{CanBus, DatagramReceiver};
use floorguard_runtime::mission::RouteFollower;
use floorguard_runtime::shared::{Motion, Shared};
use floorguard_runtime::tasks::{
    BusWithButtons, GuardInput, JudgeMotion, Mission, NoMotion, PerceptionState, can_bus, drive_mission,
    drive_route, imu_input, lidar_input, observed_advice_input, observed_operator_input, perceive,
    ranging_datagrams, ranging_scanner, rear_scanner_input, scanner_datagrams, scanner_input,
    shaped_command_input, supervise,
};
use floorguard_types::geometry::Point2;
use floorguard_types::sensing::{LidarPacket, Scan, Sweep};
use floorguard_types::time::Stamp;

use super::guard_task::GuardTask;
use super::inbox::PeopleInbox;
use super::legs::HostedLegs;
use super::second_look::SecondLook;
use super::tap::Tap;
use crate::learning::{LearningSetup, PeopleLearner};
use crate::navigator::{BodyExtent, SpaceInbox, sight_of};
use floorguard_host::executor::TaskSet;

/// What the scanner is connected to: the line of an S300, the port of one that sends datagrams, or both directions of one that must be asked.
pub enum ScannerCarrier<S, D, I> {
    /// Bytes of telegrams.
    Serial(S),
    /// Datagrams, and where they become scans.
    Datagrams(D),
    /// A line or a connection.
    Asked(I, RangingModel),
}

/// The lines that the guard ring listens to.
pub struct GuardCarriers<L, S, D, I, C> {
    /// Lidar datagrams; a robot can do without.
    pub lidar: Option<L>,
    /// Safety scanner.
    pub scanner: ScannerCarrier<S, D, I>,
    /// Second safety scanner, an S300; a robot can do without.
    pub rear_scanner: Option<S>,
    /// Inertial sensor and its bit rate; a robot can do without.
    pub imu: Option<(I, u32)>,
    /// CAN bus, if the drives are on one.
    pub can: Option<C>,
    /// Where the guard's other inputs are reported, in a run that is recorded in real time.
    pub tap: Option<Tap>,
}

/// Firings of each lidar packet that the memory of a hosted guard takes in: each direction has its turn three times a second
/// (FG-REQ-066).
const MEMORY_FIRINGS: u8 = 8;

/// The state that both rings share, on a computer.
///
/// # Errors
/// The guard refuses the configuration.
pub fn new_shared<M: RawMutex>(
    robot: &RobotConfiguration,
    now: Stamp,
) -> Result<Box<Shared<M>>, GuardConfigError> {
    new_shared_for(robot, Stages::All, now)
}

/// The same; a guard that must answer as the microcontroller's does remembers no more than that one.
///
/// # Errors
/// The guard refuses the configuration.
pub fn new_shared_for<M: RawMutex>(
    robot: &RobotConfiguration,
    stages: Stages,
    now: Stamp,
) -> Result<Box<Shared<M>>, GuardConfigError> {
    Ok(Box::new(Shared::new(guard_for(robot, stages), Motion::new(robot.wheels()), now)?))
}

/// What the guard of a computer is set up with: a run and its repetition must not differ in it.
#[must_use]
pub fn guard_for(robot: &RobotConfiguration, stages: Stages) -> GuardConfig {
    let mut guard = robot.guard();
    if stages == Stages::All {
        guard.thresholds.memory_firings = MEMORY_FIRINGS;
    }
    guard
}

/// Which stages run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stages {
    /// Everything.
    #[default]
    All,
    /// What also runs on the microcontroller, bit for bit: with its capacity for clusters and people, and without the
    /// verdict on what moves, which takes more memory than it has.
    AsOnBoard,
}

const AS_ON_BOARD: &str = "as-on-board";

impl Stages {
    /// For recordings.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::AsOnBoard => AS_ON_BOARD,
        }
    }

    /// By its name; everything if the name says nothing else.
    #[must_use]
    pub fn named(name: &str) -> Self {
        if name == AS_ON_BOARD { Self::AsOnBoard } else { Self::All }
    }
}

/// The perception ring of a hosted robot.
pub type HostedPerception = PerceptionState<HostedMotion, HostedLegs>;

/// Judges what moves, if that stage runs, hears what other threads saw of people, and learns, where that is wanted.
pub struct HostedMotion {
    motion: Option<Box<MotionDetector>>,
    inbox: PeopleInbox,
    space: Option<SpaceInbox>,
    body: BodyExtent,
    learner: Option<PeopleLearner>,
    second: Option<Box<SecondLook>>,
}

impl HostedMotion {
    fn new(stages: Stages, outline: &[Point2], second: Option<Box<SecondLook>>) -> Self {
        let runs = stages == Stages::All;
        let motion = runs.then(|| Box::new(MotionDetector::new(MotionParameters::FIXED)));
        Self {
            motion,
            inbox: PeopleInbox::default(),
            space: None,
            body: BodyExtent::of(outline),
            learner: None,
            second,
        }
    }

    /// From now on people are looked for in the rings of a sweep alone.
    pub fn look_once(&mut self) {
        self.second = None;
    }

    /// From now on what comes in there goes into the list of people, too.
    pub fn listen_to(&mut self, inbox: PeopleInbox) {
        self.inbox = inbox;
    }

    /// From now on each sweep goes there, if somewhere.
    pub fn show_space_to(&mut self, space: Option<SpaceInbox>) {
        self.space = space;
    }

    /// From now on it learns, if there is something to learn with.
    pub fn learn(&mut self, learning: Option<&LearningSetup>) {
        self.learner = learning.map(LearningSetup::learner);
    }
}

impl JudgeMotion for HostedMotion {
    fn people<'a>(
        &mut self,
        people: &'a mut PeoplePipeline,
        sweep: &Sweep,
        context: &SweepContext,
    ) -> PeopleOutput<'a> {
        for view in self.inbox.take_all() {
            people.add_view(&view);
        }
        let second = self.second.as_mut().map_or(&[][..], |second| second.detections(sweep, context));
        let counters = match &mut self.motion {
            Some(motion) => {
                find_moving_people_with_second_look(people, motion, (sweep, context), second).counters
            }
            None => NoMotion.people(people, sweep, context).counters,
        };
        if let Some(space) = &self.space {
            space.put(sight_of(sweep, context, (&people.angles, &self.body)));
        }
        if let Some(learner) = &mut self.learner {
            learner.observe(people, sweep.end_stamp);
        }
        PeopleOutput { clusters: people.clusters(), tracks: people.tracks(), counters }
    }

    fn note_packet(&mut self, packet: &LidarPacket, lost_before: u16, hangs: bool) {
        if let Some(second) = &mut self.second {
            second.note_packet(packet, lost_before, hangs);
        }
    }

    fn learned(&self, track: &Track) -> Option<f32> {
        self.learner.as_ref()?.probability(track)
    }
}

/// The memory of the perception ring.
#[must_use]
pub fn new_perception(robot: &RobotConfiguration, stages: Stages) -> Box<HostedPerception> {
    // The board keeps no reflectivities, so it does not know the appearance of people; and it has less
    // capacity.
    let (clusters, tracker) = match stages {
        Stages::All => (ClusterLimits::DEFAULT, TrackerParameters::DEFAULT),
        Stages::AsOnBoard => (ClusterLimits::AS_ON_BOARD, TrackerParameters::AS_ON_BOARD),
    };
    let second = (stages == Stages::All).then(|| SecondLook::of_robot(robot)).flatten();
    let mut people = PeoplePipeline::with_tracker(robot.ring_angles(), tracker);
    people.cluster_limits = clusters;
    Box::new(PerceptionState {
        building: Sweep::EMPTY,
        people,
        motion: HostedMotion::new(stages, &robot.geometry.footprint, second),
        legs: HostedLegs::of_robot(robot, stages),
        scan: Scan::EMPTY,
        history: PoseHistory::new(),
        sensor_in_base: robot.lidar.mounting.transform(),
        scanner_in_base: robot.scanner.mounting.transform().on_floor(),
    })
}

/// Everything that can stop the robot. Gives the tasks in the order of their indices in the set, which must be empty.
pub fn spawn_guard_ring<'a, M: RawMutex>(
    tasks: &mut TaskSet<'a>,
    shared: &'a Shared<M>,
    robot: &RobotConfiguration,
    carriers: GuardCarriers<
        impl DatagramReceiver + 'a,
        impl Read + 'a,
        impl DatagramReceiver + 'a,
        impl Read + Write + 'a,
        impl CanBus + 'a,
    >,
) -> Vec<GuardTask> {
    let mut names = Vec::new();
    if let Some(lidar) = carriers.lidar {
        tasks.spawn(lidar_input(shared, lidar, robot.lidar_decoder()));
        names.push(GuardTask::Lidar);
    }
    names.push(GuardTask::Scanner);
    match carriers.scanner {
        ScannerCarrier::Serial(line) => {
            tasks.spawn(scanner_input(shared, line, s300::Receiver::new(s300::Configuration::default())));
        }
        ScannerCarrier::Datagrams(socket) => match robot.scanner.model {
            ScannerModel::Ranging(model) => tasks.spawn(ranging_datagrams(shared, socket, model.driver())),
            ScannerModel::S300 | ScannerModel::MicroScan3 { .. } => {
                let configuration = microscan3::Configuration::default();
                tasks.spawn(scanner_datagrams(shared, socket, microscan3::Receiver::new(configuration)));
            }
        },
        ScannerCarrier::Asked(line, model) => {
            tasks.spawn(ranging_scanner(shared, line, model.driver()));
        }
    }
    if let (Some((line, baud)), Some(imu)) = (carriers.imu, robot.imu) {
        tasks.spawn(imu_input(shared, line, (imu.model.driver(baud), imu.mounting.transform())));
        names.push(GuardTask::Imu);
    }
    if let Some(line) = carriers.rear_scanner {
        let receiver = s300::Receiver::new(s300::Configuration::default());
        tasks.spawn(rear_scanner_input(shared, line, receiver));
        names.push(GuardTask::RearScanner);
    }
    if let Some(can) = carriers.can {
        spawn_base(tasks, (shared, robot), can);
        names.push(GuardTask::Can);
    }
    tasks.spawn(supervise(shared));
    let observer = || {
        let tap = carriers.tap.clone();
        move |input: GuardInput<'_>| {
            if let Some(tap) = &tap {
                tap.input(input);
            }
        }
    };
    let is_limited = matches!(robot.train, DriveTrain::Ackermann { .. });
    let base = robot.ackermann();
    let drivable = move |wanted| if is_limited { base.drivable(wanted) } else { wanted };
    tasks.spawn(shaped_command_input(shared, drivable, observer()));
    tasks.spawn(observed_advice_input(shared, observer()));
    tasks.spawn(observed_operator_input(shared, observer()));
    let others = [GuardTask::Supervise, GuardTask::Command];
    names.extend(others.into_iter().chain([GuardTask::Advice, GuardTask::Operator]));
    names
}

/// The task of the CAN bus, with the devices and the kinematics of the robot's base.
fn spawn_base<'a, M: RawMutex>(
    tasks: &mut TaskSet<'a>,
    (shared, robot): (&'a Shared<M>, &RobotConfiguration),
    can: impl CanBus + 'a,
) {
    let bus = BusWithButtons::new(can, shared, &robot.can);
    if let Some(motors) = robot.motor_drives() {
        tasks.spawn(can_bus(shared, bus, (MotorDrives::new(motors), robot.side_wheels())));
        return;
    }
    match robot.train {
        DriveTrain::Tricycle => {
            tasks.spawn(can_bus(shared, bus, (ThreeWheelBase::new(robot.base()), robot.tricycle())));
        }
        DriveTrain::Ackermann { .. } => {
            tasks.spawn(can_bus(shared, bus, (ThreeWheelBase::new(robot.base()), robot.ackermann())));
        }
        DriveTrain::Differential | DriveTrain::Omnidirectional { .. } => {
            tasks.spawn(can_bus(shared, bus, (WheelDrives::new(robot.wheel_drives()), robot.side_wheels())));
        }
    }
}

/// Everything that sees and plans.
pub fn spawn_perception_ring<'a, M: RawMutex>(
    tasks: &mut TaskSet<'a>,
    shared: &'a Shared<M>,
    robot: &RobotConfiguration,
    state: &'a mut HostedPerception,
) {
    tasks.spawn(perceive(shared, state));
    let follower = RouteFollower::new(robot.route.clone(), robot.route_limits);
    tasks.spawn(drive_route(shared, follower));
}

/// The same with a mission instead of the route: cleaning, or a drive to a goal.
pub fn spawn_mission_ring<'a, M: RawMutex>(
    tasks: &mut TaskSet<'a>,
    shared: &'a Shared<M>,
    (state, mission): (&'a mut HostedPerception, &'a mut dyn Mission),
) {
    tasks.spawn(perceive(shared, state));
    tasks.spawn(drive_mission(shared, mission));
}
