//! Plays the tape: moves virtual time from delivery to timer to delivery and polls the tasks.

use core::pin::pin;

use cortex_m_semihosting::hprintln;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_drivers::can::CanFrame;
use floorguard_drivers::s300::{Configuration, Receiver};
use floorguard_drivers::three_wheel_base::ThreeWheelBase;
use floorguard_drivers::velodyne::{Decoder, ModelChoice};
use floorguard_drivers::xsens::Device;
use floorguard_localisation::odometry::PoseHistory;
use floorguard_perception::legs::PeopleByLegs;
use floorguard_perception::people::{PeoplePipeline, RingAngles};
use floorguard_runtime::digest::OutputDigest;
use floorguard_runtime::mission::RouteFollower;
use floorguard_runtime::shared::{Motion, Shared};
use floorguard_runtime::tape::{TapeLine, TapeReader, TapeRecord};
use floorguard_runtime::tasks::{
    NoMotion, PerceptionState, advice_input, can_bus, command_input, drive_route, imu_input, lidar_input,
    operator_input, perceive, scanner_input, supervise,
};
use floorguard_types::geometry::Transform3;
use floorguard_types::sensing::{Scan, Sweep};
use floorguard_types::time::Stamp;
use static_cell::StaticCell;

use super::carriers::{CanLine, LidarLine, SerialLine};
use super::clock;
use super::stages::{self, Stages};
use super::stopwatch::Stopwatch;
use super::task_set::TaskSet;
use crate::robot::robot_for;

type RobotShared = Shared<NoopRawMutex>;

static SHARED: StaticCell<RobotShared> = StaticCell::new();
static PERCEPTION: StaticCell<PerceptionState> = StaticCell::new();

/// Bit rate of the inertial sensor on the tape.
const IMU_BAUD: u32 = 115_200;
/// Instructions take 2^6 ns: `-icount shift=6`.
const SHIFT: u32 = 6;

/// The lines between tape and tasks.
struct Lines {
    lidar: LidarLine,
    scanner: SerialLine,
    imu: SerialLine,
    can: CanLine,
}

impl Lines {
    fn deliver(&self, record: &TapeRecord<'static>, shared: &RobotShared) {
        match record.line {
            TapeLine::Lidar => self.lidar.push(Stamp::from_micros(record.arrival_us), record.data),
            TapeLine::Scanner => self.scanner.push(record.data),
            TapeLine::Imu => self.imu.push(record.data),
            TapeLine::Can => {
                if let Some((id, payload)) = record.data.split_first_chunk::<2>() {
                    self.can.push(CanFrame::standard(u16::from_le_bytes(*id), payload));
                }
            }
            TapeLine::Reset => shared.reset.signal(()),
            TapeLine::Start => shared.start.signal(()),
            TapeLine::Pause => shared.pause(true),
            TapeLine::Resume => shared.pause(false),
            // The board has no second scanner, and no mission.
            TapeLine::Route | TapeLine::RearScanner | TapeLine::MissionOrder => {}
        }
    }
}

/// How much work what costs.
#[derive(Default)]
struct Costs {
    lidar: Stopwatch,
    scanner: Stopwatch,
    can: Stopwatch,
    imu: Stopwatch,
    tick: Stopwatch,
    sweep: Stopwatch,
}

/// Plays a tape to its end and prints what came of it. False when the guard refuses the robot.
pub fn play(tape: TapeReader<'static>) -> bool {
    let Some(robot) = robot_for(tape) else {
        hprintln!("the tape does not begin with a route");
        return false;
    };
    let Ok(shared) = RobotShared::new(robot.guard(), Motion::new(robot.wheels()), Stamp::ZERO) else {
        hprintln!("the guard refuses the robot");
        return false;
    };
    let shared: &RobotShared = SHARED.init(shared);
    let fresh = || PerceptionState {
        building: Sweep::EMPTY,
        people: PeoplePipeline::new(RingAngles::vlp16()),
        motion: NoMotion,
        legs: PeopleByLegs::new(),
        scan: Scan::EMPTY,
        history: PoseHistory::new(),
        sensor_in_base: robot.lidar.mounting.transform(),
        scanner_in_base: robot.scanner.mounting.transform().on_floor(),
    };
    let perception = PERCEPTION.init(fresh());
    let stages = stages::measure(tape, &robot, perception);
    *perception = fresh();
    let lines = Lines {
        lidar: LidarLine::new(),
        scanner: SerialLine::new(),
        imu: SerialLine::new(),
        can: CanLine::new(),
    };
    let choice = robot.lidar_model().map_or(ModelChoice::Auto, ModelChoice::Fixed);
    let imu_mounting = robot.imu.map_or(Transform3::IDENTITY, |imu| imu.mounting.transform());
    let base = (ThreeWheelBase::new(robot.base()), robot.tricycle());
    // The order of the hosted program: guard ring first, then perception.
    let lidar = pin!(lidar_input(shared, &lines.lidar, Decoder::new(choice)));
    let scanner = pin!(scanner_input(shared, &lines.scanner, Receiver::new(Configuration::default())));
    let imu = pin!(imu_input(shared, &lines.imu, (Device::new(IMU_BAUD), imu_mounting)));
    let can = pin!(can_bus(shared, &lines.can, base));
    let supervisor = pin!(supervise(shared));
    let command = pin!(command_input(shared));
    let advice = pin!(advice_input(shared));
    let operator = pin!(operator_input(shared));
    let perception = pin!(perceive(shared, perception));
    let mission = pin!(drive_route(shared, RouteFollower::new(robot.route.clone(), robot.route_limits)));
    let mut tasks =
        TaskSet::new([lidar, scanner, imu, can, supervisor, command, advice, operator, perception, mission]);
    let (digest, costs) = run(tape, (shared, &lines), &mut tasks);
    report(&digest, &costs, &stages);
    true
}

