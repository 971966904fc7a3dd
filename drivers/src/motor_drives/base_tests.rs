//! Whatever a controller says: no panic, bounded answers, and a stop is a stop. The curve is kept, and nothing drives whose watchdog is
//! not known.

use std::vec::Vec;

use floorguard_types::sensing::{DriveFeedback, DriveState};
use floorguard_types::time::Stamp;
use proptest::prelude::*;

use super::*;
use crate::can::CanFrame;
use crate::three_wheel_base::{BaseEvent, StopKind};
use crate::wheel_drives::{SideTargets, WheelCommand};

/// The runtime sends so many of a poll.
const FRAMES_MAX: usize = 16;
const GO: WheelCommand = WheelCommand::Move(SideTargets { left_mps: 0.4, right_mps: 0.6 });

/// An axis as its maker describes it: it follows while armed, and its watchdog takes the torque away.
#[derive(Clone, Copy, Debug)]
struct Axis {
    state: u8,
    error: u32,
    speed: f32,
    fed_ms: u64,
    watchdog_ms: u64,
    /// It turns on whatever it is commanded.
    is_stuck: bool,
}

impl Axis {
    fn obey(&mut self, command: u16, payload: &[u8], now_ms: u64) {
        match (command, payload) {
            (0x02, _) => (self.state, self.error) = (1, 0x0200_0000),
            (0x07, [1, ..]) => self.state = 1,
            (0x07, [8, ..]) if self.error == 0 => (self.state, self.fed_ms) = (8, now_ms),
            (0x0D, _) if self.is_stuck => self.fed_ms = now_ms,
            (0x0D, [a, b, c, d, ..]) => {
                (self.speed, self.fed_ms) = (f32::from_le_bytes([*a, *b, *c, *d]), now_ms);
            }
            (0x18, _) => self.error = 0,
            _ => {}
        }
    }

    fn step(&mut self, now_ms: u64) {
        if self.state == 8 && now_ms > self.fed_ms + self.watchdog_ms {
            (self.state, self.error) = (1, 0x0100_0000);
        }
        if self.state != 8 {
            self.speed = 0.0;
        }
    }
}

struct Bench {
    base: MotorDrives,
    axes: [Axis; 2],
    now_ms: u64,
    feedback: Option<DriveFeedback>,
    sent: Vec<CanFrame>,
}

impl Bench {
    fn new(watchdog_ms: u64, has_brakes: bool) -> Self {
        // The right motor is mounted the other way round.
        let metres_per_turn = [0.5, -0.5, 0.0, 0.0];
        let configuration =
            MotorDrivesConfiguration { has_brakes, metres_per_turn, ..MotorDrivesConfiguration::default() };
        let axis = Axis { state: 1, error: 0, speed: 0.0, fed_ms: 0, watchdog_ms, is_stuck: false };
        let base = MotorDrives::new(configuration);
        Self { base, axes: [axis; 2], now_ms: 10_000, feedback: None, sent: Vec::new() }
    }

    fn poll(&mut self) {
        self.now_ms += 10;
        let now = Stamp::from_micros(self.now_ms * 1_000);
        let mut sent = Vec::new();
        self.base.poll(now, &mut |_| {}, &mut |frame| sent.push(*frame));
        assert!(sent.len() <= FRAMES_MAX);
        for frame in &sent {
            let id = frame.standard_id().unwrap();
            let axis = &mut self.axes[usize::from(id >> 5) - 1];
            axis.obey(id & 0x1F, frame.payload(), self.now_ms);
        }
        self.sent = sent;
        for index in 0..2 {
            self.axes[index].step(self.now_ms);
            let (axis, node) = (self.axes[index], (index as u16 + 1) << 5);
            if self.now_ms.is_multiple_of(100) {
                let [a, b, c, d] = axis.error.to_le_bytes();
                self.hear(node | 0x01, &[a, b, c, d, axis.state, 0, 0, 0]);
            }
            self.hear(node | 0x09, &[0_f32.to_le_bytes(), axis.speed.to_le_bytes()].concat());
        }
    }

