//! The bus master of `drivers` against the simulator's devices, which were written from the description of the format
//! alone.

use floorguard_drivers::can::{CanFrame, SlcanEvent, SlcanReceiver, encode_slcan};
use floorguard_drivers::flexisoft::{InputBits, InputMap};
use floorguard_drivers::three_wheel_base::{
    BaseConfiguration, BaseEvent, DriveCommand, StopKind, ThreeWheelBase,
};
use floorguard_sim::can as sim_can;
use floorguard_sim::scenario::Scenario;
use floorguard_sim::{Payload, Simulation, Stream};
use floorguard_types::sensing::{DriveFeedback, DriveState, SafetyInput, WheelSample};
use floorguard_types::time::Stamp;

const INPUTS: InputMap = InputMap {
    emergency_stop: InputBits::new([32, 33]),
    bumper_front: InputBits::new([34, 35]),
    bumper_rear: Some(InputBits::new([36, 37])),
    cliff_front: Some(InputBits::new([40, 40])),
    cliff_rear: Some(InputBits::new([41, 41])),
    discrepancy_us: 100_000,
};

struct Rig {
    simulation: Simulation,
    base: ThreeWheelBase,
    now_us: u64,
    events: Vec<BaseEvent>,
    /// Frames of this node do not arrive.
    muted: Option<u8>,
    /// Nothing arrives in either direction.
    cut: bool,
    /// Send everything through the text of SLCAN.
    through_text: Option<TextLine>,
}

/// A serial line with an adapter: the host's end is ours, the adapter's end is the simulator's own codec.
#[derive(Default)]
struct TextLine {
    to_host: Vec<u8>,
    host: SlcanReceiver,
    adapter: sim_can::SlcanDecoder,
    portions: usize,
}

impl TextLine {
    /// From the bus to the host, in portions that respect no line, between the adapter's answers.
    fn receive(&mut self, frame: sim_can::CanFrame) -> Vec<CanFrame> {
        self.to_host.extend(sim_can::encode_slcan(&frame).bytes());
        let mut frames = Vec::new();
        self.portions += 1;
        // The end of the line is held back in two of three turns: it arrives with the next frame.
        let held = [0, 3, 7][self.portions % 3].min(self.to_host.len());
        let arrived: Vec<u8> = self.to_host.drain(..self.to_host.len() - held).collect();
        for portion in arrived.chunks(1 + self.portions % 11) {
            self.host.push(portion, |event| match event {
                SlcanEvent::Frame(frame) => frames.push(frame),
                SlcanEvent::AdapterError => panic!("the adapter refused a line"),
            });
        }
        frames
    }

    /// From the host to the bus.
    fn send(&mut self, frame: &CanFrame) -> sim_can::CanFrame {
        let line = encode_slcan(frame);
        let (start, end) = line.split_at(line.len() / 2);
        let first = self.adapter.push(start);
        assert!(first.0.is_empty());
        let (frames, answers) = self.adapter.push(end);
        // Answers stand between frames on the same line.
        if self.to_host.is_empty() {
            self.to_host.extend(answers);
        }
        frames[0]
    }
}

impl Rig {
    fn new() -> Self {
        let configuration = BaseConfiguration { inputs: INPUTS, ..BaseConfiguration::default() };
        Self {
            simulation: Simulation::new(&Scenario::named("empty").unwrap(), 7).unwrap(),
            base: ThreeWheelBase::new(configuration),
            now_us: 0,
            events: Vec::new(),
            muted: None,
            cut: false,
            through_text: None,
        }
    }

    fn run(&mut self, seconds: f64) {
        let end_us = self.now_us + (seconds * 1.0e6) as u64;
        while self.now_us < end_us {
            self.now_us += 1_000;
            let mut frames = Vec::new();
            self.simulation.advance_to(self.now_us, &mut |event| {
                if let (Stream::Can, Payload::Frame(frame)) = (event.stream, event.payload) {
                    frames.push((event.at_us, frame));
                }
            });
            for (at_us, frame) in frames {
                if self.cut || self.muted.is_some_and(|node| frame.id & 0x7F == u32::from(node)) {
                    continue;
                }
                let frames = match &mut self.through_text {
                    Some(line) => line.receive(frame),
                    None => vec![CanFrame::standard(frame.id as u16, frame.payload())],
                };
                for frame in frames {
                    let events = &mut self.events;
                    self.base.on_frame(&frame, Stamp::from_micros(at_us), &mut |event| events.push(event));
                }
            }
            if self.now_us.is_multiple_of(10_000) {
                let mut sent = Vec::new();
                let events = &mut self.events;
                self.base.poll(
                    Stamp::from_micros(self.now_us),
                    &mut |event| events.push(event),
                    &mut |frame| sent.push(*frame),
                );
                self.deliver(&sent);
            }
        }
    }

