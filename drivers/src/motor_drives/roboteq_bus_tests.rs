//! Roboteqs on a bus: nothing drives whose script does not show its watchdog, a stop is a stop, and one that leaves waits for a reset.

use std::vec::Vec;

use floorguard_types::sensing::{DriveFeedback, DriveState, WheelSample};
use floorguard_types::time::Stamp;
use proptest::prelude::*;

use super::*;
use crate::can::CanFrame;
use crate::three_wheel_base::{BaseEvent, StopKind};
use crate::wheel_drives::{SideTargets, WheelCommand};

/// The runtime sends so many of a poll.
const FRAMES_MAX: usize = 16;
const GO: WheelCommand = WheelCommand::Move(SideTargets { left_mps: 0.4, right_mps: 0.6 });
const OFF: WheelCommand = WheelCommand::Stop(StopKind::TorqueOff);

/// A controller as its maker describes it, with two channels. It follows at once.
#[derive(Clone, Copy, Debug)]
struct Controller {
    node: u16,
    is_operational: bool,
    faults: u8,
    status: u8,
    variable: i32,
    /// What its script writes into the variable; none without a script.
    shows: Option<i32>,
    rpm: [i32; 2],
    counts: [i32; 2],
    is_mute: bool,
}

impl Controller {
    const fn new(node: u16) -> Self {
        let (status, shows) = (0x80, Some(200));
        Self {
            node,
            is_operational: false,
            faults: 0,
            status,
            variable: 0,
            shows,
            rpm: [0; 2],
            counts: [0; 2],
            is_mute: false,
        }
    }

    fn take(&mut self, frame: &CanFrame, out: &mut Vec<CanFrame>) {
        let (id, payload) = (frame.standard_id().unwrap(), frame.payload());
        match (id, payload) {
            (0, [1, node]) if u16::from(*node) == self.node => self.is_operational = true,
            (0, [0x80, node]) if u16::from(*node) == self.node => self.is_operational = false,
            (id, [command, low, high, sub, ..]) if id == 0x600 | self.node => {
                match (*high, *low) {
                    (0x20, 0x0C) => self.faults |= 0x10,
                    (0x20, 0x0D) => self.faults &= !0x10,
                    (0x20, 0x05) if *sub == 1 => self.variable = 0,
                    _ => {}
                }
                let answer = if *command == 0x40 { 0x4B } else { 0x60 };
                out.push(CanFrame::standard(0x580 | self.node, &[answer, *low, *high, *sub, 0, 0, 0, 0]));
            }
            (id, [a, b, c, d, e, f, g, h]) if id == 0x200 | self.node && self.is_operational => {
                self.rpm = [i32::from_le_bytes([*a, *b, *c, *d]), i32::from_le_bytes([*e, *f, *g, *h])];
            }
            _ => {}
        }
    }

    fn reports(&mut self, now_ms: u64, out: &mut Vec<CanFrame>) {
        if now_ms.is_multiple_of(50) {
            self.variable = self.shows.unwrap_or(self.variable);
        }
        let mut tell = |id: u16, payload: &[u8]| out.push(CanFrame::standard(id | self.node, payload));
        if now_ms.is_multiple_of(100) {
            tell(0x700, &[if self.is_operational { 5 } else { 0x7F }]);
        }
        if !self.is_operational {
            return;
        }
        let turns = if self.faults == 0 { self.rpm } else { [0; 2] };
        self.counts = [self.counts[0] + turns[0], self.counts[1] + turns[1]];
        tell(0x180, &self.counts.map(i32::to_le_bytes).concat());
        tell(0x280, &turns.map(i32::to_le_bytes).concat());
        let [a, b, c, d] = self.variable.to_le_bytes();
        tell(0x380, &[self.faults, 0, self.status, 0, a, b, c, d]);
    }
}

struct Bench {
    base: MotorDrives,
    controllers: Vec<Controller>,
    now_ms: u64,
    feedback: Option<DriveFeedback>,
    counted: Option<WheelSample>,
    lost: u32,
    sent: Vec<CanFrame>,
}