    fn hear(&mut self, id: u16, payload: &[u8]) {
        let now = Stamp::from_micros(self.now_ms * 1_000);
        let feedback = &mut self.feedback;
        self.base.on_frame(&CanFrame::standard(id, payload), now, &mut |event| {
            if let BaseEvent::Drive(heard) = event {
                *feedback = Some(heard);
            }
        });
    }

    fn run(&mut self, polls: u32, command: WheelCommand) {
        for _ in 0..polls {
            self.base.command(command);
            self.poll();
        }
    }

    fn speeds(&self) -> [f32; 2] {
        self.axes.map(|axis| axis.speed)
    }

    fn state(&self) -> Option<DriveState> {
        self.feedback.map(|feedback| feedback.state)
    }
}

#[test]
fn fg_req_084_drives_after_watchdogs_have_shown_themselves() {
    let mut bench = Bench::new(200, true);
    bench.run(20, WheelCommand::Stop(StopKind::TorqueOff));
    assert!(bench.base.is_complete() && bench.axes.iter().all(|axis| axis.state == 1));
    // Armed, silent, expired, cleared, armed again: nothing turns meanwhile.
    for _ in 0..120 {
        bench.run(1, GO);
        let is_known = bench.base.watchdog() == WatchdogCheck::Passed;
        assert!(is_known || bench.speeds() == [0.0; 2]);
        assert!(is_known || bench.state() != Some(DriveState::Enabled));
    }
    bench.run(120, GO);
    assert_eq!(bench.speeds(), [0.8, -1.2], "turns a second of wheels of half a metre");
    assert_eq!(bench.state(), Some(DriveState::Enabled));
}

#[test]
fn fg_req_084_axis_without_watchdog_never_drives() {
    let mut bench = Bench::new(u64::MAX / 2, true);
    for _ in 0..300 {
        bench.run(1, GO);
        assert_eq!(bench.speeds(), [0.0; 2]);
    }
    assert_eq!(
        (bench.base.watchdog(), bench.state()),
        (WatchdogCheck::Failed, Some(DriveState::Fault(0xFF05)))
    );
    assert!(bench.axes.iter().all(|axis| axis.state == 1), "no torque");
}

/// The bench drives 0.4 m/s and 0.6 m/s.
fn driving(has_brakes: bool) -> Bench {
    let mut bench = Bench::new(200, has_brakes);
    bench.run(300, GO);
    assert_eq!(bench.speeds(), [0.8, -1.2]);
    bench
}

#[test]
fn fg_req_080_stops_keep_curve_and_end_without_torque() {
    for (has_brakes, kind) in [(true, StopKind::Hold), (true, StopKind::Ramp), (false, StopKind::TorqueOff)] {
        let mut bench = driving(has_brakes);
        for _ in 0..39 {
            bench.run(1, WheelCommand::Stop(kind));
            let [left, right] = bench.speeds();
            assert!((left * 1.5 + right).abs() < 0.01, "{left} {right}");
        }
        // 0.6 m/s at 1.5 m/s²; the first of the 40 steps was taken with the command.
        assert!(bench.speeds().iter().all(|speed| speed.abs() < 1e-5), "{kind:?}: {:?}", bench.speeds());
        bench.run(30, WheelCommand::Stop(kind));
        let is_held = bench.axes.iter().all(|axis| axis.state == 8);
        assert_eq!(is_held, kind == StopKind::Hold);
    }
    let mut bench = driving(true);
    bench.run(1, WheelCommand::Stop(StopKind::TorqueOff));
    assert!(bench.axes.iter().all(|axis| axis.state == 1), "with brakes the torque goes at once");
}

#[test]
fn what_left_operation_waits_for_reset() {
    for (error, code) in [(0x0100_0000, 0xFF06), (0x0000_0200, 0x0D09), (0, 0xFF01)] {
        let mut bench = driving(true);
        (bench.axes[1].state, bench.axes[1].error) = (1, error);
        bench.run(12, GO);
        assert_eq!(bench.state(), Some(DriveState::Fault(code)));
        bench.run(100, GO);
        assert_eq!((bench.speeds(), bench.state()), ([0.0; 2], Some(DriveState::Fault(code))));
        bench.base.reset_faults();
        bench.run(150, GO);
        assert_eq!((bench.speeds(), bench.state()), ([0.8, -1.2], Some(DriveState::Enabled)));
    }
}

