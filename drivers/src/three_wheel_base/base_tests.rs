//! Whatever the bus says: no panic, bounded answers, and a stop is a stop.

use std::vec::Vec;

use floorguard_types::time::Stamp;
use proptest::prelude::*;

use super::*;
use crate::can::CanFrame;
use crate::cia402::PowerState;
use crate::flexisoft::{InputBits, InputMap};

/// Capacity of the runtime for frames of one poll.
const FRAMES_MAX: usize = 16;
const TRACTION: u16 = 0x201;
const STEERING: u16 = 0x202;

#[derive(Clone, Debug)]
enum StepEvent {
    Frame(u16, Vec<u8>),
    Status(u8, u16, i32),
    Heartbeat(u8, u8),
    /// The answer that the device waits for.
    GoodAnswers,
    Command(DriveCommand),
    Reset,
    /// Milliseconds until the next poll; the clock may also run backwards.
    Poll(i64),
}

fn command() -> impl Strategy<Value = DriveCommand> {
    let number = prop_oneof![any::<f32>(), -2.0_f32..2.0];
    prop_oneof![
        (number.clone(), number)
            .prop_map(|(wheel_mps, steering_rad)| DriveCommand::Move { wheel_mps, steering_rad }),
        Just(DriveCommand::Stop(StopKind::Hold)),
        Just(DriveCommand::Stop(StopKind::Ramp)),
        Just(DriveCommand::Stop(StopKind::TorqueOff)),
    ]
}

fn step_event() -> impl Strategy<Value = StepEvent> {
    let status = prop_oneof![
        any::<u16>(),
        proptest::sample::select(
            [0x0000_u16, 0x0240, 0x0231, 0x0233, 0x0237, 0x0217, 0x021F, 0x0218, 0x0201].to_vec()
        ),
    ];
    let state = proptest::sample::select([0_u8, 4, 5, 0x7F, 0x85, 9].to_vec());
    prop_oneof![
        2 => (0_u16..0x800, proptest::collection::vec(any::<u8>(), 0..=8)).prop_map(|(id, data)| StepEvent::Frame(id, data)),
        4 => (1_u8..=2, status, any::<i32>()).prop_map(|(node, status, value)| StepEvent::Status(node, status, value)),
        2 => (1_u8..=5, state).prop_map(|(node, state)| StepEvent::Heartbeat(node, state)),
        8 => Just(StepEvent::GoodAnswers),
        3 => command().prop_map(StepEvent::Command),
        1 => Just(StepEvent::Reset),
        6 => prop_oneof![9 => Just(10_i64), 1 => -2_000_i64..2_000].prop_map(StepEvent::Poll),
    ]
}

/// A bus on which the answers to the last requests can be given.
struct Bench {
    base: ThreeWheelBase,
    now_ms: i64,
    requests: Vec<CanFrame>,
    reported: [Option<PowerState>; 2],
}

impl Bench {
    fn new() -> Self {
        let base = ThreeWheelBase::new(BaseConfiguration::default());
        Self { base, now_ms: 10_000, requests: Vec::new(), reported: [None; 2] }
    }

    fn now(&self) -> Stamp {
        Stamp::from_micros(u64::try_from(self.now_ms).unwrap_or(0) * 1_000)
    }

    fn frame(&mut self, id: u16, payload: &[u8]) {
        let (now, mut events) = (self.now(), 0);
        let id = id & 0x7FF;
        self.base.on_frame(&CanFrame::standard(id, payload), now, &mut |_| events += 1);
        assert!(events <= 1);
        if let (0x181 | 0x182, [low, high, _, _, _, _, ..]) = (id, payload) {
            let state = PowerState::from_statusword(u16::from_le_bytes([*low, *high]));
            self.reported[usize::from(id - 0x181)] = state;
        }
    }

    fn play(&mut self, step_event: StepEvent) {
        match step_event {
            StepEvent::Frame(id, data) => self.frame(id, &data),
            StepEvent::Status(node, status, value) => {
                let ([low, high], [a, b, c, d]) = (status.to_le_bytes(), value.to_le_bytes());
                self.frame(0x180 + u16::from(node), &[low, high, a, b, c, d]);
            }
            StepEvent::Heartbeat(node, state) => self.frame(0x700 + u16::from(node), &[state]),
            StepEvent::GoodAnswers => self.answer(),
            StepEvent::Command(command) => {
                self.base.command(command);
                let mut sent = Vec::new();
                self.base.send_command(&mut |frame| sent.push(*frame));
                self.check(&sent);
            }
            StepEvent::Reset => self.base.reset_faults(),
            StepEvent::Poll(ms) => self.poll(ms),
        }
    }

    fn answer(&mut self) {
        let alive = self.base.devices().map(|device| device.is_operational().then_some(device.node()));
        for node in alive.into_iter().flatten() {
            self.frame(0x700 + u16::from(node), &[5]);
        }
        for request in core::mem::take(&mut self.requests) {
            let (id, data) = (request.standard_id().unwrap(), request.payload());
            match (id, data) {
                (0x000, [1, node]) => self.frame(0x700 + u16::from(*node), &[5]),
                (0x601..=0x67F, [command, low, high, sub, ..]) => {
                    let done = if *command == 0x40 { 0x43 } else { 0x60 };
                    self.frame(id - 0x80, &[done, *low, *high, *sub, 0, 0, 0, 1]);
                }
                _ => {}
            }
        }
    }

