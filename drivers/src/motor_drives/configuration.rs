//! Which controllers, and what their numbers mean.

use crate::flexisoft::InputMap;
use crate::wheel_drives::configuration::WHEELS_MAX;

/// What the controllers speak.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MotorProtocol {
    /// ODrive, CAN Simple.
    #[default]
    Odrive,
    /// VESC, CAN.
    Vesc,
    /// Roboteq with two channels, serial line.
    Roboteq,
    /// Roboteq, CANopen; wheels with one number are the channels of one controller.
    RoboteqCan,
    /// The wheel line.
    WheelLine,
}

impl MotorProtocol {
    /// It is spoken on a serial line, not on a bus.
    #[must_use]
    pub const fn is_serial(self) -> bool {
        matches!(self, Self::Roboteq | Self::WheelLine)
    }
}

/// The controllers of a base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorDrivesConfiguration {
    /// What they speak.
    pub protocol: MotorProtocol,
    /// Wheels, 2 or 4: left and right, or front left, front right, rear left, rear right.
    pub wheels: u8,
    /// Their numbers on the bus; of no use on a line.
    pub nodes: [u8; WHEELS_MAX],
    /// How far each wheel rolls forward with one turn of its motor, metres; negative where it is mounted the other way round. On the
    /// wheel line 1 or −1.
    pub metres_per_turn: [f32; WHEELS_MAX],
    /// Steps of the position that is reported in one turn of the motor.
    pub counts_per_turn: f32,
    /// Pairs of poles of a motor, where the controller counts electrical turns.
    pub pole_pairs: f32,
    /// Brakes grip when the power is gone. Without them a stop without torque is led to standstill first.
    pub has_brakes: bool,
    /// After so long a silence of this computer the controllers stop by themselves, milliseconds.
    pub watchdog_ms: u16,
    /// The master's own number among CANopen devices.
    pub master_node: u8,
    /// Gateway of the safety controller on the same bus; 0: none.
    pub inputs_node: u8,
    /// What the gateway's image means.
    pub inputs: InputMap,
    /// Ramp up of the fastest wheel, m/s².
    pub acceleration_mps2: f32,
    /// Ramp down of the fastest wheel, m/s².
    pub deceleration_mps2: f32,
    /// Distance between the sides, metres; of Mecanum wheels that of the differential base that turns alike.
    pub track_m: f32,
    /// By what a turning rate is a speed for the guard, metres.
    pub lever_m: f32,
}

impl Default for MotorDrivesConfiguration {
    fn default() -> Self {
        Self {
            protocol: MotorProtocol::Odrive,
            wheels: 2,
            nodes: [1, 2, 3, 4],
            metres_per_turn: [0.5; WHEELS_MAX],
            counts_per_turn: 10_000.0,
            pole_pairs: 7.0,
            has_brakes: true,
            watchdog_ms: 200,
            master_node: 127,
            inputs_node: 0,
            inputs: InputMap::default(),
            acceleration_mps2: 1.0,
            deceleration_mps2: 1.5,
            track_m: 0.5,
            lever_m: 0.25,
        }
    }
}

impl MotorDrivesConfiguration {
    /// Wheels that there are.
    #[must_use]
    pub fn wheel_count(&self) -> usize {
        usize::from(self.wheels).min(WHEELS_MAX)
    }

    /// How far a wheel rolls with a turn of its motor, never nothing.
    pub(super) fn travel_m(&self, wheel: usize) -> f32 {
        let metres = self.metres_per_turn.get(wheel).copied().unwrap_or(1.0);
        if libm::fabsf(metres) < 1.0e-4 || !metres.is_finite() { 1.0 } else { metres }
    }

    /// Position steps of a wheel that rolls a metre forward.
    pub(super) fn counts_per_m(&self, wheel: usize) -> f32 {
        self.counts_per_turn / self.travel_m(wheel)
    }

    /// The wheel that has a number on the bus.
    pub(super) fn wheel_of(&self, node: u8) -> Option<usize> {
        self.nodes.iter().take(self.wheel_count()).position(|known| *known == node)
    }
}