fn run<const N: usize>(
    tape: TapeReader<'static>,
    (shared, lines): (&RobotShared, &Lines),
    tasks: &mut TaskSet<'_, N>,
) -> (OutputDigest, Costs) {
    let (mut digest, mut costs) = (OutputDigest::default(), Costs::default());
    let (mut seen_people, mut seen_status) = (0, 0);
    let end_us = tape.duration_us();
    let mut records = tape.peekable();
    // The first moment has no delivery: the tasks arm their timers.
    let mut now_us = 0;
    while now_us <= end_us {
        let mut only = None;
        let mut deliveries = 0;
        while let Some(record) = records.next_if(|record| record.deliver_us <= now_us) {
            only = Some(record.line);
            deliveries += 1;
            lines.deliver(&record, shared);
        }
        let timers_due = clock::next_timer_us().is_some_and(|at| at <= now_us);
        clock::advance(now_us);
        // Only moments with a single kind of work tell its price.
        let watch = match (deliveries, only, timers_due) {
            (1, Some(TapeLine::Lidar), false) => Some(&mut costs.lidar),
            (1, Some(TapeLine::Scanner), false) => Some(&mut costs.scanner),
            (1, Some(TapeLine::Can), false) => Some(&mut costs.can),
            (1, Some(TapeLine::Imu), false) => Some(&mut costs.imu),
            (0, None, true) => Some(&mut costs.tick),
            _ => None,
        };
        let mut measured = watch.as_deref().copied().unwrap_or_default();
        measured.begin();
        tasks.poll_until_quiet();
        measured.end();
        while let Some(frame) = lines.can.sent() {
            digest.on_frame(&frame, now_us);
        }
        let people = shared.people.published();
        if people != seen_people {
            seen_people = people;
            if let Some(report) = shared.people.get() {
                digest.on_people(&report);
            }
            // The end of a sweep: perception's whole frame is in it.
            costs.sweep.add(&measured);
        } else if let Some(watch) = watch {
            *watch = measured;
        }
        let status = shared.status.published();
        if status != seen_status {
            seen_status = status;
            if let Some(report) = shared.status.get() {
                digest.on_status(&report);
            }
        }
        let next_record_us = records.peek().map_or(u64::MAX, |record| record.deliver_us);
        now_us = next_record_us.min(clock::next_timer_us().unwrap_or(u64::MAX));
        if next_record_us == u64::MAX && clock::next_timer_us().is_none() {
            break;
        }
    }
    (digest, costs)
}

fn report(digest: &OutputDigest, costs: &Costs, stages: &Stages) {
    let [frames, people, decisions] = digest.counts();
    hprintln!("digest {:016x}", digest.value());
    hprintln!("frames {} people {} decisions {}", frames, people, decisions);
    let rows = [
        ("lidar-packet", &costs.lidar),
        ("scanner-bytes", &costs.scanner),
        ("can-frame", &costs.can),
        ("imu-bytes", &costs.imu),
        ("tick", &costs.tick),
        ("sweep", &costs.sweep),
        ("stage-decode", &stages.decode),
        ("stage-guard-packet", &stages.guard_packet),
        ("stage-memory-packet", &stages.memory_packet),
        ("stage-build", &stages.build),
        ("stage-floor", &stages.floor),
        ("stage-floor-clusters", &stages.clusters),
        ("stage-features", &stages.features),
        ("stage-track", &stages.track),
        ("stage-guard-scan", &stages.guard_scan),
        ("stage-memory-scan", &stages.memory_scan),
    ];
    for (name, watch) in rows {
        let (count, mean, largest) = watch.instructions(SHIFT);
        hprintln!("instructions {} count {} mean {} max {}", name, count, mean, largest);
    }
}