/// An axis that stays armed and turns on, whatever it is commanded, gets its emergency stop.
#[test]
fn axis_that_does_not_obey_is_stopped_otherwise() {
    let mut bench = driving(true);
    bench.axes[0].is_stuck = true;
    bench.run(150, WheelCommand::Stop(StopKind::Hold));
    assert!(bench.axes.iter().all(|axis| axis.state == 1 && axis.error == 0x0200_0000), "{:?}", bench.axes);
}

fn line_base(protocol: MotorProtocol) -> MotorDrives {
    let configuration = MotorDrivesConfiguration {
        protocol,
        metres_per_turn: [1.0; 4],
        ..MotorDrivesConfiguration::default()
    };
    MotorDrives::new(configuration)
}

/// A poll: what goes out as text, and the lines that come back.
fn exchange(base: &mut MotorDrives, now_ms: &mut u64, lines: &str) -> std::string::String {
    *now_ms += 10;
    let now = Stamp::from_micros(*now_ms * 1_000);
    for portion in lines.as_bytes().chunks(5) {
        base.on_frame(&CanFrame::standard(0, portion), now, &mut |_| {});
    }
    let mut sent = Vec::new();
    base.poll(now, &mut |_| {}, &mut |frame| sent.extend_from_slice(frame.payload()));
    std::string::String::from_utf8(sent).unwrap()
}

#[test]
fn fg_req_084_roboteq_drives_after_reading_its_watchdog() {
    let (mut base, mut now_ms) = (line_base(MotorProtocol::Roboteq), 1_000);
    base.command(GO);
    let mut asked = std::string::String::new();
    for _ in 0..40 {
        asked.push_str(&exchange(&mut base, &mut now_ms, "S=0:0\rC=0:0\rFF=0\r"));
    }
    assert!(asked.contains("^RWD 200\r~RWD\r") && asked.contains("?S\r?C\r?FF\r"), "{asked}");
    assert!(!asked.contains("!S 1 1") && asked.contains("!S 1 0\r!S 2 0\r"), "{asked}");
    let _ = exchange(&mut base, &mut now_ms, "RWD=1000\r");
    assert_eq!(base.watchdog(), WatchdogCheck::Pending);
    let _ = exchange(&mut base, &mut now_ms, "+\rRWD=200\r");
    let (mut last, mut left_rpm) = (std::string::String::new(), std::string::String::from("0"));
    for _ in 0..100 {
        let lines = std::format!("S={left_rpm}:{left_rpm}\rC=0:0\rFF=0\r");
        last = exchange(&mut base, &mut now_ms, &lines);
        let speed = last.strip_prefix("!S 1 ").and_then(|rest| rest.split('\r').next());
        left_rpm = speed.unwrap().into();
    }
    // A metre a turn: 0.4 m/s are 24 turns a minute.
    assert!(last.starts_with("!S 1 24\r!S 2 36\r"), "{last}");
    base.command(WheelCommand::Stop(StopKind::TorqueOff));
    assert!(exchange(&mut base, &mut now_ms, "").starts_with("!EX\r"));
    // Silence of the line: nothing is known any more, and the settings are checked anew.
    (0..40).for_each(|_| drop(exchange(&mut base, &mut now_ms, "")));
    assert_eq!((base.watchdog(), base.is_complete()), (WatchdogCheck::Pending, false));
}