impl Bench {
    fn new(nodes: &[u8], has_brakes: bool) -> Self {
        let mut configuration = MotorDrivesConfiguration {
            protocol: MotorProtocol::RoboteqCan,
            wheels: nodes.len() as u8,
            // A metre a turn; the right motors are mounted the other way round.
            metres_per_turn: [1.0, -1.0, 1.0, -1.0],
            has_brakes,
            ..MotorDrivesConfiguration::default()
        };
        configuration.nodes[..nodes.len()].copy_from_slice(nodes);
        let mut different: Vec<u8> = nodes.to_vec();
        different.sort_unstable();
        different.dedup();
        Self {
            base: MotorDrives::new(configuration),
            controllers: different.iter().map(|node| Controller::new(u16::from(*node))).collect(),
            now_ms: 10_000,
            feedback: None,
            counted: None,
            lost: 0,
            sent: Vec::new(),
        }
    }

    fn hear(&mut self, frame: &CanFrame) {
        let now = Stamp::from_micros(self.now_ms * 1_000);
        let (feedback, counted) = (&mut self.feedback, &mut self.counted);
        self.base.on_frame(frame, now, &mut |event| match event {
            BaseEvent::Drive(heard) => *feedback = Some(heard),
            BaseEvent::Wheels(heard) => *counted = Some(heard),
            _ => {}
        });
    }

    fn poll(&mut self) {
        self.now_ms += 10;
        let now = Stamp::from_micros(self.now_ms * 1_000);
        let (mut sent, mut lost) = (Vec::new(), 0);
        let mut event = |event| lost += u32::from(matches!(event, BaseEvent::NodeLost(_)));
        self.base.poll(now, &mut event, &mut |frame| sent.push(*frame));
        assert!(sent.len() <= FRAMES_MAX, "{sent:?}");
        self.lost += lost;
        let mut answers = Vec::new();
        for controller in self.controllers.iter_mut().filter(|controller| !controller.is_mute) {
            sent.iter().for_each(|frame| controller.take(frame, &mut answers));
            controller.reports(self.now_ms, &mut answers);
        }
        answers.iter().for_each(|frame| self.hear(frame));
        self.sent = sent;
    }

    fn run(&mut self, polls: u32, command: WheelCommand) {
        for _ in 0..polls {
            self.base.command(command);
            self.poll();
        }
    }

    fn state(&self) -> Option<DriveState> {
        self.feedback.map(|feedback| feedback.state)
    }

    /// Speeds that the motors have, turns a minute.
    fn turns(&self) -> Vec<i32> {
        self.controllers.iter().flat_map(|one| if one.faults == 0 { one.rpm } else { [0; 2] }).collect()
    }
}

fn driving(has_brakes: bool) -> Bench {
    let mut bench = Bench::new(&[7, 7], has_brakes);
    bench.run(250, GO);
    assert_eq!((bench.turns(), bench.state()), (std::vec![24, -36], Some(DriveState::Enabled)));
    bench
}

#[test]
fn fg_req_084_roboteq_on_bus_drives_after_reading() {
    let mut bench = Bench::new(&[7, 7], true);
    bench.controllers[0].shows = None;
    bench.run(200, GO);
    // It has power, and stands: the script does not show the watchdog.
    assert!(bench.base.is_complete() && bench.controllers[0].faults == 0);
    assert_eq!((bench.base.watchdog(), bench.turns()), (WatchdogCheck::Pending, std::vec![0, 0]));
    for (shown, status) in [(0, 0x80), (201, 0x80), (-1, 0x80), (200, 0x01)] {
        (bench.controllers[0].shows, bench.controllers[0].status) = (Some(shown), status);
        bench.run(50, GO);
        assert_eq!(
            (bench.base.watchdog(), bench.turns()),
            (WatchdogCheck::Pending, std::vec![0, 0]),
            "{shown}"
        );
        assert_ne!(bench.state(), Some(DriveState::Enabled));
    }
    bench.controllers[0].status = 0x80;
    bench.run(100, GO);
    assert_eq!((bench.base.watchdog(), bench.turns()), (WatchdogCheck::Passed, std::vec![24, -36]));
    // The watchdog was switched off meanwhile: the script says so, and the wheels are led to standstill at once.
    bench.controllers[0].shows = Some(0);
    while bench.controllers[0].variable != 0 {
        bench.run(1, GO);
    }
    assert_eq!(bench.turns(), [24, -36]);
    bench.run(1, GO);
    assert_eq!((bench.base.watchdog(), bench.turns()), (WatchdogCheck::Pending, std::vec![0, 0]));
}

