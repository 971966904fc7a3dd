//! Whatever the bus says: no panic, bounded answers, and a stop is a stop. And the curve is kept.

use std::vec::Vec;

use floorguard_types::sensing::{DriveFeedback, DriveState};
use floorguard_types::time::Stamp;
use proptest::prelude::*;

use super::*;
use crate::can::CanFrame;
use crate::three_wheel_base::{BaseEvent, StopKind};

/// Four commands, sent again after a loss, four stops of the network, SYNC, heartbeat, and two for each of five devices that start. The
/// runtime keeps the first 16 of a poll: commands and stops come first, and what a device needs for its start is asked again.
const FRAMES_MAX: usize = 24;

/// A bus with devices that answer as they should.
struct Bench {
    base: WheelDrives,
    now_ms: u64,
    wheels: u8,
    feedback: Option<DriveFeedback>,
    sent: Vec<CanFrame>,
}

impl Bench {
    /// All devices operate.
    fn operating(nodes: [u8; 4]) -> Self {
        let configuration =
            WheelDrivesConfiguration { wheel_nodes: nodes, ..WheelDrivesConfiguration::default() };
        let wheels = configuration.wheels() as u8;
        let base = WheelDrives::new(configuration);
        let mut bench = Self { base, now_ms: 10_000, wheels, feedback: None, sent: Vec::new() };
        for _ in 0..80 {
            bench.poll();
            bench.answer();
        }
        assert!(bench.base.is_complete());
        bench
    }

    fn now(&self) -> Stamp {
        Stamp::from_micros(self.now_ms * 1_000)
    }

    fn frame(&mut self, id: u16, payload: &[u8]) -> Option<BaseEvent> {
        let (now, mut got) = (self.now(), None);
        self.base.on_frame(&CanFrame::standard(id, payload), now, &mut |event| {
            assert!(got.replace(event).is_none(), "one event a frame");
        });
        if let Some(BaseEvent::Drive(feedback)) = got {
            self.feedback = Some(feedback);
        }
        got
    }

    fn poll(&mut self) {
        self.now_ms += 10;
        let alive = self.base.devices().filter(|device| device.is_operational()).map(|device| device.node());
        for node in alive.collect::<Vec<_>>() {
            self.frame(0x700 + u16::from(node), &[5]);
        }
        let (now, mut sent) = (self.now(), Vec::new());
        self.base.poll(now, &mut |_| {}, &mut |frame| sent.push(*frame));
        assert!(sent.len() <= FRAMES_MAX, "{}", sent.len());
        let first = sent.iter().take(usize::from(self.wheels)).filter_map(CanFrame::standard_id);
        assert!(first.eq((1..=u16::from(self.wheels)).map(|node| 0x200 + node)), "commands come first");
        self.sent = sent;
    }

    /// Answers to all requests of the last poll.
    fn answer(&mut self) {
        for request in core::mem::take(&mut self.sent) {
            let (id, data) = (request.standard_id().unwrap(), request.payload());
            match (id, data) {
                (0, [1, node]) => {
                    self.frame(0x700 + u16::from(*node), &[5]);
                }
                (0x601..=0x67F, [_, low, high, sub, ..]) => {
                    self.frame(id - 0x80, &[0x60, *low, *high, *sub, 0, 0, 0, 0]);
                }
                _ => {}
            }
        }
    }

    fn report(&mut self, wheel: u8, status: u16, mm: i32) {
        let ([low, high], [a, b, c, d]) = (status.to_le_bytes(), mm.to_le_bytes());
        self.frame(0x181 + u16::from(wheel), &[low, high, a, b, c, d]);
    }

    fn report_all(&mut self, status: u16, mm: [i32; 4]) {
        (0..self.wheels).zip(mm).for_each(|(wheel, mm)| self.report(wheel, status, mm));
    }

    /// Controlword and target of each wheel, as the last poll sent them.
    fn orders(&self) -> Vec<(u16, i32)> {
        let to_wheel = |frame: &CanFrame| {
            let &[low, high, a, b, c, d] = frame.payload() else { return None };
            let id = frame.standard_id()?;
            (0x201..=0x204)
                .contains(&id)
                .then(|| (u16::from_le_bytes([low, high]), i32::from_le_bytes([a, b, c, d])))
        };
        self.sent.iter().filter_map(to_wheel).take(usize::from(self.wheels)).collect()
    }
}

