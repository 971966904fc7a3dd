//! How far the devices on the CAN bus are, in words that name device, object and reason.

use core::fmt;

use floorguard_drivers::canopen::{ConfigurationFailure, NodeConfigurator, NodePhase};
use floorguard_drivers::motor_drives::{MotorDrives, WatchdogCheck};
use floorguard_drivers::three_wheel_base::ThreeWheelBase;
use floorguard_drivers::wheel_drives::WheelDrives;

/// Devices on the bus of one base.
const DEVICES_MAX: usize = 5;
/// What the devices are, in the order of [`BusReport::devices`].
const NAMES: [&str; DEVICES_MAX] =
    ["traction drive", "steering drive", "left encoder", "right encoder", "safety controller"];
/// The same of a base with a drive on each wheel.
const NAMES_OF_TWO: [&str; 3] = ["left drive", "right drive", "safety controller"];
const NAMES_OF_FOUR: [&str; DEVICES_MAX] =
    ["front left drive", "front right drive", "rear left drive", "rear right drive", "safety controller"];

/// A device on the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceReport {
    /// What it is.
    pub name: &'static str,
    /// Its node number.
    pub node: u8,
    /// How far its start is.
    pub phase: NodePhase,
    /// Why it refused last.
    pub failure: Option<ConfigurationFailure>,
    /// It is a motor controller other than a CiA 402 drive: what it shows is its watchdog.
    pub is_motor: bool,
}

/// All devices on the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BusReport {
    /// Drives, encoders, gateway of the safety controller; a base with fewer devices leaves the last places empty.
    devices: [Option<DeviceReport>; DEVICES_MAX],
}

impl BusReport {
    /// Of a base.
    #[must_use]
    pub fn of(base: &ThreeWheelBase) -> Self {
        Self::named(&NAMES, base.devices().into_iter())
    }

    /// Of a base with a drive on each wheel.
    #[must_use]
    pub fn of_wheels(base: &WheelDrives) -> Self {
        let names: &[&str] =
            if base.devices().count() > NAMES_OF_TWO.len() { &NAMES_OF_FOUR } else { &NAMES_OF_TWO };
        Self::named(names, base.devices())
    }

    /// Of a base with motor controllers other than CiA 402 drives: one is operational when its watchdog is known.
    #[must_use]
    pub fn of_motors(base: &MotorDrives) -> Self {
        let mut devices = [None; DEVICES_MAX];
        let names: &[&str] =
            if base.heard().count() > NAMES_OF_TWO.len() { &NAMES_OF_FOUR } else { &NAMES_OF_TWO };
        for (slot, (name, (node, is_heard))) in devices.iter_mut().zip(names.iter().zip(base.heard())) {
            let failure = base.refusal(node);
            let phase = match (is_heard, base.watchdog()) {
                _ if failure.is_some() => NodePhase::Refused,
                (false, _) => NodePhase::Absent,
                (true, watchdog) if watchdog.allows() => NodePhase::Operational,
                (true, WatchdogCheck::Failed) => NodePhase::Refused,
                (true, _) => NodePhase::Configuring(0),
            };
            *slot = Some(DeviceReport { name, node, phase, failure, is_motor: failure.is_none() });
        }
        let gateway = Self::named(&["safety controller"], base.gateway().into_iter());
        if let (Some(slot), [Some(device), ..]) =
            (devices.iter_mut().find(|slot| slot.is_none()), gateway.devices)
        {
            *slot = Some(device);
        }
        Self { devices }
    }

    /// A device that is being configured counts as at the first step, so that it does not report each step.
    fn named<'a>(names: &[&'static str], nodes: impl Iterator<Item = &'a NodeConfigurator>) -> Self {
        let mut devices = [None; DEVICES_MAX];
        for (slot, (name, device)) in devices.iter_mut().zip(names.iter().zip(nodes)) {
            *slot = Some(DeviceReport {
                name,
                node: device.node(),
                phase: match device.phase() {
                    NodePhase::Configuring(_) | NodePhase::Starting => NodePhase::Configuring(0),
                    phase => phase,
                },
                failure: device.failure().filter(|_| device.phase() == NodePhase::Refused),
                is_motor: false,
            });
        }
        Self { devices }
    }

    /// Drives, encoders, gateway of the safety controller.
    pub fn devices(&self) -> impl Iterator<Item = &DeviceReport> {
        self.devices.iter().flatten()
    }
}

impl fmt::Display for DeviceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (node {}): ", self.name, self.node)?;
        match (self.phase, self.failure) {
            (NodePhase::Configuring(_), _) if self.is_motor => f.write_str(
                "heard; drives when its watchdog is known: it is asked when the robot is to start",
            ),
            (NodePhase::Refused, _) if self.is_motor => {
                f.write_str("does not stop when this computer is silent; enable its watchdog, then reset")
            }
            (NodePhase::Absent, _) => {
                f.write_str("not heard of; check its power, the cable and its node number")
            }
            (NodePhase::Configuring(_) | NodePhase::Starting, _) => f.write_str("being configured"),
            (NodePhase::Operational, _) => f.write_str("operational"),
            (NodePhase::Refused, None) => f.write_str("refused its configuration; tried again in 2 s"),
            (NodePhase::Refused, Some(failure)) => {
                let ConfigurationFailure { index, subindex, error } = failure;
                write!(f, "refused object {index:04X}h:{subindex:02X}h: {error}; tried again in 2 s")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_drivers::canopen::SdoError;
    use std::string::ToString;

    #[test]
    fn a_refusal_names_device_object_and_reason() {
        let failure = ConfigurationFailure { index: 0x1A00, subindex: 1, error: SdoError(0x0609_0030) };
        let report = DeviceReport {
            name: "left encoder",
            node: 3,
            phase: NodePhase::Refused,
            failure: Some(failure),
            is_motor: false,
        };
        let text = report.to_string();
        assert!(text.starts_with("left encoder (node 3): refused object 1A00h:01h: "), "{text}");
        let silent = DeviceReport { phase: NodePhase::Absent, failure: None, ..report };
        assert!(silent.to_string().contains("not heard of"));
    }

    /// A Roboteq whose firmware has no such object says so; before that it is not heard of.
    #[test]
    fn refusing_motor_controller_names_its_object() {
        use floorguard_drivers::can::CanFrame;
        use floorguard_drivers::motor_drives::{MotorDrivesConfiguration, MotorProtocol};
        use floorguard_types::time::Stamp;

        let protocol = MotorProtocol::RoboteqCan;
        let mut base = MotorDrives::new(MotorDrivesConfiguration { protocol, ..Default::default() });
        let line_of =
            |base: &MotorDrives| BusReport::of_motors(base).devices().next().map(ToString::to_string);
        assert!(line_of(&base).is_some_and(|text| text.starts_with("left drive (node 1): not heard of")));
        let hear = |frame: &CanFrame, base: &mut MotorDrives| base.on_frame(frame, Stamp::ZERO, &mut |_| {});
        hear(&CanFrame::standard(0x701, &[0]), &mut base);
        base.poll(Stamp::ZERO, &mut |_| {}, &mut |_| {});
        hear(&CanFrame::standard(0x581, &[0x80, 0x0C, 0x20, 0, 0, 0, 2, 6]), &mut base);
        let text = line_of(&base).unwrap_or_default();
        assert!(text.starts_with("left drive (node 1): refused object 200Ch:00h: no such object"), "{text}");
    }
}
