//! The bus as configured, and the start of each drive.

use floorguard_types::number::saturating_u32;

use crate::canopen::Script;
use crate::flexisoft::InputMap;

/// Drives that a base has at most.
pub(super) const WHEELS_MAX: usize = 4;
/// Object 1016h: the drives stop when the master is silent for this long, milliseconds.
const MASTER_SILENT_MS: u32 = 200;
/// Object 1017h: heartbeat of each device, milliseconds.
const HEARTBEAT_MS: u32 = 100;
/// Object 1029h: no change of the network state when the heartbeat of the master is missing.
const KEEP_STATE: u32 = 1;
/// Controlword; leads to "switch-on disabled" from every state but a fault.
const QUICK_STOP: u32 = 0x0002;
/// By every SYNC.
const EVERY_SYNC: u8 = 1;
/// At once, or by event.
const BY_EVENT: u8 = 255;
/// The drives' own ramps are this much steeper than the one by which the master leads all wheels to their speeds together.
const OWN_RAMP: f32 = 1.5;

/// What the bus carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelDrivesConfiguration {
    /// The master's own number.
    pub master_node: u8,
    /// Drives of the wheels: left and right, or front left, front right, rear left, rear right; 0 where there is none.
    pub wheel_nodes: [u8; WHEELS_MAX],
    /// Gateway of the safety controller.
    pub inputs_node: u8,
    /// The dirt sensor, where there is one.
    pub dirt_sensor_node: Option<u8>,
    /// What the gateway's image means.
    pub inputs: InputMap,
    /// Ramp up of the fastest wheel, m/s².
    pub acceleration_mps2: f32,
    /// Ramp down of the fastest wheel, m/s².
    pub deceleration_mps2: f32,
    /// Distance between the sides, metres; of Mecanum wheels that of the differential base that turns alike.
    pub track_m: f32,
    /// By what a turning rate is a speed for the guard, metres: the feedback is given as that of a steered wheel so far ahead.
    pub lever_m: f32,
}

impl Default for WheelDrivesConfiguration {
    fn default() -> Self {
        Self {
            master_node: 127,
            wheel_nodes: [1, 2, 0, 0],
            inputs_node: 5,
            dirt_sensor_node: None,
            inputs: InputMap::default(),
            acceleration_mps2: 1.0,
            deceleration_mps2: 1.5,
            track_m: 0.5,
            lever_m: 0.25,
        }
    }
}

impl WheelDrivesConfiguration {
    /// Drives that there are.
    #[must_use]
    pub fn wheels(&self) -> usize {
        self.wheel_nodes.iter().take_while(|node| **node != 0).count()
    }

    /// What a drive is configured to do at its start: watch the master, follow speeds, report status, speed and position at every SYNC.
    pub(super) fn wheel_script(&self, node: u8) -> Script {
        let watch = (u32::from(self.master_node) << 16) | MASTER_SILENT_MS;
        let millimetres = |metres: f32| saturating_u32((metres * 1_000.0 * OWN_RAMP).max(1.0));
        Script::new()
            // Process data do not reach the drive before it is started again: if it turns, it must not go on turning.
            .write(0x6040, 0, QUICK_STOP, 2)
            .write(0x1017, 0, HEARTBEAT_MS, 2)
            .write(0x1016, 1, watch, 4)
            // Action on loss of communication: 3 = quick stop.
            .write(0x6007, 0, 3, 2)
            .write_if_present(0x1029, 1, KEEP_STATE, 1)
            .write(0x6060, 0, 3, 1)
            .write(0x6083, 0, millimetres(self.acceleration_mps2), 4)
            .write(0x6084, 0, millimetres(self.deceleration_mps2), 4)
            .write(0x6085, 0, millimetres(self.deceleration_mps2), 4)
            // Quick stop: its own ramp, then no torque.
            .write(0x605A, 0, 2, 2)
            .receive(node, 0, (BY_EVENT, &[0x6040_0010, 0x60FF_0020]))
            .transmit(node, 0, (EVERY_SYNC, &[0x6041_0010, 0x606C_0020]))
            .transmit(node, 1, (EVERY_SYNC, &[0x6064_0020]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn script_fits_and_wheels_are_counted() {
        let pair = WheelDrivesConfiguration::default();
        let script = pair.wheel_script(1);
        assert!(!script.overflowed() && !script.is_empty(), "{}", script.len());
        let four = WheelDrivesConfiguration { wheel_nodes: [1, 2, 3, 4], ..pair };
        assert_eq!((pair.wheels(), four.wheels()), (2, 4));
    }
}