const GO: WheelCommand = WheelCommand::Move(SideTargets { left_mps: 0.4, right_mps: 0.6 });

#[test]
fn fg_req_080_stop_keeps_curve_until_standstill() {
    let mut bench = Bench::operating([1, 2, 0, 0]);
    bench.report_all(0x0237, [0; 4]);
    bench.base.command(GO);
    for _ in 0..100 {
        bench.poll();
        let orders = bench.orders();
        let mm = [orders[0].1, orders[1].1, 0, 0];
        bench.report_all(0x0237, mm);
    }
    assert_eq!(bench.orders(), [(0x0F, 400), (0x0F, 600)]);
    for kind in [StopKind::Hold, StopKind::Ramp] {
        bench.base.command(GO);
        (0..100).for_each(|_| {
            bench.poll();
            let orders = bench.orders();
            bench.report_all(0x0237, [orders[0].1, orders[1].1, 0, 0]);
        });
        bench.base.command(WheelCommand::Stop(kind));
        // 0.6 m/s at 1.5 m/s² are 40 steps of 10 ms, and the first is taken with the command itself.
        let (mut steps, mut before_mm) = (1, 585);
        for _ in 0..60 {
            bench.poll();
            let orders = bench.orders();
            let (left, right) = (orders[0].1, orders[1].1);
            // Two to three all the way down, to the rounding of a millimetre a second.
            assert!((left * 3 - right * 2).abs() <= 3, "{left} {right}");
            if right != 0 {
                assert_eq!(orders[0].0, 0x0F, "it is led down before the torque goes");
            }
            steps += i32::from(before_mm != 0);
            before_mm = right;
            bench.report_all(0x0237, [left, right, 0, 0]);
        }
        assert_eq!(steps, 40);
        let word = if kind == StopKind::Hold { 0x0F } else { 0x02 };
        assert_eq!(bench.orders(), [(word, 0), (word, 0)]);
    }
}

#[test]
fn wheels_turn_only_when_all_drives_operate() {
    let mut bench = Bench::operating([1, 2, 0, 0]);
    bench.base.command(GO);
    bench.report(0, 0x0237, 0);
    bench.report(1, 0x0233, 0);
    for _ in 0..20 {
        bench.poll();
        assert!(bench.orders().iter().all(|(_, target)| *target == 0));
    }
    // The left wheel turns, the right drive fails: the left one gets no speed any more.
    bench.report_all(0x0237, [0; 4]);
    (0..30).for_each(|_| bench.poll());
    assert!(bench.orders()[0].1 > 100);
    bench.report_all(0x0237, [250, 300, 0, 0]);
    bench.report(0, 0x0237, 250);
    bench.report(1, 0x0218, 300);
    bench.poll();
    assert_eq!(bench.orders()[0].1, 0);
    assert!(matches!(bench.feedback.unwrap().state, DriveState::Fault(_)));
    bench.base.command(WheelCommand::Stop(StopKind::TorqueOff));
    bench.poll();
    assert_eq!(bench.orders(), [(0, 0), (0, 0)]);
}

/// The guard hears a steered wheel that moves the same way.
#[test]
fn feedback_is_that_of_an_equivalent_wheel() {
    let mut bench = Bench::operating([1, 2, 0, 0]);
    bench.report_all(0x0237, [200, 600, 0, 0]);
    let feedback = bench.feedback.unwrap();
    // Track 0.5 m: 0.4 m/s and 0.8 rad/s; lever 0.25 m.
    let (forward, across) = (
        feedback.wheel_speed_mps * feedback.steering_rad.cos(),
        feedback.wheel_speed_mps * feedback.steering_rad.sin(),
    );
    assert!((forward - 0.4).abs() < 1e-6 && (across / 0.25 - 0.8).abs() < 1e-5, "{feedback:?}");
}

#[test]
fn positions_of_one_sync_make_one_sample() {
    let mut bench = Bench::operating([1, 2, 3, 4]);
    let mut sample = None;
    for step in 1..=3_i32 {
        bench.poll();
        for wheel in 0..4_u16 {
            let position = step * [10, 20, 30, 40][usize::from(wheel)] - 5;
            if let Some(BaseEvent::Wheels(wheels)) = bench.frame(0x281 + wheel, &position.to_le_bytes()) {
                assert_eq!(wheel, 3);
                sample = Some(wheels);
            }
        }
    }
    // Counts of both wheels of a side together, from where they were first seen.
    let sample = sample.unwrap();
    assert_eq!((sample.left_ticks, sample.right_ticks), (80, 120));
    // What comes later than its SYNC allows is none.
    bench.now_ms += 10;
    for wheel in 0..4_u16 {
        assert_eq!(bench.frame(0x281 + wheel, &[0; 4]), None);
    }
    assert_eq!(bench.base.counters().late, 4);
}