    fn deliver(&mut self, frames: &[CanFrame]) {
        for frame in frames {
            if self.cut {
                continue;
            }
            let frame = match &mut self.through_text {
                Some(line) => line.send(frame),
                None => {
                    let id = u32::from(frame.standard_id().unwrap());
                    sim_can::CanFrame::new(id, frame.payload())
                }
            };
            self.simulation.receive_can(frame, self.now_us);
        }
    }

    fn drive(&mut self, wheel_mps: f32, steering_rad: f32) {
        self.base.command(DriveCommand::Move { wheel_mps, steering_rad });
    }

    fn last_drive(&self) -> DriveFeedback {
        let mut reports = self.events.iter().rev();
        reports
            .find_map(|event| if let BaseEvent::Drive(drive) = event { Some(*drive) } else { None })
            .unwrap()
    }

    fn last_wheels(&self) -> WheelSample {
        let mut samples = self.events.iter().rev();
        samples
            .find_map(|event| if let BaseEvent::Wheels(wheels) = event { Some(*wheels) } else { None })
            .unwrap()
    }

    fn last_emergency_stop(&self) -> SafetyInput {
        let mut inputs = self.events.iter().rev();
        inputs
            .find_map(
                |event| {
                    if let BaseEvent::Inputs(inputs) = event { Some(inputs.emergency_stop) } else { None }
                },
            )
            .unwrap()
    }
}

#[test]
fn bus_is_up_within_a_second() {
    let mut rig = Rig::new();
    rig.run(1.0);
    assert!(rig.base.is_complete(), "{:?}", rig.base.devices().map(|device| device.phase()));
    assert_eq!(rig.last_drive().state, DriveState::Disabled, "no torque before anybody commands");
    assert_eq!(rig.last_emergency_stop(), SafetyInput::Clear);
    rig.drive(0.5, 0.0);
    rig.run(4.0);
    assert_eq!(rig.last_drive().state, DriveState::Enabled);
    let driven_m = rig.simulation.truth().robot.x_m;
    let ticks = rig.last_wheels();
    let measured_m = (ticks.left_ticks + ticks.right_ticks) as f32 / 2.0 / 20_000.0;
    assert!(driven_m > 1.5, "{driven_m}");
    assert!((measured_m - driven_m).abs() < 0.01 * driven_m, "{measured_m} {driven_m}");
    assert!((rig.last_drive().wheel_speed_mps - 0.5).abs() < 0.02);
    assert_eq!(rig.base.counters().refused, 0);
}

#[test]
fn steering_left_turns_left_by_wheel_odometry() {
    let mut rig = Rig::new();
    rig.through_text = Some(TextLine::default());
    rig.run(1.0);
    rig.drive(0.4, 0.6);
    rig.run(3.0);
    let truth = rig.simulation.truth();
    let wheels = rig.last_wheels();
    assert!(truth.robot.heading_rad > 0.3, "{truth:?}");
    assert!(wheels.right_ticks > wheels.left_ticks);
    let turned_rad = (wheels.right_ticks - wheels.left_ticks) as f32 / 20_000.0 / 0.6;
    assert!((turned_rad - truth.robot.heading_rad).abs() < 0.02, "{turned_rad} {}", truth.robot.heading_rad);
    assert!((rig.last_drive().steering_rad - 0.6).abs() < 0.01);
    let line = rig.through_text.unwrap();
    assert!(line.host.counters().frames > 1_000);
    assert_eq!(line.host.counters().refused, 0);
}

#[test]
fn each_stop_stands_within_its_distance() {
    for (kind, state) in [
        (StopKind::Hold, DriveState::Enabled),
        (StopKind::Ramp, DriveState::Disabled),
        (StopKind::TorqueOff, DriveState::Disabled),
    ] {
        let mut rig = Rig::new();
        rig.run(1.0);
        rig.drive(0.8, 0.0);
        rig.run(3.0);
        let from_m = rig.simulation.truth().robot.x_m;
        rig.base.command(DriveCommand::Stop(kind));
        let mut sent = Vec::new();
        rig.base.send_command(&mut |frame| sent.push(*frame));
        rig.deliver(&sent);
        rig.run(2.0);
        let truth = rig.simulation.truth();
        let path_m = truth.robot.x_m - from_m;
        assert!(truth.twist.linear_mps.abs() < 0.01, "{kind:?} {:?}", truth.twist);
        // The guard counts on 0.8 m/s² after 0.15 s: 0.52 m.
        assert!(path_m < 0.52, "{kind:?} {path_m}");
        assert_eq!(rig.last_drive().state, state, "{kind:?}");
    }
}

