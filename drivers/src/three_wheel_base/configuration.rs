//! The bus as configured, and the commands to each device.

use floorguard_types::number::saturating_u32;

use crate::canopen::Script;
use crate::cia406::EncoderReport;
use crate::flexisoft::InputMap;

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

/// What the bus carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseConfiguration {
    /// The master's own number.
    pub master_node: u8,
    /// Traction drive: speed of the front wheel's rim in mm/s.
    pub traction_node: u8,
    /// Steering drive: angle in thousandths of a degree, counter-clockwise.
    pub steering_node: u8,
    /// Encoder of the left rear wheel.
    pub left_encoder_node: u8,
    /// Encoder of the right rear wheel.
    pub right_encoder_node: u8,
    /// Gateway of the safety controller.
    pub inputs_node: u8,
    /// The dirt sensor, where there is one. It speaks without being asked and needs no configuration.
    pub dirt_sensor_node: Option<u8>,
    /// What its image means.
    pub inputs: InputMap,
    /// Ramp up, m/s².
    pub acceleration_mps2: f32,
    /// Ramp down of a normal stop, m/s².
    pub deceleration_mps2: f32,
    /// Ramp down of a quick stop, m/s².
    pub quick_stop_mps2: f32,
}

impl Default for BaseConfiguration {
    fn default() -> Self {
        Self {
            master_node: 127,
            traction_node: 1,
            steering_node: 2,
            left_encoder_node: 3,
            right_encoder_node: 4,
            inputs_node: 5,
            dirt_sensor_node: None,
            inputs: InputMap::default(),
            acceleration_mps2: 1.0,
            deceleration_mps2: 1.5,
            quick_stop_mps2: 2.0,
        }
    }
}

impl BaseConfiguration {
    fn watched(&self) -> Script {
        let watch = (u32::from(self.master_node) << 16) | MASTER_SILENT_MS;
        // Action on loss of communication: 3 = quick stop. The network state stays as it is meanwhile (object 1029h, CiA 301,
        // section on error behaviour), so that the drive goes on telling its state.
        Script::new()
            .write(0x1017, 0, HEARTBEAT_MS, 2)
            .write(0x1016, 1, watch, 4)
            .write(0x6007, 0, 3, 2)
            .write_if_present(0x1029, 1, KEEP_STATE, 1)
    }

    pub(super) fn traction_script(&self) -> Script {
        let node = self.traction_node;
        let millimetres = |metres: f32| saturating_u32((metres * 1_000.0).max(1.0));
        // Process data do not reach the drive before it is started again: if it turns, it must not go on turning.
        Script::new()
            .write(0x6040, 0, QUICK_STOP, 2)
            .followed_by(&self.watched())
            .write(0x6060, 0, 3, 1)
            .write(0x6083, 0, millimetres(self.acceleration_mps2), 4)
            .write(0x6084, 0, millimetres(self.deceleration_mps2), 4)
            .write(0x6085, 0, millimetres(self.quick_stop_mps2), 4)
            // Quick stop: its own ramp, then no torque.
            .write(0x605A, 0, 2, 2)
            .receive(node, 0, (BY_EVENT, &[0x6040_0010, 0x60FF_0020]))
            .transmit(node, 0, (EVERY_SYNC, &[0x6041_0010, 0x606C_0020]))
    }

    pub(super) fn steering_script(&self) -> Script {
        let node = self.steering_node;
        self.watched()
            .write(0x6060, 0, 1, 1)
            .receive(node, 0, (BY_EVENT, &[0x6040_0010, 0x607A_0020]))
            .transmit(node, 0, (EVERY_SYNC, &[0x6041_0010, 0x6064_0020]))
    }

    /// The measuring range is read, not assumed: positions are taken modulo it.
    pub(super) fn encoder_script(node: u8) -> Script {
        Script::new().write(0x1017, 0, HEARTBEAT_MS, 2).read(0x6002, 0).transmit(
            node,
            0,
            (EVERY_SYNC, &EncoderReport::MAPPING),
        )
    }

    /// The image is mapped by the controller's own project.
    pub(crate) fn inputs_script() -> Script {
        Script::new().write(0x1017, 0, HEARTBEAT_MS, 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_script_fits() {
        let base = BaseConfiguration::default();
        let scripts = [
            base.traction_script(),
            base.steering_script(),
            BaseConfiguration::encoder_script(3),
            BaseConfiguration::inputs_script(),
        ];
        assert!(scripts.iter().all(|script| !script.overflowed() && !script.is_empty()));
    }
}