/// What the script showed of the watchdog before the controller was configured does not count.
#[test]
fn fg_req_084_old_reading_is_wiped_out() {
    let mut bench = Bench::new(&[7, 7], true);
    (bench.controllers[0].variable, bench.controllers[0].shows) = (200, None);
    // Nor does what comes before: a former master may have had it send something else.
    bench.hear(&CanFrame::standard(0x387, &[0, 0, 0x80, 0, 200, 0, 0, 0]));
    assert!(!bench.base.is_complete());
    // Until it is configured and started it is neither commanded nor released.
    let release = CanFrame::standard(0x607, &[0x2F, 0x0D, 0x20, 0, 1, 0, 0, 0]);
    for _ in 0..100 {
        let is_started = bench.controllers[0].is_operational;
        bench.run(1, GO);
        let is_command = |frame: &CanFrame| frame.standard_id() == Some(0x207) || *frame == release;
        assert!(is_started || !bench.sent.iter().any(is_command), "{:?}", bench.sent);
    }
    bench.run(100, GO);
    assert_eq!((bench.base.watchdog(), bench.turns()), (WatchdogCheck::Pending, std::vec![0, 0]));
}

#[test]
fn stop_is_immediate_and_released_still() {
    let mut bench = driving(true);
    bench.base.command(OFF);
    let mut sent = Vec::new();
    bench.base.send_command(&mut |frame| sent.push(*frame));
    let still = CanFrame::standard(0x207, &[0; 8]);
    let (stop, release) = ([0x2F, 0x0C, 0x20, 0, 1, 0, 0, 0], [0x2F, 0x0D, 0x20, 0, 1, 0, 0, 0]);
    assert_eq!(sent, [still, CanFrame::standard(0x607, &stop)]);
    bench.run(20, OFF);
    assert_eq!((bench.controllers[0].faults, bench.state()), (0x10, Some(DriveState::Disabled)));
    // Before power comes back, the speeds from before are overwritten: each release has them before it.
    bench.controllers[0].rpm = [3_000; 2];
    while bench.controllers[0].faults != 0 {
        bench.run(1, GO);
        let at = bench.sent.iter().position(|frame| *frame == CanFrame::standard(0x607, &release));
        assert!(at.is_none_or(|at| bench.sent[at - 1] == still), "{:?}", bench.sent);
    }
    assert_eq!(bench.turns(), [0, 0]);
    bench.run(100, GO);
    assert_eq!(bench.turns(), [24, -36]);
}

#[test]
fn stops_without_brakes_are_ramps() {
    let mut bench = driving(false);
    bench.run(10, OFF);
    let turns = bench.turns();
    assert!(turns[0] > 0 && turns[0] < 24 && bench.controllers[0].faults == 0, "{turns:?}");
    bench.run(60, OFF);
    assert_eq!(bench.controllers[0].faults, 0x10, "then without torque");
}

#[test]
fn faults_and_restarts_wait_for_the_operator() {
    for (faults, code) in [(0x04, 0x0E04), (0x10, 0xFF01), (0x14, 0x0E04)] {
        let mut bench = driving(true);
        bench.controllers[0].faults = faults;
        bench.run(2, GO);
        bench.controllers[0].faults &= 0x10;
        bench.run(100, GO);
        assert_eq!((bench.turns(), bench.state()), (std::vec![0, 0], Some(DriveState::Fault(code))));
        bench.base.reset_faults();
        bench.run(150, GO);
        assert_eq!((bench.turns(), bench.state()), (std::vec![24, -36], Some(DriveState::Enabled)));
    }
    // A reset of the controller: it boots, and knows nothing any more.
    let mut bench = driving(true);
    bench.controllers[0] = Controller::new(7);
    bench.hear(&CanFrame::standard(0x707, &[0]));
    bench.run(100, GO);
    assert_eq!((bench.turns(), bench.state()), (std::vec![0, 0], Some(DriveState::Fault(0xFF01))));
    bench.base.reset_faults();
    bench.run(200, GO);
    assert_eq!(bench.turns(), [24, -36]);
}

#[test]
fn silent_controller_is_lost_and_asked_anew() {
    let mut bench = driving(true);
    bench.controllers[0].is_mute = true;
    bench.run(30, GO);
    assert_eq!((bench.lost, bench.base.is_complete()), (2, false), "both wheels");
    assert_eq!(bench.base.watchdog(), WatchdogCheck::Pending);
    bench.controllers[0] = Controller { rpm: [3_000; 2], shows: None, ..Controller::new(7) };
    bench.run(400, GO);
    assert_eq!((bench.base.watchdog(), bench.turns()), (WatchdogCheck::Pending, std::vec![0, 0]));
}