#[test]
fn fg_req_084_wheel_line_drives_after_its_deadline_passed() {
    use crate::wheel_line::{WheelReport, WheelRequest, WheelState, WheelValue};
    let (mut base, mut now_ms) = (line_base(MotorProtocol::WheelLine), 1_000);
    let (mut newest, mut ends_ms, mut reports) = (None, 0, 0);
    let mut last: Option<WheelRequest> = None;
    for _ in 0..200 {
        base.command(GO);
        let is_on = last.as_ref().is_some_and(|request| request.follow);
        let state = match (is_on, now_ms < ends_ms) {
            (false, _) => WheelState::Off,
            (true, true) => WheelState::Follows,
            (true, false) => WheelState::Expired,
        };
        reports += 1;
        let wheels = [WheelValue::default(); 2].into_iter().collect();
        let report = WheelReport { sequence: reports, heard: 0, age_ms: 0, state, wheels };
        let sent = exchange(&mut base, &mut now_ms, &report.encode());
        for line in sent.lines() {
            let request = WheelRequest::decode(line.as_bytes()).unwrap();
            assert!(newest.replace(request.sequence) < Some(request.sequence), "each is newer");
            ends_ms = now_ms + u64::from(request.deadline_ms);
            last = Some(request);
        }
        let drives = last.as_ref().is_some_and(|request| request.speeds_mmps.iter().any(|speed| *speed != 0));
        assert!(!drives || base.watchdog() == WatchdogCheck::Passed);
    }
    assert_eq!(last.unwrap().speeds_mmps.as_slice(), [400, 600]);
}

/// Reports of a VESC say nothing of its watchdog; speeds are electrical turns a minute.
#[test]
fn vesc_drives_by_electrical_turns() {
    let mut base = line_base(MotorProtocol::Vesc);
    let mut now_ms = 1_000;
    base.command(GO);
    for _ in 0..80 {
        now_ms += 10;
        let now = Stamp::from_micros(now_ms * 1_000);
        for node in [1, 2] {
            let frame = CanFrame::extended(0x0900 | node, &[0, 0, 0, 168, 0, 0, 0, 0]).unwrap();
            base.on_frame(&frame, now, &mut |_| {});
        }
        base.poll(now, &mut |_| {}, &mut |_| {});
    }
    let mut sent = Vec::new();
    base.send_command(&mut |frame| sent.push(*frame));
    // 0.4 turns a second of 7 pairs of poles: 168 a minute.
    let rpm = |id, value: i32| CanFrame::extended(id, &value.to_be_bytes()).unwrap();
    assert_eq!(sent, [rpm(0x0301, 168), rpm(0x0302, 252)]);
    assert_eq!(base.watchdog(), WatchdogCheck::Unknowable);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any frames, any commands: bounded answers, and without torque means without torque.
    #[test]
    fn any_bus_is_survived_and_stops_are_stops(
        kind in 0_usize..4,
        steps in proptest::collection::vec((0_u16..0x80, proptest::collection::vec(any::<u8>(), 0..=8), 0_u8..8, 0_u64..40), 0..120),
    ) {
        use MotorProtocol::{Odrive, Roboteq, Vesc, WheelLine};
        let protocol = [Odrive, Vesc, Roboteq, WheelLine][kind];
        let mut base = MotorDrives::new(MotorDrivesConfiguration { protocol, inputs_node: 5, ..MotorDrivesConfiguration::default() });
        let mut now_ms = 1_000;
        for (id, data, order, wait_ms) in steps {
            now_ms += wait_ms;
            let now = Stamp::from_micros(now_ms * 1_000);
            match order {
                0 => base.command(GO),
                1 => base.command(WheelCommand::Stop(StopKind::TorqueOff)),
                2 => base.reset_faults(),
                3 => {
                    let mut count = 0;
                    base.poll(now, &mut |_| {}, &mut |_| count += 1);
                    prop_assert!(count <= FRAMES_MAX, "{}", count);
                }
                4 => base.on_frame(&CanFrame::extended(0x0900 | u32::from(id & 3), &data).unwrap(), now, &mut |_| {}),
                5 => base.on_frame(&CanFrame::standard(0, &data), now, &mut |_| {}),
                _ => base.on_frame(&CanFrame::standard(id, &data), now, &mut |_| {}),
            }
            if base.commanded() == WheelCommand::Stop(StopKind::TorqueOff) {
                base.send_command(&mut |frame| {
                    let speed = frame.standard_id().is_some_and(|id| protocol == Odrive && id & 0x1F == 0x0D);
                    let rpm = frame.extended_id().is_some_and(|id| id >> 8 == 3);
                    assert!(!speed && !rpm, "{frame:?}");
                });
            }
            prop_assert!(base.is_whole());
        }
    }
}