#[test]
fn emergency_stop_fault_needs_a_reset() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.5, 0.0);
    rig.run(2.0);
    rig.simulation.press_emergency_stop(true);
    rig.run(1.0);
    assert_eq!(rig.last_emergency_stop(), SafetyInput::Active);
    assert_eq!(rig.last_drive().state, DriveState::Fault(0x5441));
    rig.simulation.press_emergency_stop(false);
    rig.run(1.0);
    assert_eq!(rig.last_drive().state, DriveState::Fault(0x5441), "the command to move alone resets nothing");
    assert!(rig.simulation.truth().twist.linear_mps.abs() < 0.01);
    rig.base.command(DriveCommand::Stop(StopKind::TorqueOff));
    rig.base.reset_faults();
    rig.run(0.5);
    assert_eq!(rig.last_drive().state, DriveState::Disabled);
    rig.drive(0.5, 0.0);
    rig.run(2.0);
    assert!(rig.simulation.truth().twist.linear_mps > 0.4);
}

#[test]
fn silent_encoder_returns_without_a_jump() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.5, 0.0);
    rig.run(2.0);
    let before = rig.last_wheels();
    rig.muted = Some(3);
    rig.run(1.0);
    assert!(rig.events.contains(&BaseEvent::NodeLost(3)));
    assert!(!rig.base.is_complete());
    let silent_since = rig.last_wheels().stamp;
    assert!(silent_since.seconds_since(before.stamp) < 0.02, "one wheel alone is no sample");
    rig.muted = None;
    rig.run(1.5);
    assert!(rig.base.is_complete());
    let after = rig.last_wheels();
    let rolled = after.left_ticks.wrapping_sub(before.left_ticks);
    assert!(rolled > 0 && rolled < 20_000, "{rolled}");
}

/// Only the link from the drive to the master is broken: the master's heartbeat still reaches the drive, so that
/// its own watchdog stays quiet. The stop has to be sent although nobody answers.
#[test]
fn silent_drive_still_receives_stop_commands() {
    for deaf_s in [0.05, 1.0] {
        let mut rig = Rig::new();
        rig.run(1.0);
        rig.drive(0.5, 0.0);
        rig.run(2.0);
        rig.muted = Some(1);
        rig.run(deaf_s);
        rig.base.command(DriveCommand::Stop(StopKind::TorqueOff));
        rig.run(1.0);
        let speed_mps = rig.simulation.truth().twist.linear_mps;
        assert!(speed_mps.abs() < 0.01, "after {deaf_s} s of silence: {speed_mps}");
    }
}

/// Some other master, or a service tool, takes the drive out of operation, or restarts its communication. Process data
/// do not reach it any more while it is configured anew, and its power stage may still be on.
#[test]
fn drive_taken_out_of_operation_is_reported() {
    for command in [0x80, 0x82] {
        let mut rig = Rig::new();
        rig.run(1.0);
        rig.drive(0.5, 0.0);
        rig.run(2.0);
        rig.deliver(&[CanFrame::standard(0x000, &[command, 1])]);
        rig.run(0.02);
        rig.base.command(DriveCommand::Stop(StopKind::TorqueOff));
        rig.run(0.6);
        let speed_mps = rig.simulation.truth().twist.linear_mps;
        assert!(speed_mps.abs() < 0.01, "{command:02X}: {speed_mps}");
        assert!(rig.events.contains(&BaseEvent::NodeLost(1)), "{command:02X}");
        assert_eq!(rig.base.counters().losses, 1, "{command:02X}");
        rig.run(1.0);
        assert!(rig.base.is_complete(), "{command:02X}");
    }
}

/// A device that restarts in the middle of its configuration has forgotten the first half of it.
#[test]
fn restarted_device_is_configured_from_the_start() {
    let mut rig = Rig::new();
    rig.run(0.08);
    assert!(!rig.base.is_complete());
    rig.deliver(&[CanFrame::standard(0x000, &[0x82, 0])]);
    rig.run(1.5);
    assert!(rig.base.is_complete(), "{:?}", rig.base.devices().map(|device| device.phase()));
    assert_eq!(rig.last_drive().state, DriveState::Disabled);
    assert!(rig.last_wheels().stamp.seconds_since(Stamp::ZERO) > 1.5);
}

