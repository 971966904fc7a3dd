//! Reports of devices on the bus and of what they send.

use std::time::Duration;

use floorguard_drivers::canopen::NodePhase;
use floorguard_runtime::shared::{BusReport, Complaints};

use super::Watch;

/// A device on the CAN bus that has not been heard of for so long is named.
const SILENT_AFTER: Duration = Duration::from_secs(3);

/// A line for each device that has not been heard of.
fn silent_devices(report: &BusReport) -> Vec<String> {
    let silent = report.devices().filter(|device| device.phase == NodePhase::Absent);
    silent.map(|device| format!("  {device}")).collect()
}

impl Watch<'_> {
    /// Says what has changed on the CAN bus, and which devices have sent nothing since the start.
    pub(super) fn on_bus(&mut self, report: &BusReport) {
        if !self.silent_reported && self.began.elapsed() >= SILENT_AFTER {
            self.silent_reported = true;
            silent_devices(report).iter().for_each(|line| self.display.note(line));
        }
        for (index, device) in report.devices().enumerate() {
            let known = self.bus.and_then(|known| known.devices().nth(index).copied());
            let silent_at_start = known.is_none() && device.phase == NodePhase::Absent;
            if known != Some(*device) && !silent_at_start {
                self.display.note(&format!("  {device}"));
            }
        }
        self.bus = Some(*report);
    }

    /// Says why a device is of no use, once for each reason.
    pub(super) fn on_complaints(&mut self, complaints: &Complaints) {
        let known = std::mem::replace(&mut self.complaints, *complaints);
        // Without the figures, which are others for each datagram.
        let lidar = complaints.lidar.filter(|now| !known.lidar.is_some_and(|then| then.is_alike(now)));
        // Its edges wander by a block from turn to turn: once is enough.
        let closed = complaints.lidar_closed.filter(|_| known.lidar_closed.is_none());
        let scanner = complaints.scanner.filter(|_| known.scanner != complaints.scanner);
        let message = complaints.scanner_message;
        let message = message.filter(|_| known.scanner_message != complaints.scanner_message);
        let link = complaints.scan_link;
        let link = link.filter(|now| !known.scan_link.is_some_and(|then| then.is_alike(*now)));
        let imu = complaints.imu.filter(|_| known.imu != complaints.imu);
        let reasons = [
            ("lidar", lidar.map(|error| error.to_string())),
            ("lidar", closed.map(|sector| format!("{sector}; what lies in the closed sector stays unknown"))),
            ("safety scanner", scanner.map(|error| error.to_string())),
            ("safety scanner", message.map(|error| error.to_string())),
            ("scanner", link.map(|error| error.to_string())),
            ("inertial sensor", imu.map(|fault| fault.to_string())),
        ];
        for (device, reason) in reasons {
            if let Some(reason) = reason {
                self.display.note(&format!("  {device}: {reason}"));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Devices that have sent nothing since the start are named, with their nodes.
    #[test]
    fn silent_nodes_are_named() {
        let robot =
            floorguard_configuration::parse("robot.toml", floorguard_configuration::EXAMPLE).unwrap().robot;
        let mut base = floorguard_drivers::three_wheel_base::ThreeWheelBase::new(robot.base());
        let lines = silent_devices(&BusReport::of(&base));
        assert!(
            lines.len() == 5 && lines[4].contains("safety controller (node 5): not heard of"),
            "{lines:?}"
        );
        let beat = floorguard_drivers::can::CanFrame::standard(0x701, &[0x7F]);
        base.on_frame(&beat, floorguard_types::time::Stamp::ZERO, &mut |_| {});
        assert_eq!(silent_devices(&BusReport::of(&base)).len(), 4);
    }
}
