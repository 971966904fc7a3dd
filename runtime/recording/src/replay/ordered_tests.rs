//! What the order of a run in real time means, row by row.

use std::collections::BTreeMap;
use std::io::Cursor;

use floorguard_configuration::{EXAMPLE, parse};
use floorguard_robot::assembly::{Poll, TapRow};
use floorguard_runtime::shared::PeopleReport;
use floorguard_types::geometry::Twist2;

use super::*;
use crate::order::OrderLog;
use crate::{RunInfo, RunRecorder};

struct NoAudience;

impl ReplayAudience for NoAudience {
    fn on_people(&mut self, _report: &PeopleReport, _digest: u64) {}
}

fn at(us: u64) -> Stamp {
    Stamp::from_micros(us)
}

/// What the guard of the repetition is set up with.
#[derive(Default)]
struct SetUp(Option<floorguard_guard::GuardConfig>);

impl ReplayAudience for SetUp {
    fn on_people(&mut self, _report: &PeopleReport, _digest: u64) {}

    fn on_moment(&mut self, shared: &Shared<NoopRawMutex>, _now_us: u64) {
        self.0 = Some(shared.inspect(|guard| guard.config().clone()));
    }
}

/// The memory of a guard on a computer takes in more of each lidar packet than that of a board: so must that of the repetition.
#[test]
fn repeated_guard_is_set_up_as_recorded() {
    let robot = parse("robot.toml", EXAMPLE).expect("the example").robot;
    for stages in [Stages::All, Stages::AsOnBoard] {
        let recorded: Box<Shared<NoopRawMutex>> =
            floorguard_robot::assembly::new_shared_for(&robot, stages, at(500)).expect("a robot");
        let mut log = OrderLog::default();
        log.note(&TapRow::Began(at(500)));
        log.note(&TapRow::Polled(Poll {
            task: GuardTask::Command,
            at: at(600),
            decisions: 0,
            decision: None,
        }));
        let file = recording_of(&robot, &mut log);
        let mut set_up = SetUp::default();
        let run = OrderedRun { robot: &robot, stages, learning: None, imu_baud: 115_200 };
        play_ordered(run, &mut Recording::new(file.as_slice()), &mut set_up).expect("played");
        assert_eq!(set_up.0, Some(recorded.inspect(|guard| guard.config().clone())), "{stages:?}");
    }
}

/// A recording that holds nothing but this order.
fn recording_of(robot: &RobotConfiguration, log: &mut OrderLog) -> Vec<u8> {
    let info =
        RunInfo { robot, robot_toml: EXAMPLE, imu_baud: 115_200, clouds_every: 0, texts: BTreeMap::new() };
    let mut recorder = RunRecorder::new(Cursor::new(Vec::new()), &info).expect("a recorder");
    recorder.order(1_000, &log.take().expect("entries"));
    recorder.finish(1_000, None).expect("written").expect("a writer").into_inner()
}

/// A second command that comes while the guard decides on the first is taken in the same poll: two decisions, not one.
#[test]
fn commands_of_one_poll_are_all_repeated() {
    let robot = parse("robot.toml", EXAMPLE).expect("the example").robot;
    let twist = |linear_mps, angular_radps| Twist2 { linear_mps, angular_radps };
    let commands = [(at(900), twist(0.2, 0.0)), (at(950), twist(0.3, 0.1))];
    let shared: Box<Shared<NoopRawMutex>> = Box::new(Shared::unconfigured(Motion::new(robot.wheels())));
    shared.configure(robot.guard(), at(500)).expect("a robot");
    // The clock that this thread had before, later than the recorded times, must not count in the repetition.
    use_virtual_clock(1_000_000);
    for (stamp, wanted) in commands {
        shared.decide(|guard| guard.on_command(wanted, stamp, at(1_000)));
    }
    let decision = shared.decision.get();
    let poll = Poll { task: GuardTask::Command, at: at(1_000), decisions: 2, decision };
    let mut log = OrderLog::default();
    log.note(&TapRow::Began(at(500)));
    commands.into_iter().for_each(|(stamp, wanted)| {
        log.note(&TapRow::Command(stamp, wanted));
    });
    log.note(&TapRow::Polled(poll));
    let file = recording_of(&robot, &mut log);
    let mut recording = Recording::new(file.as_slice());
    let run = OrderedRun { robot: &robot, stages: Stages::All, learning: None, imu_baud: 115_200 };
    let outcome = play_ordered(run, &mut recording, &mut NoAudience).expect("played");
    let order = outcome.order.expect("an order");
    assert_eq!((order.decisions, order.polls), (2, 1));
    assert!(order.first_difference.is_none(), "{:?}", order.first_difference);
}
