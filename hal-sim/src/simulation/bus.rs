//! Everything on the CAN bus and how it moves the robot.

use crate::can::{CanFrame, Drive, DriveKind, Encoder, Gateway, MeasuredMotion, SafetyChannels};
use crate::motors::MotorBank;
use crate::robot::{BrakeLaw, RobotBody, RobotParameters, Train};

/// A byte on a serial line of motor controllers: ten bits at 115,200 baud, microseconds.
const LINE_BYTE_US: u64 = 87;

/// What moves the robot.
#[derive(Clone, Debug)]
enum Drives {
    /// One drive of the front wheel or of the rear axle, one that steers, encoders on the rear wheels.
    Steered { traction: Box<Drive>, steering: Box<Drive>, encoders: [Encoder; 2] },
    /// A drive on each wheel, with an encoder of its own.
    Wheels(Vec<Drive>),
    /// Controllers other than CiA 402 drives.
    Motors(Box<MotorBank>),
}

impl Drives {
    fn new(robot: &RobotParameters) -> Self {
        let nodes = robot.nodes;
        if let Some(motors) = robot.motors {
            return Self::Motors(Box::new(MotorBank::new(motors)));
        }
        match robot.train {
            Train::FrontWheel | Train::RearAxle => Self::Steered {
                traction: Box::new(Drive::new(nodes.traction, DriveKind::Traction)),
                steering: Box::new(Drive::new(nodes.steering, DriveKind::Steering)),
                encoders: [Encoder::new(nodes.left_encoder), Encoder::new(nodes.right_encoder)],
            },
            Train::TwoWheels | Train::FourMecanum => {
                let fitted = nodes.wheels.into_iter().take_while(|node| *node != 0);
                Self::Wheels(fitted.map(|node| Drive::new(node, DriveKind::Wheel)).collect())
            }
        }
    }

    /// The drive of the front wheel, or those of all wheels.
    fn traction(&mut self) -> &mut [Drive] {
        match self {
            Self::Steered { traction, .. } => std::slice::from_mut(&mut **traction),
            Self::Wheels(drives) => drives,
            Self::Motors(_) => &mut [],
        }
    }
}

/// The devices on the bus.
#[derive(Clone, Debug)]
pub struct Bus {
    drives: Drives,
    gateway: Option<Gateway>,
    /// What the switches do.
    pub channels: SafetyChannels,
    /// The bus is occupied until then.
    free_us: u64,
}

impl Bus {
    /// All devices just powered.
    #[must_use]
    pub fn new(robot: &RobotParameters) -> Self {
        let gateway = robot.nodes.gateway;
        Self {
            drives: Drives::new(robot),
            gateway: (gateway != 0).then(|| Gateway::new(gateway)),
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
        match &self.drives {
            _ if self.power_cut() => BrakeLaw::Braked,
            Drives::Steered { traction, .. } if traction.powered() => BrakeLaw::Driven(traction.demand_mps()),
            Drives::Steered { .. } => BrakeLaw::Braked,
            Drives::Wheels(drives) => {
                // A wheel that is not there stands.
                let mut wheels = [Some(0.0); 4];
                for (wheel, drive) in wheels.iter_mut().zip(drives) {
                    *wheel = drive.powered().then(|| drive.demand_mps());
                }
                BrakeLaw::Wheels(wheels)
            }
            Drives::Motors(motors) => BrakeLaw::Wheels(motors.demands_mps()),
        }
    }

    /// Angle commanded to the steering, radians; `None` while it does not move.
    #[must_use]
    pub fn steering_target_rad(&self) -> Option<f32> {
        match &self.drives {
            Drives::Steered { steering, .. } => steering.target_rad(),
            Drives::Wheels(_) | Drives::Motors(_) => None,
        }
    }

    /// An internal fault of the traction drive, or of the first wheel's.
    pub fn fail_traction(&mut self, code: u16, out: &mut Vec<CanFrame>) {
        self.drives.traction().iter_mut().take(1).for_each(|drive| drive.fail(code, out));
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
        self.drives.traction().iter_mut().for_each(|drive| drive.receive(frame, now_us, &mut out));
        match &mut self.drives {
            Drives::Steered { steering, encoders, .. } => {
                steering.receive(frame, now_us, &mut out);
                for encoder in encoders {
                    encoder.receive(frame, now_us, &mut out);
                }
            }
            Drives::Wheels(_) => {}
            Drives::Motors(motors) => motors.receive(frame, now_us, &mut out),
        }
        if let Some(gateway) = &mut self.gateway {
            gateway.receive(frame, now_us, &mut out);
        }
        out
    }

    fn measure(&mut self, now_us: u64, body: &RobotBody, ahead_s: f32, out: &mut Vec<CanFrame>) {
        let counts = body.wheel_counts(ahead_s);
        match &mut self.drives {
            Drives::Steered { encoders, .. } => {
                let speeds = body.wheel_speeds();
                for side in 0..2 {
                    let counts_per_s = speeds[side] * body.ticks_per_m();
                    encoders[side].tick(now_us, counts[side], counts_per_s, out);
                }
            }
            Drives::Wheels(drives) => {
                drives.iter_mut().zip(counts).for_each(|(drive, counts)| drive.place(counts));
            }
            Drives::Motors(_) => {}
        }
    }

    /// One step of all devices.
    pub fn tick(&mut self, now_us: u64, step_s: f32, body: &RobotBody) -> Vec<CanFrame> {
        let mut out = Vec::new();
        if self.power_cut() {
            let powered = self.drives.traction().iter_mut().filter(|drive| drive.powered());
            powered.for_each(|drive| drive.fail(0x5441, &mut out));
            if let Drives::Motors(motors) = &mut self.drives {
                motors.cut_power();
            }
        }
        match &mut self.drives {
            Drives::Steered { traction, steering, .. } => {
                let angle_rad = body.steering_rad();
                let measured = MeasuredMotion { speed_mps: body.front_mps(), angle_rad, counts: 0 };
                traction.tick(now_us, step_s, measured, &mut out);
                steering.tick(now_us, step_s, MeasuredMotion { speed_mps: 0.0, ..measured }, &mut out);
            }
            Drives::Wheels(drives) => {
                let wheels = drives.iter_mut().zip(body.rims_mps()).zip(body.wheel_counts(0.0));
                for ((drive, speed_mps), counts) in wheels {
                    let measured = MeasuredMotion { speed_mps, angle_rad: 0.0, counts };
                    drive.tick(now_us, step_s, measured, &mut out);
                }
            }
            Drives::Motors(motors) => {
                motors.tick((now_us, step_s), (body.rims_mps(), body.rolled_m()), &mut out);
            }
        }
        self.measure(now_us, body, 0.0, &mut out);
        if let Some(gateway) = &mut self.gateway {
            gateway.tick(now_us, self.channels, &mut out);
        }
        out
    }

    /// When a frame that is ready now has crossed the bus.
    pub fn arrival_us(&mut self, now_us: u64, frame: &CanFrame) -> u64 {
        let is_line = match &self.drives {
            Drives::Motors(motors) => motors.parameters().kind.is_serial(),
            Drives::Steered { .. } | Drives::Wheels(_) => false,
        };
        let duration_us = if is_line { u64::from(frame.len) * LINE_BYTE_US } else { frame.duration_us() };
        self.free_us = self.free_us.max(now_us) + duration_us;
        self.free_us
    }
}
