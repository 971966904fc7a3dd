//! The world's clockwork.
//!
//! The robot and the bus move every millisecond, people every ten, each sensor at its own times. Events are handed out
//! strictly in the order of their arrival.

use std::collections::BTreeMap;

use floorguard_types::geometry::{Point2, Pose2, Twist2};

use super::arrivals::Arrivals;
use super::broken::BrokenDevices;
use super::bus::Bus;
use super::dirt::DirtyWorld;
use super::misplaced::mounted;
use super::touch::Touch;
use crate::can::{CanFrame, SafetyChannels};
use crate::dirt::DirtyFloor;
use crate::floor::PictureMoment;
use crate::people::{Crowd, RobotShape};
use crate::robot::{BrakeLaw, RobotBody, RobotParameters, Train};
use crate::scenario::{Scenario, ScenarioError};
use crate::scene::Scene;
use crate::sensors::{
    FloorCameraSensor, FloorFrame, ImuSensor, LidarSensor, Motion, Scanner, ScannerState, View,
};
use crate::wire::{Payload, Stream, WireEvent};

const STEP_US: u64 = 1_000;
const PEOPLE_STEP_US: u64 = 10_000;
/// Once per 14 data packets (book, Velodyne: Position packet).
const POSITION_US: u64 = 18_579;
/// From the last firing of a packet to its arrival.
const ETHERNET_US: u64 = 120;
/// Bytes of ten bits at 115,200 baud.
const IMU_BYTE_US: u64 = 87;

/// What moves the robot in place of its drives.
#[derive(Clone, Copy, Debug)]
struct Towed {
    law: BrakeLaw,
    steering_rad: Option<f32>,
}

/// A world that runs.
pub struct Simulation {
    pub(super) parameters: RobotParameters,
    pub(super) nominal: RobotParameters,
    pub(super) scene: Scene,
    pub(super) arrivals: Arrivals,
    pub(super) crowd: Crowd,
    pub(super) body: RobotBody,
    pub(super) bus: Bus,
    lidar: LidarSensor,
    scanner: Scanner,
    rear_scanner: Option<Scanner>,
    imu: ImuSensor,
    dirt: Option<DirtyWorld>,
    touch: Touch,
    turn_radps2: f32,
    broken: BrokenDevices,
    towed: Option<Towed>,
    pub(super) now_us: u64,
    next_step_us: u64,
    step_us: u64,
    next_position_us: u64,
    queue: BTreeMap<(u64, u64), WireEvent>,
    sequence: u64,
}

impl Simulation {
    /// A world with the default robot.
    ///
    /// # Errors
    /// The scenario cannot be played.
    pub fn new(scenario: &Scenario, seed: u64) -> Result<Self, ScenarioError> {
        Self::with_robot(scenario, seed, RobotParameters::default())
    }

    /// A world with another robot.
    ///
    /// # Errors
    /// The scenario cannot be played.
    pub fn with_robot(
        scenario: &Scenario,
        seed: u64,
        parameters: RobotParameters,
    ) -> Result<Self, ScenarioError> {
        let scene = scenario.scene.build();
        let nominal = parameters;
        let parameters = mounted(scenario, nominal.clone());
        let mut body = RobotBody::new(parameters.clone(), scenario.start_pose());
        body.grip = scenario.grip.unwrap_or(body.grip).clamp(0.0, 1.0);
        let broken = BrokenDevices::of(scenario);
        broken.break_encoders(&mut body);
        Ok(Self {
            touch: Touch::new(&parameters, scenario, &scene),
            nominal,
            dirt: DirtyWorld::new((scenario, &scene), &parameters, seed),
            scene,
            arrivals: Arrivals::of(&scenario.scene),
            crowd: Crowd::new(scenario.people(seed)).with_attention(scenario.attentive),
            body,
            bus: Bus::new(&parameters),
            lidar: LidarSensor::of(parameters.lidar_device, seed),
            scanner: Scanner::of(parameters.scanner_device, seed),
            rear_scanner: parameters.rear_scanner.map(|_| Scanner::at_rear(seed)),
            imu: ImuSensor::new(parameters.imu_device, seed),
            turn_radps2: 0.0,
            broken,
            towed: None,
            parameters,
            now_us: 0,
            next_step_us: 0,
            step_us: 0,
            next_position_us: POSITION_US,
            queue: BTreeMap::new(),
            sequence: 0,
        })
    }