/// The cable breaks: the drive's own watchdog (1016h, 6007h) has to stop the robot.
#[test]
fn a_broken_cable_stops_the_robot_without_us() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.8, 0.0);
    rig.run(3.0);
    let from_m = rig.simulation.truth().robot.x_m;
    rig.cut = true;
    rig.run(1.0);
    let truth = rig.simulation.truth();
    assert!(truth.twist.linear_mps.abs() < 0.01, "{:?}", truth.twist);
    // 0.2 s of silence, a heartbeat's distance before it, then 2 m/s².
    let path_m = truth.robot.x_m - from_m;
    assert!(path_m < 0.8 * 0.26 + 0.16 + 0.02, "{path_m}");
    for node in 1..=5 {
        assert!(rig.events.contains(&BaseEvent::NodeLost(node)), "{node}");
    }
    assert_eq!(rig.base.counters().losses, 5);
    rig.base.command(DriveCommand::Stop(StopKind::TorqueOff));
    rig.cut = false;
    rig.run(1.5);
    assert!(rig.base.is_complete());
    assert_eq!(rig.last_drive().state, DriveState::Disabled);
    rig.drive(0.5, 0.0);
    rig.run(2.0);
    assert!(rig.simulation.truth().twist.linear_mps > 0.4);
}

/// Too short a break for us to miss a heartbeat, long enough for the drive: it has stopped by itself, and that is a
/// fault until somebody resets it.
#[test]
fn self_stopped_drive_is_fault_until_reset() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.8, 0.0);
    // In the middle between two heartbeats: two of them are missed.
    rig.run(2.05);
    rig.cut = true;
    rig.run(0.21);
    rig.cut = false;
    rig.run(1.0);
    assert_eq!(rig.base.counters().losses, 0);
    assert!(matches!(rig.last_drive().state, DriveState::Fault(_)), "{:?}", rig.last_drive());
    assert!(rig.simulation.truth().twist.linear_mps.abs() < 0.01, "although the command is still to move");
    let watchdog = |event: &BaseEvent| matches!(event, BaseEvent::Emergency(1, lost) if lost.code == 0x8130);
    assert!(rig.events.iter().any(watchdog));
    rig.base.reset_faults();
    rig.run(2.0);
    assert_eq!(rig.last_drive().state, DriveState::Enabled);
}

/// Our own computer restarts while the robot moves: the new master stops it before it configures anything.
#[test]
fn new_master_stops_a_running_robot_first() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.8, 0.0);
    rig.run(3.0);
    let from_m = rig.simulation.truth().robot.x_m;
    let configuration = BaseConfiguration { inputs: INPUTS, ..BaseConfiguration::default() };
    rig.base = ThreeWheelBase::new(configuration);
    rig.run(0.7);
    let truth = rig.simulation.truth();
    assert!(truth.twist.linear_mps.abs() < 0.01, "{:?}", truth.twist);
    // The brake's 1.5 m/s² and two polls.
    let path_m = truth.robot.x_m - from_m;
    assert!(path_m < 0.30, "{path_m}");
    rig.run(0.5);
    assert!(rig.base.is_complete());
}

/// Without the gateway no input is judged any more: its last report must not stay in force.
#[test]
fn silent_gateway_is_unknown_not_clear() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.muted = Some(5);
    let before = rig.events.len();
    rig.run(1.0);
    let inputs = |event: &&BaseEvent| matches!(event, BaseEvent::Inputs(_));
    assert_eq!(rig.events[before..].iter().find(inputs), None);
    assert!(rig.events.contains(&BaseEvent::NodeLost(5)));
    rig.simulation.safety_channels().bumper_front = [true, false];
    rig.muted = None;
    rig.run(1.5);
    assert!(rig.base.is_complete());
    let last = rig.events.iter().rev().find_map(|event| match event {
        BaseEvent::Inputs(inputs) => Some(*inputs),
        _ => None,
    });
    assert_eq!(
        last.map(|inputs| inputs.bumper_front),
        Some(SafetyInput::Fault),
        "one channel for over 100 ms"
    );
}

/// From the command to the drive's target: the frame leaves within the call, or with the very next poll.
#[test]
fn stop_is_first_frame_of_next_poll() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.5, 0.0);
    rig.run(2.0);
    for (kind, word) in [(StopKind::Hold, 0x0F), (StopKind::Ramp, 0x02), (StopKind::TorqueOff, 0x00)] {
        rig.base.command(DriveCommand::Stop(kind));
        let mut sent = Vec::new();
        rig.base.poll(Stamp::from_micros(rig.now_us), &mut |_| {}, &mut |frame| sent.push(*frame));
        assert_eq!(sent.first(), Some(&CanFrame::standard(0x201, &[word, 0, 0, 0, 0, 0])));
    }
}
