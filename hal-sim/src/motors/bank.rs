//! All controllers of a base.

use std::collections::BTreeSet;

use super::odrive::OdriveAxis;
use super::roboteq::RoboteqController;
use super::roboteq_bus::RoboteqBusController;
use super::vesc::VescController;
use super::wheel_line::WheelController;
use crate::can::CanFrame;

/// What the controllers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorKind {
    /// ODrive on a bus, an axis a wheel.
    Odrive,
    /// VESC on a bus, one a wheel.
    Vesc,
    /// Roboteq with two channels on a serial line.
    Roboteq,
    /// Roboteq on a bus; wheels with one number are the channels of one controller.
    RoboteqCan,
    /// The wheel line.
    WheelLine,
}

impl MotorKind {
    /// It is on a serial line.
    #[must_use]
    pub const fn is_serial(self) -> bool {
        matches!(self, Self::Roboteq | Self::WheelLine)
    }
}

/// What is fixed about the controllers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorParameters {
    /// What they are.
    pub kind: MotorKind,
    /// Wheels.
    pub wheels: usize,
    /// Their numbers on the bus.
    pub nodes: [u8; 4],
    /// How far a wheel rolls forward with a turn of its motor; negative: mounted the other way round.
    pub metres_per_turn: [f32; 4],
    /// Counts of an encoder in a turn.
    pub counts_per_turn: f32,
    /// Pairs of poles.
    pub pole_pairs: f32,
    /// After such a silence they stop by themselves, as their maker's tool has set it, milliseconds; 0: never.
    pub watchdog_ms: u32,
}

/// A wheel as it really is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Turning {
    /// Turns of the motor since the start.
    pub turns: f32,
    /// Turns a second.
    pub turns_per_s: f32,
    /// Of the encoder.
    pub counts: i64,
}

#[derive(Clone, Debug)]
enum Controllers {
    Odrive(Vec<OdriveAxis>),
    Vesc(Vec<VescController>),
    Roboteq(RoboteqController),
    RoboteqCan(Vec<RoboteqBusController>),
    WheelLine(WheelController),
}

/// The controllers of a base.
#[derive(Clone, Debug)]
pub struct MotorBank {
    parameters: MotorParameters,
    controllers: Controllers,
}

impl MotorBank {
    /// All just powered.
    #[must_use]
    pub fn new(parameters: MotorParameters) -> Self {
        let nodes = || parameters.nodes.into_iter().take(parameters.wheels);
        let silence_us = u64::from(parameters.watchdog_ms) * 1_000;
        let controllers = match parameters.kind {
            MotorKind::Odrive => {
                Controllers::Odrive(nodes().map(|node| OdriveAxis::new(node, silence_us)).collect())
            }
            MotorKind::Vesc => {
                Controllers::Vesc(nodes().map(|node| VescController::new(node, silence_us)).collect())
            }
            MotorKind::Roboteq => Controllers::Roboteq(RoboteqController::default()),
            MotorKind::RoboteqCan => {
                let different: BTreeSet<u8> = nodes().collect();
                let channels = |node: u8| nodes().filter(|of_wheel| *of_wheel == node).count() as u8;
                let new = |node| RoboteqBusController::new(node, channels(node), parameters.watchdog_ms);
                Controllers::RoboteqCan(different.into_iter().map(new).collect())
            }
            MotorKind::WheelLine => Controllers::WheelLine(WheelController::new(parameters.wheels)),
        };
        Self { parameters, controllers }
    }

    /// What is fixed.
    #[must_use]
    pub const fn parameters(&self) -> &MotorParameters {
        &self.parameters
    }

    /// A frame from the robot's computer; bytes of a line come in frames, too.
    pub fn receive(&mut self, frame: &CanFrame, now_us: u64, out: &mut Vec<CanFrame>) {
        match &mut self.controllers {
            Controllers::Odrive(axes) => axes.iter_mut().for_each(|axis| axis.receive(frame, now_us)),
            Controllers::Vesc(controllers) => {
                controllers.iter_mut().for_each(|controller| controller.receive(frame, now_us));
            }
            Controllers::Roboteq(controller) => {
                in_frames(&controller.receive(frame.payload(), now_us), out);
            }
            Controllers::RoboteqCan(controllers) => {
                controllers.iter_mut().for_each(|controller| controller.receive(frame, now_us, out));
            }
            Controllers::WheelLine(controller) => controller.receive(frame.payload(), now_us),
        }
    }