    /// When something happens next, microseconds; never later than a millisecond ahead.
    #[must_use]
    pub fn next_event_us(&self) -> u64 {
        let queued = self.queue.keys().next().map_or(u64::MAX, |(at_us, _)| *at_us);
        queued.min(self.next_internal_us())
    }

    fn next_internal_us(&self) -> u64 {
        self.next_step_us
            .min(self.lidar.due_us())
            .min(self.scanner.due_us())
            .min(self.rear_scanner.as_ref().map_or(u64::MAX, Scanner::due_us))
            .min(self.imu.due_us())
            .min(self.next_position_us)
    }

    /// Plays up to and including this moment; every event goes to `sink`, in order.
    pub fn advance_to(&mut self, at_us: u64, sink: &mut dyn FnMut(WireEvent)) {
        loop {
            let internal_us = self.next_internal_us();
            self.hand_out(internal_us.min(at_us.saturating_add(1)), sink);
            if internal_us > at_us {
                break;
            }
            self.now_us = self.now_us.max(internal_us);
            self.happen(internal_us);
        }
        self.now_us = self.now_us.max(at_us);
    }

    /// Hands out what arrives before a moment.
    fn hand_out(&mut self, before_us: u64, sink: &mut dyn FnMut(WireEvent)) {
        while let Some(entry) = self.queue.first_entry() {
            if entry.key().0 >= before_us {
                break;
            }
            sink(entry.remove());
        }
    }

    fn happen(&mut self, at_us: u64) {
        if self.next_step_us == at_us {
            self.step();
        }
        if self.lidar.due_us() == at_us {
            let mount = self.parameters.lidar;
            let view = View::new(&self.scene, &self.crowd.people, (&self.body, mount), 60.0);
            let bytes = self.lidar.measure(&view, self.step_us);
            self.push(at_us + ETHERNET_US, Stream::LidarData, Payload::Bytes(bytes));
        }
        if self.next_position_us == at_us {
            self.next_position_us += POSITION_US;
            if let Some(bytes) = self.lidar.position_packet(at_us) {
                self.push(at_us + ETHERNET_US, Stream::LidarPosition, Payload::Bytes(bytes));
            }
        }
        if self.scanner.due_us() == at_us {
            let mount = self.parameters.scanner;
            let view = View::new(&self.scene, &self.crowd.people, (&self.body, mount), 31.0);
            let stream = self.scanner.stream();
            for (at_us, bytes) in self.scanner.measure(&view, at_us, self.step_us) {
                self.push(at_us, stream, Payload::Bytes(bytes));
            }
        }
        self.look_behind(at_us);
        if self.imu.due_us() == at_us {
            let motion = self.felt_motion();
            if let Some(bytes) = self.imu.sample(at_us, motion) {
                let sent_us = at_us + 500 + bytes.len() as u64 * IMU_BYTE_US;
                self.push(sent_us, Stream::ImuSerial, Payload::Bytes(bytes));
            }
        }
    }

    /// The second scanner, if its beams are due.
    fn look_behind(&mut self, at_us: u64) {
        let (Some(mount), Some(scanner)) = (self.parameters.rear_scanner, &mut self.rear_scanner) else {
            return;
        };
        if scanner.due_us() != at_us {
            return;
        }
        let view = View::new(&self.scene, &self.crowd.people, (&self.body, mount), 31.0);
        for (at_us, bytes) in scanner.measure(&view, at_us, self.step_us) {
            self.push(at_us, Stream::RearScannerSerial, Payload::Bytes(bytes));
        }
    }