/// Mecanum wheels that turn against each other on one side move the base sideways: that is a fault of its own.
#[test]
fn fg_req_082_sideways_motion_is_fault() {
    let mut bench = Bench::operating([1, 2, 3, 4]);
    bench.base.command(GO);
    for _ in 0..29 {
        bench.report_all(0x0237, [-300, 300, 300, -300]);
        assert_eq!(bench.feedback.unwrap().state, DriveState::Enabled);
    }
    bench.report_all(0x0237, [-300, 300, 300, -300]);
    assert_eq!(bench.feedback.unwrap().state, DriveState::Fault(0xFF03));
    bench.report_all(0x0237, [300; 4]);
    assert_eq!(bench.feedback.unwrap().state, DriveState::Fault(0xFF03), "until a reset");
    bench.base.reset_faults();
    bench.report_all(0x0237, [300; 4]);
    assert_eq!(bench.feedback.unwrap().state, DriveState::Enabled);
}

#[derive(Clone, Debug)]
enum StepEvent {
    Frame(u16, Vec<u8>),
    Status(u8, u16, i32),
    Answers,
    Command(WheelCommand),
    Reset,
    Poll(u64),
}

fn step_event() -> impl Strategy<Value = StepEvent> {
    let number = || prop_oneof![any::<f32>(), -2.0_f32..2.0];
    let command = prop_oneof![
        (number(), number())
            .prop_map(|(left_mps, right_mps)| WheelCommand::Move(SideTargets { left_mps, right_mps })),
        Just(WheelCommand::Stop(StopKind::Hold)),
        Just(WheelCommand::Stop(StopKind::Ramp)),
        Just(WheelCommand::Stop(StopKind::TorqueOff)),
    ];
    let status = prop_oneof![
        any::<u16>(),
        proptest::sample::select([0_u16, 0x0240, 0x0231, 0x0233, 0x0237, 0x0217, 0x021F, 0x0218].to_vec()),
    ];
    prop_oneof![
        3 => (0_u16..0x800, proptest::collection::vec(any::<u8>(), 0..=8)).prop_map(|(id, data)| StepEvent::Frame(id, data)),
        4 => (0_u8..4, status, any::<i32>()).prop_map(|(wheel, status, mm)| StepEvent::Status(wheel, status, mm)),
        4 => Just(StepEvent::Answers),
        3 => command.prop_map(StepEvent::Command),
        1 => Just(StepEvent::Reset),
        6 => (1_u64..30).prop_map(StepEvent::Poll),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    /// No wheel is given a speed while the command is a stop without torque, and none ever one that is no number's nearest.
    #[test]
    fn any_bus_is_survived_and_stops_are_stops(events in proptest::collection::vec(step_event(), 0..80)) {
        let mut bench = Bench::operating([1, 2, 3, 4]);
        for event in events {
            match event {
                StepEvent::Frame(id, data) => { bench.frame(id, &data); }
                StepEvent::Status(wheel, status, mm) => bench.report(wheel, status, mm),
                StepEvent::Answers => bench.answer(),
                StepEvent::Command(command) => bench.base.command(command),
                StepEvent::Reset => bench.base.reset_faults(),
                StepEvent::Poll(ms) => { bench.now_ms += ms; bench.poll(); }
            }
            let (mut sent, command) = (Vec::new(), bench.base.commanded());
            bench.base.send_command(&mut |frame| sent.push(*frame));
            prop_assert_eq!(sent.len(), 4);
            for frame in &sent {
                let &[low, high, a, b, c, d] = frame.payload() else { panic!("six bytes") };
                let target = i32::from_le_bytes([a, b, c, d]);
                if command == WheelCommand::Stop(StopKind::TorqueOff) {
                    prop_assert!(target == 0 && u16::from_le_bytes([low, high]) & 0x000F != 0x000F);
                }
            }
            prop_assert!(bench.base.is_whole());
        }
    }
}
