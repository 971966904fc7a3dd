//! What the tests of the sensors against the simulator share: a room whose ranges a sheet of paper can tell, and a
//! driver's seat.

use floorguard_drivers::can::CanFrame;
use floorguard_drivers::three_wheel_base::{BaseConfiguration, DriveCommand, ThreeWheelBase};
use floorguard_sim::can as sim_can;
use floorguard_sim::robot::RobotParameters;
use floorguard_sim::scenario::Scenario;
use floorguard_sim::{Payload, Simulation, Stream, WireEvent};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

/// Half sizes of the room's inner faces, metres.
pub const HALF_M: [f32; 2] = [4.95, 3.95];

/// A room of 9.9 m by 7.9 m with high walls around the origin of the world; the robot stands in it at an odd angle.
pub fn room(start: Pose2) -> Scenario {
    // The walls are 0.1 m thick: their inner faces lie 0.05 m inside of their middle lines.
    let text = format!(
        r#"
title = "a room"
[start]
at_m = [{}, {}]
yaw_deg = {}
[scene]
wall = [
  {{ from_m = [-5.0, -4.0], to_m = [5.0, -4.0], height_m = 6.0 }},
  {{ from_m = [-5.0, 4.0], to_m = [5.0, 4.0], height_m = 6.0 }},
  {{ from_m = [-5.0, -4.0], to_m = [-5.0, 4.0], height_m = 6.0 }},
  {{ from_m = [5.0, -4.0], to_m = [5.0, 4.0], height_m = 6.0 }},
]
"#,
        start.x_m,
        start.y_m,
        start.heading_rad.to_degrees()
    );
    Scenario::from_toml(&text).unwrap()
}

/// Along a beam from inside the room to its wall, seen from above: plane geometry, no ray caster.
pub fn wall_range_m(from: Point2, bearing_rad: f64) -> f64 {
    let along = |at: f32, half: f32, direction: f64| {
        let face = f64::from(half).copysign(direction);
        if direction.abs() < 1.0e-9 { f64::INFINITY } else { (face - f64::from(at)) / direction }
    };
    along(from.x_m, HALF_M[0], bearing_rad.cos()).min(along(from.y_m, HALF_M[1], bearing_rad.sin()))
}

/// The simulated world with a driver.
pub struct DrivenSimulation {
    pub simulation: Simulation,
    base: ThreeWheelBase,
    now_us: u64,
}

impl DrivenSimulation {
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        Self::with_robot(scenario, seed, RobotParameters::default())
    }

    pub fn with_robot(scenario: &Scenario, seed: u64, robot: RobotParameters) -> Self {
        Self {
            simulation: Simulation::with_robot(scenario, seed, robot).unwrap(),
            base: ThreeWheelBase::new(BaseConfiguration::default()),
            now_us: 0,
        }
    }

    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    pub fn drive(&mut self, wheel_mps: f32, steering_rad: f32) {
        self.base.command(DriveCommand::Move { wheel_mps, steering_rad });
    }

    /// One millisecond; what the sensors sent meanwhile.
    pub fn step(&mut self) -> Vec<WireEvent> {
        self.now_us += 1_000;
        let mut events = Vec::new();
        self.simulation.advance_to(self.now_us, &mut |event| events.push(event));
        for event in &events {
            if let (Stream::Can, Payload::Frame(frame)) = (event.stream, &event.payload) {
                let frame = CanFrame::standard(frame.id as u16, frame.payload());
                self.base.on_frame(&frame, Stamp::from_micros(event.at_us), &mut |_| {});
            }
        }
        if self.now_us.is_multiple_of(10_000) {
            let mut frames = Vec::new();
            self.base.poll(Stamp::from_micros(self.now_us), &mut |_| {}, &mut |frame| frames.push(*frame));
            for frame in frames {
                let id = u32::from(frame.standard_id().unwrap());
                self.simulation.receive_can(sim_can::CanFrame::new(id, frame.payload()), self.now_us);
            }
        }
        events.retain(|event| event.stream != Stream::Can);
        events
    }
}

/// The bytes of an event on a line.
pub fn bytes_of(event: &WireEvent, stream: Stream) -> Option<&[u8]> {
    match &event.payload {
        Payload::Bytes(bytes) if event.stream == stream => Some(bytes),
        _ => None,
    }
}

/// Mean and standard deviation.
pub fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    (mean, variance.sqrt())
}
