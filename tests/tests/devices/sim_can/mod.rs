//! The bus master of `drivers` against the simulator's devices, which were written from the description of the format
//! alone.

mod commands;
mod losses;

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