/// Front wheels on one controller, rear wheels on another; counts and speeds forward are positive on both sides.
#[test]
fn four_wheels_are_two_controllers() {
    let mut bench = Bench::new(&[1, 1, 2, 2], true);
    bench.controllers[1].shows = None;
    bench.run(200, GO);
    assert_eq!(
        (bench.base.watchdog(), bench.turns()),
        (WatchdogCheck::Pending, std::vec![0; 4]),
        "one is not shown"
    );
    bench.controllers[1].shows = Some(150);
    bench.run(200, GO);
    assert_eq!(bench.turns(), [24, -36, 24, -36]);
    let counted = bench.counted.expect("counts");
    assert!(counted.left_ticks > 0 && counted.right_ticks > counted.left_ticks, "{counted:?}");
    // More controllers than there may be: the fourth wheel is never heard.
    let mut more = Bench::new(&[1, 2, 3, 3], true);
    more.run(200, GO);
    assert_eq!((more.base.is_complete(), more.turns()), (false, std::vec![0; 6]));
}

/// Two controllers of one channel each: RPDO1 holds one speed, and a report of two is cut to the first.
#[test]
fn single_channels_have_short_process_data() {
    let configuration = MotorDrivesConfiguration {
        protocol: MotorProtocol::RoboteqCan,
        nodes: [1, 2, 0, 0],
        ..MotorDrivesConfiguration::default()
    };
    let mut base = MotorDrives::new(configuration);
    let mut sizes = Vec::new();
    let mut now_ms = 0;
    for _ in 0..100 {
        now_ms += 10;
        let now = Stamp::from_micros(now_ms * 1_000);
        let mut answers = Vec::new();
        base.command(OFF);
        base.poll(now, &mut |_| {}, &mut |frame| {
            let (id, payload) = (frame.standard_id().unwrap(), frame.payload());
            match (id & 0x780, payload) {
                (0, [1, node]) => answers.push(CanFrame::standard(0x700 | u16::from(*node), &[5])),
                (0x600, [command, low, high, sub, ..]) => {
                    let answer = if *command == 0x40 { 0x4B } else { 0x60 };
                    let payload = [answer, *low, *high, *sub, 0, 0, 0, 0];
                    answers.push(CanFrame::standard(0x580 | (id & 0x7F), &payload));
                }
                (0x200, speeds) => sizes.push(speeds.len()),
                _ => {}
            }
        });
        answers.iter().for_each(|frame| base.on_frame(frame, now, &mut |_| {}));
    }
    assert!(!sizes.is_empty() && sizes.iter().all(|size| *size == 4), "{sizes:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any frames to a base that drives, any commands: bounded answers, no speed without a watchdog that is shown, and without torque
    /// means without torque.
    #[test]
    fn any_bus_is_survived_by_roboteqs(
        steps in proptest::collection::vec(
            (0_usize..8, proptest::collection::vec(any::<u8>(), 0..=8), 0_u8..8, 0_u64..40),
            0..120,
        ),
    ) {
        let mut bench = driving(true);
        for (kind, data, order, wait_ms) in steps {
            bench.now_ms += wait_ms;
            let now = Stamp::from_micros(bench.now_ms * 1_000);
            let id = [0x187, 0x287, 0x387, 0x587, 0x707, 0x087, 0x207, 0x007][kind];
            match order {
                0 => bench.base.command(GO),
                1 => bench.base.command(OFF),
                2 => bench.base.reset_faults(),
                3 | 4 => {
                    let mut sent = Vec::new();
                    bench.base.poll(now, &mut |_| {}, &mut |frame| sent.push(*frame));
                    prop_assert!(sent.len() <= FRAMES_MAX);
                    let may_drive = bench.base.watchdog() == WatchdogCheck::Passed && bench.base.commanded() != OFF;
                    let is_speed = |frame: &CanFrame| {
                        frame.standard_id() == Some(0x207) && frame.payload().iter().any(|byte| *byte != 0)
                    };
                    prop_assert!(may_drive || !sent.iter().any(is_speed), "{:?}", sent);
                }
                _ => bench.hear(&CanFrame::standard(id, &data)),
            }
            prop_assert!(bench.base.is_whole());
        }
    }
}