    /// The emergency stop has cut their power.
    pub fn cut_power(&mut self) {
        match &mut self.controllers {
            Controllers::Odrive(axes) => axes.iter_mut().for_each(OdriveAxis::cut_power),
            Controllers::Vesc(controllers) => controllers.iter_mut().for_each(VescController::cut_power),
            Controllers::Roboteq(controller) => controller.cut_power(),
            Controllers::RoboteqCan(controllers) => {
                controllers.iter_mut().for_each(RoboteqBusController::cut_power);
            }
            Controllers::WheelLine(controller) => controller.cut_power(),
        }
    }

    /// A step: what they measure, and what they send. `rims_mps` and `rolled_m` are the wheels' true ones.
    pub fn tick(
        &mut self,
        (now_us, step_s): (u64, f32),
        (rims_mps, rolled_m): ([f32; 4], [f64; 4]),
        out: &mut Vec<CanFrame>,
    ) {
        let counts_per_turn = f64::from(self.parameters.counts_per_turn);
        let turning = [0, 1, 2, 3].map(|wheel| {
            let travel_m = self.parameters.metres_per_turn[wheel];
            let turns = rolled_m[wheel] / f64::from(travel_m);
            let counts = (turns * counts_per_turn).floor() as i64;
            Turning { turns: turns as f32, turns_per_s: rims_mps[wheel] / travel_m, counts }
        });
        match &mut self.controllers {
            Controllers::Odrive(axes) => {
                axes.iter_mut().zip(turning).for_each(|(axis, turning)| axis.tick(now_us, turning, out));
            }
            Controllers::Vesc(controllers) => {
                let pole_pairs = self.parameters.pole_pairs;
                for (controller, turning) in controllers.iter_mut().zip(turning) {
                    controller.tick(now_us, (turning, pole_pairs), out);
                }
            }
            Controllers::Roboteq(controller) => controller.tick((now_us, step_s), turning),
            Controllers::RoboteqCan(controllers) => {
                let nodes = self.parameters.nodes;
                for controller in controllers {
                    let of_wheels = nodes.iter().zip(turning).take(self.parameters.wheels);
                    let own = of_wheels.filter(|(node, _)| **node == controller.id());
                    let own: Vec<Turning> = own.map(|(_, turning)| turning).collect();
                    controller.tick((now_us, step_s), &own, out);
                }
            }
            Controllers::WheelLine(controller) => {
                in_frames(&controller.tick((now_us, step_s), turning), out);
            }
        }
    }

    /// Rim speed that each wheel's controller demands, m/s; none where there is no torque.
    #[must_use]
    pub fn demands_mps(&self) -> [Option<f32>; 4] {
        let travel_m = self.parameters.metres_per_turn;
        // A wheel that is not there stands.
        let mut demands = [Some(0.0); 4];
        let turns: Vec<Option<f32>> = match &self.controllers {
            Controllers::Odrive(axes) => axes.iter().map(OdriveAxis::demand_turns_per_s).collect(),
            Controllers::Vesc(controllers) => {
                let pole_pairs = self.parameters.pole_pairs;
                controllers.iter().map(|controller| controller.demand_turns_per_s(pole_pairs)).collect()
            }
            Controllers::Roboteq(controller) => controller.demands_turns_per_s().to_vec(),
            Controllers::RoboteqCan(controllers) => {
                let MotorParameters { nodes, wheels, .. } = self.parameters;
                let of_wheel = |wheel: usize| {
                    let controller = controllers.iter().find(|controller| controller.id() == nodes[wheel])?;
                    let channel = nodes.iter().take(wheel).filter(|node| **node == nodes[wheel]).count();
                    controller.demand_turns_per_s(channel)
                };
                (0..wheels).map(of_wheel).collect()
            }
            // A metre is a turn there.
            Controllers::WheelLine(controller) => controller.demands_mps(),
        };
        for ((demand, turns), travel_m) in demands.iter_mut().zip(turns).zip(travel_m) {
            *demand = turns.map(|turns| turns * travel_m);
        }
        demands
    }
}

/// Bytes of a line as the simulation carries them.
fn in_frames(bytes: &[u8], out: &mut Vec<CanFrame>) {
    out.extend(bytes.chunks(8).map(|portion| CanFrame::new(0, portion)));
}