    fn step(&mut self) {
        let now_us = self.next_step_us;
        let step_s = STEP_US as f32 * 1.0e-6;
        if now_us > 0 {
            let driven = if self.bus.power_cut() { None } else { self.bus.steering_target_rad() };
            let (law, steering) = match self.towed {
                Some(towed) if !self.bus.power_cut() => (towed.law, towed.steering_rad),
                _ => (self.bus.brake_law(), driven),
            };
            self.broken.break_drives(&mut self.body, now_us);
            let turn_before = self.body.twist().angular_radps;
            self.body.step(step_s, law, steering);
            self.turn_radps2 = (self.body.twist().angular_radps - turn_before) / step_s;
        }
        self.step_us = now_us;
        for frame in self.bus.tick(now_us, step_s, &self.body) {
            self.push_frame(now_us, frame);
        }
        if now_us.is_multiple_of(PEOPLE_STEP_US) {
            self.let_come(now_us);
            let robot = RobotShape {
                pose: self.body.pose(),
                outline: &self.parameters.footprint,
                seen_as: (Point2::new(0.25, 0.0), 0.85),
            };
            self.crowd.step(now_us, PEOPLE_STEP_US as f32 * 1.0e-6, &self.scene, &robot);
            let felt = (&self.scene, self.crowd.people.as_slice());
            self.touch.feel(self.body.pose(), felt, &mut self.bus.channels);
            self.clean(now_us);
        }
        self.next_step_us += STEP_US;
    }

    /// The brush has moved on, and the dirt sensor speaks when it is time.
    fn clean(&mut self, now_us: u64) {
        let pose = self.body.pose();
        let frame = self.dirt.as_mut().and_then(|dirt| dirt.step(pose, (now_us, PEOPLE_STEP_US)));
        if let Some(frame) = frame {
            self.push_frame(now_us, frame);
        }
    }

    /// At the IMU's place: the rear axle's acceleration, and what the turn about it adds.
    fn felt_motion(&self) -> Motion {
        let twist = self.body.twist();
        let turn = twist.angular_radps;
        Motion {
            forward_mps2: self.body.acceleration_mps2() - turn * turn * self.parameters.imu.x_m,
            left_mps2: twist.linear_mps * turn + self.turn_radps2 * self.parameters.imu.x_m,
            yaw_radps: turn + self.broken.false_turn_radps(self.now_us),
            heading_rad: self.body.pose().heading_rad,
        }
    }

    fn push(&mut self, at_us: u64, stream: Stream, payload: Payload) {
        self.sequence += 1;
        self.queue.insert((at_us.max(self.now_us), self.sequence), WireEvent { at_us, stream, payload });
    }

    fn push_frame(&mut self, ready_us: u64, frame: CanFrame) {
        let at_us = self.bus.arrival_us(ready_us, &frame);
        self.push(at_us, Stream::Can, Payload::Frame(frame));
    }

    /// Bytes that the robot's computer has written to a line; the IMU listens, and a scanner that must be asked.
    pub fn receive(&mut self, stream: Stream, bytes: &[u8]) {
        if stream == Stream::ScannerSerial {
            self.scanner.receive(bytes, self.now_us);
        }
        if stream != Stream::ImuSerial || bytes.is_empty() {
            return;
        }
        let answer = self.imu.receive(bytes, self.now_us);
        if !answer.is_empty() {
            let at_us = self.now_us + 1_000 + answer.len() as u64 * IMU_BYTE_US;
            self.push(at_us, Stream::ImuSerial, Payload::Bytes(answer));
        }
    }

    /// A frame that the robot's computer has sent; `at_us` is not before the last moment played.
    pub fn receive_can(&mut self, frame: CanFrame, at_us: u64) {
        let arrives_us = self.bus.arrival_us(at_us.max(self.now_us), &frame);
        let ahead_s = (arrives_us - self.step_us.min(arrives_us)) as f32 * 1.0e-6;
        for answer in self.bus.receive(&frame, arrives_us, &self.body, ahead_s) {
            self.push_frame(arrives_us, answer);
        }
    }

