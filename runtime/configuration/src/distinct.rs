//! What two devices cannot share: a serial line, a UDP port.

use std::ops::Range;
use std::path::Path;

use crate::actuated_lidar::ActuatedLidarConfiguration;
use crate::address::{
    BaseAddress, CanAddress, DatagramAddress, ImuAddress, ScannerAddress, ScipAddress, SerialAddress,
};
use crate::command::CommandAddress;
use crate::reader::Reader;

/// The addresses of the devices, as far as they were read.
pub(crate) struct Addresses<'a> {
    pub lidar: Option<&'a DatagramAddress>,
    pub scanner: &'a ScannerAddress,
    pub rear_scanner: Option<&'a SerialAddress>,
    pub imu: Option<&'a ImuAddress>,
    pub can: Option<&'a CanAddress>,
    pub base: Option<&'a BaseAddress>,
    pub command: Option<&'a CommandAddress>,
    pub actuated_lidar: Option<&'a ActuatedLidarConfiguration>,
}

/// Refuses two devices on one line or port. Each device is named by its section.
pub(crate) fn check_addresses(top: &Reader<'_>, addresses: &Addresses<'_>) {
    let mut lines: Vec<(&'static str, &Path)> = Vec::new();
    let mut ports: Vec<(&'static str, DatagramAddress)> =
        addresses.lidar.iter().map(|port| ("lidar", **port)).collect();
    match addresses.scanner {
        ScannerAddress::Serial(line) => lines.push(("scanner", &line.device)),
        ScannerAddress::Datagrams(port) => ports.push(("scanner", *port)),
        ScannerAddress::Wire(ScipAddress::Serial(line), _) => lines.push(("scanner", &line.device)),
        ScannerAddress::Wire(ScipAddress::Tcp(_), _) => {}
    }
    lines.extend(addresses.rear_scanner.map(|line| ("rear_scanner", line.device.as_path())));
    match addresses.imu {
        Some(ImuAddress::Serial(line)) => lines.push(("imu", &line.device)),
        Some(ImuAddress::Datagrams(port)) => ports.push(("imu", *port)),
        None => {}
    }
    match addresses.command {
        Some(CommandAddress::Datagrams(port)) => ports.push(("command", *port)),
        Some(CommandAddress::Serial(line)) => lines.push(("command", &line.device)),
        Some(CommandAddress::Ros(_)) | None => {}
    }
    match addresses.can {
        Some(CanAddress::Slcan(device)) => lines.push(("can", device)),
        Some(CanAddress::Line(line)) => lines.push(("base", &line.device)),
        Some(CanAddress::SocketCan(_)) | None => {}
    }
    match addresses.base {
        Some(BaseAddress::Serial(line)) => lines.push(("base", &line.device)),
        Some(BaseAddress::Datagrams(port, _)) => ports.push(("base", *port)),
        None => {}
    }
    if let Some(actuated) = addresses.actuated_lidar {
        lines.extend(actuated.lines().into_iter().map(|line| ("actuated_lidar", line)));
        ports.extend(actuated.people_source.map(|port| ("actuated_lidar", port)));
    }
    for (index, (section, device)) in lines.iter().enumerate() {
        let before = lines.get(..index).unwrap_or_default();
        if let Some((other, _)) = before.iter().find(|(_, known)| known == device) {
            let what = format!("[{section}]: `source` is {}, and so is that of [{other}]", device.display());
            top.refuse_to_drive(&place(top, section), what, "give each device its own line");
        }
    }
    for (index, (section, port)) in ports.iter().enumerate() {
        let before = ports.get(..index).unwrap_or_default();
        if let Some((other, _)) = before.iter().find(|(_, known)| is_same_port(known, port)) {
            let what = format!(
                "[{section}]: `source` is UDP port {}, and so is that of [{other}]",
                port.local.port()
            );
            top.refuse_to_drive(&place(top, section), what, "let each device send to a port of its own");
        }
    }
}

fn is_same_port(one: &DatagramAddress, other: &DatagramAddress) -> bool {
    let (one, other) = (one.local, other.local);
    let is_any = one.ip().is_unspecified() || other.ip().is_unspecified();
    one.port() == other.port() && (is_any || one.ip() == other.ip())
}

fn place(top: &Reader<'_>, section: &'static str) -> Range<usize> {
    top.find(section).map_or(0..0, |value| value.span())
}