    fn poll(&mut self, ms: i64) {
        self.now_ms = (self.now_ms + ms).max(0);
        let (mut sent, mut events) = (Vec::new(), 0);
        self.base.poll(self.now(), &mut |_| events += 1, &mut |frame| sent.push(*frame));
        assert!(events <= 5 && sent.len() <= FRAMES_MAX, "{events} events, {} frames", sent.len());
        assert_eq!(
            sent.first().and_then(CanFrame::standard_id),
            Some(TRACTION),
            "nothing holds the command up"
        );
        assert_eq!(sent.iter().filter(|frame| frame.standard_id() == Some(0x080)).count(), 1);
        self.check(&sent);
        self.requests.extend(&sent);
    }

    /// The frames to the drives, against what was commanded and what they last reported.
    fn check(&self, sent: &[CanFrame]) {
        let commanded = self.base.commanded();
        for frame in sent {
            let (TRACTION | STEERING, &[low, high, ref target @ ..]) =
                (frame.standard_id().unwrap(), frame.payload())
            else {
                continue;
            };
            let traction = frame.standard_id() == Some(TRACTION);
            let word = u16::from_le_bytes([low, high]);
            let moves = matches!(commanded, DriveCommand::Move { .. });
            assert!(moves || !traction || target == [0; 4], "{commanded:?}: target {target:?}");
            if commanded == DriveCommand::Stop(StopKind::TorqueOff) {
                assert!(matches!(word, 0x0000 | 0x0080), "{commanded:?}: {word:04X}");
            }
            if traction && commanded == DriveCommand::Stop(StopKind::Ramp) {
                assert!(matches!(word, 0x0000 | 0x0002 | 0x0080), "{commanded:?}: {word:04X}");
            }
            if word == 0x000F {
                let state = self.reported[usize::from(!traction)];
                let climbed = matches!(state, Some(PowerState::SwitchedOn | PowerState::OperationEnabled));
                assert!(climbed, "enabled although it reported {state:?}");
            }
            if traction && target != [0; 4] {
                assert_eq!(
                    self.reported,
                    [Some(PowerState::OperationEnabled); 2],
                    "turned before both operate"
                );
            }
        }
        assert!(
            sent.iter().any(|frame| frame.standard_id() == Some(TRACTION)),
            "the drive always gets a command"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]
    #[test]
    fn whatever_the_bus_says(step_events in proptest::collection::vec(step_event(), 0..200)) {
        let mut bench = Bench::new();
        for step_event in step_events {
            bench.play(step_event);
        }
    }
}

/// The property above is worth something only if such a bus comes up at all.
#[test]
fn a_bus_that_answers_comes_up_and_moves() {
    let mut bench = Bench::new();
    for _ in 0..80 {
        bench.play(StepEvent::Poll(10));
        bench.play(StepEvent::GoodAnswers);
    }
    assert!(bench.base.is_complete());
    bench.play(StepEvent::Command(DriveCommand::Move { wheel_mps: 0.5, steering_rad: 0.0 }));
    for status in [0x0240, 0x0231, 0x0233, 0x0237] {
        bench.play(StepEvent::Status(1, status, 0));
        bench.play(StepEvent::Status(2, status, 0));
        bench.play(StepEvent::Poll(10));
    }
    let mut sent = Vec::new();
    bench.base.send_command(&mut |frame| sent.push(*frame));
    assert_eq!(sent.first(), Some(&CanFrame::standard(TRACTION, &[0x0F, 0, 0xF4, 1, 0, 0])));
}

/// A position outside the measuring range is invalid, not a distance.
#[test]
fn encoders_are_held_to_their_range() {
    let mut bench = Bench::new();
    for _ in 0..80 {
        bench.play(StepEvent::Poll(10));
        bench.play(StepEvent::GoodAnswers);
    }
    let mut samples = Vec::new();
    let now = bench.now();
    for (node, top) in [(3, 0), (4, 1), (4, 0)] {
        let frame = CanFrame::standard(0x180 + node, &[7, 0, 0, top, 0, 0]);
        bench.base.on_frame(&frame, now, &mut |event| samples.push(event));
    }
    assert_eq!(bench.base.counters().refused, 1, "the bench's encoders count to 2^24");
    assert!(matches!(samples[..], [BaseEvent::Wheels(_)]));
}

/// Whatever bit of the configuration of the base, or of the map by which it reads the safety inputs.
#[test]
fn fg_req_058_flipped_configuration_is_noticed() {
    let inputs = InputMap {
        emergency_stop: InputBits::new([32, 33]),
        bumper_front: InputBits::new([34, 35]),
        cliff_front: Some(InputBits::new([40, 41])),
        discrepancy_us: 500_000,
        ..InputMap::default()
    };
    let base = ThreeWheelBase::new(BaseConfiguration { inputs, ..BaseConfiguration::default() });
    assert!(base.is_whole());
    let is_noticed = |flip: &dyn Fn(&mut ThreeWheelBase)| {
        let mut base = base.clone();
        flip(&mut base);
        !base.is_whole()
    };
    for bit in 0..8 {
        let flips: [&dyn Fn(&mut ThreeWheelBase); 8] = [
            &|base| base.image.map.emergency_stop.bits[0] ^= 1 << bit,
            &|base| base.image.map.bumper_front.bits[1] ^= 1 << bit,
            &|base| base.image.map.emergency_stop.inverted[1] = true,
            &|base| base.image.map.cliff_front = None,
            &|base| base.image.map.discrepancy_us ^= 1 << bit,
            &|base| base.configuration.inputs.bumper_front.bits[0] ^= 1 << bit,
            &|base| base.configuration.inputs_node ^= 1 << bit,
            &|base| base.configuration.quick_stop_mps2 = f32::from_bits(0x4000_0000 ^ 1 << bit),
        ];
        for (index, flip) in flips.into_iter().enumerate() {
            assert!(is_noticed(flip), "bit {bit} of {index}");
        }
    }
}