    /// Measures only one firing of the lidar in `grain`: see [`LidarSensor::coarse`].
    pub const fn coarse_lidar(&mut self, grain: usize) {
        self.lidar.coarse(grain);
    }

    /// Moves the robot past its drives, for experiments that only need moving sensors: rim speed of the front wheel
    /// (m/s) and steering angle (radians, counter-clockwise).
    pub const fn tow(&mut self, rim_mps: f32, steering_rad: f32) {
        self.towed = Some(Towed { law: BrakeLaw::Driven(rim_mps), steering_rad: Some(steering_rad) });
    }

    /// The same by a velocity of the base point: how a base drives that takes velocities, on its own wheels. A front wheel, and the
    /// front wheels of a car, must be turned first.
    pub fn tow_at(&mut self, velocity: Twist2) {
        let across_mps = velocity.angular_radps * self.parameters.wheelbase_m;
        let sign = if velocity.linear_mps < 0.0 { -1.0 } else { 1.0 };
        let steering_rad = libm::atan2f(sign * across_mps, sign * velocity.linear_mps);
        match self.parameters.train {
            Train::FrontWheel => self.tow(sign * libm::hypotf(velocity.linear_mps, across_mps), steering_rad),
            Train::RearAxle => self.tow(velocity.linear_mps, steering_rad),
            Train::TwoWheels | Train::FourMecanum => {
                let law = BrakeLaw::Wheels(self.body.rims_for(velocity).map(Some));
                self.towed = Some(Towed { law, steering_rad: None });
            }
        }
    }

    /// Presses or releases the emergency stop, both channels.
    pub fn press_emergency_stop(&mut self, pressed: bool) {
        self.bus.channels.emergency_stop = [!pressed; 2];
    }

    /// The safety controller's inputs, for scripted events.
    pub const fn safety_channels(&mut self) -> &mut SafetyChannels {
        &mut self.bus.channels
    }

    /// An internal fault of the traction drive, with an EMCY code.
    pub fn fail_traction(&mut self, code: u16) {
        let mut out = Vec::new();
        self.bus.fail_traction(code, &mut out);
        for frame in out {
            self.push_frame(self.now_us, frame);
        }
    }

    /// Takes the power from the inertial sensor for some time.
    pub fn power_cycle_imu(&mut self, off_us: u64) {
        self.imu.power_cycle(self.now_us, off_us);
    }

    /// The inertial sensor, for what only its maker knows.
    #[must_use]
    pub const fn imu(&self) -> &ImuSensor {
        &self.imu
    }

    /// What the scanner is doing.
    pub const fn set_scanner_state(&mut self, state: ScannerState) {
        self.scanner.state = state;
    }

    /// Share of the front wheel's grip that is left: 1 dry, 0.3 wet soap.
    pub const fn set_grip(&mut self, grip: f32) {
        self.body.grip = grip;
    }

    /// The dirt that really lies on the floor; `None` in a scenario without.
    #[must_use]
    pub fn dirt(&self) -> Option<&DirtyFloor> {
        self.dirt.as_ref().map(DirtyWorld::floor)
    }

    /// What a floor camera sees at the last moment played; `frame` draws its noise.
    #[must_use]
    pub fn floor_frame(&self, sensor: &FloorCameraSensor, frame: u32) -> FloorFrame {
        let seen = (&self.scene, self.crowd.people.as_slice(), self.dirt());
        sensor.render(seen, self.body.pose(), PictureMoment { frame, at_s: self.now_us as f32 * 1.0e-6 })
    }

    /// The robot that is simulated.
    #[must_use]
    pub const fn parameters(&self) -> &RobotParameters {
        &self.parameters
    }

    /// Pose (world frame) and speed of the robot at the last moment played.
    #[must_use]
    pub fn robot(&self) -> (Pose2, Twist2) {
        (self.body.pose(), self.body.twist())
    }
}
