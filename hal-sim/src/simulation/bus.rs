//! Everything on the CAN bus and how it moves the robot.

use crate::can::{CanFrame, Drive, DriveKind, Encoder, Gateway, MeasuredMotion, SafetyChannels};
use crate::robot::{BrakeLaw, NodeIds, RobotBody};

/// The devices on the bus.
#[derive(Clone, Debug)]
pub struct Bus {
    /// Front wheel.
    pub traction: Drive,
    /// Front wheel's angle.
    pub steering: Drive,
    encoders: [Encoder; 2],
    gateway: Gateway,
    /// What the switches do.
    pub channels: SafetyChannels,
    /// The bus is occupied until then.
    free_us: u64,
}

impl Bus {
    /// All devices just powered.
    #[must_use]
    pub fn new(nodes: NodeIds) -> Self {
        Self {
            traction: Drive::new(nodes.traction, DriveKind::Traction),
            steering: Drive::new(nodes.steering, DriveKind::Steering),
            encoders: [Encoder::new(nodes.left_encoder), Encoder::new(nodes.right_encoder)],
            gateway: Gateway::new(nodes.gateway),
            channels: SafetyChannels::default(),
            free_us: 0,
        }
    }

    /// The emergency stop cuts the drive's power in hardware (book, Safety inputs: Two channels).
    #[must_use]
    pub fn power_cut(&self) -> bool {
        self.channels.emergency_stop.contains(&false)
    }

    /// How the robot's body is held.
    #[must_use]
    pub fn brake_law(&self) -> BrakeLaw {
        if self.traction.powered() && !self.power_cut() {
            BrakeLaw::Driven(self.traction.demand_mps())
        } else {
            BrakeLaw::Braked
        }
    }

    /// A frame from the robot's computer reaches every device; `counts` are exact for this moment.
    pub fn receive(
        &mut self,
        frame: &CanFrame,
        now_us: u64,
        body: &RobotBody,
        ahead_s: f32,
    ) -> Vec<CanFrame> {
        let mut out = Vec::new();
        if frame.id == 0x080 {
            let mut unsent = Vec::new();
            self.measure(now_us, body, ahead_s, &mut unsent);
            out.append(&mut unsent);
        }
        self.traction.receive(frame, now_us, &mut out);
        self.steering.receive(frame, now_us, &mut out);
        for encoder in &mut self.encoders {
            encoder.receive(frame, now_us, &mut out);
        }
        self.gateway.receive(frame, now_us, &mut out);
        out
    }

    fn measure(&mut self, now_us: u64, body: &RobotBody, ahead_s: f32, out: &mut Vec<CanFrame>) {
        let counts = body.counts(ahead_s);
        let speeds = body.wheel_speeds();
        for side in 0..2 {
            let counts_per_s = speeds[side] * body.ticks_per_m();
            self.encoders[side].tick(now_us, counts[side], counts_per_s, out);
        }
    }

    /// One step of all devices.
    pub fn tick(&mut self, now_us: u64, step_s: f32, body: &RobotBody) -> Vec<CanFrame> {
        let mut out = Vec::new();
        if self.power_cut() && self.traction.powered() {
            self.traction.fail(0x5441, &mut out);
        }
        let measured = MeasuredMotion { speed_mps: body.front_mps(), angle_rad: body.steering_rad() };
        self.traction.tick(now_us, step_s, measured, &mut out);
        self.steering.tick(now_us, step_s, MeasuredMotion { speed_mps: 0.0, ..measured }, &mut out);
        self.measure(now_us, body, 0.0, &mut out);
        self.gateway.tick(now_us, self.channels, &mut out);
        out
    }

    /// When a frame that is ready now has crossed the bus.
    pub fn arrival_us(&mut self, now_us: u64, frame: &CanFrame) -> u64 {
        self.free_us = self.free_us.max(now_us) + frame.duration_us();
        self.free_us
    }
}
