//! What the configuration names: serial lines, ports, the CAN interface, cameras. No device is opened: its line would change state.

use std::net::SocketAddr;
use std::path::Path;

use floorguard_configuration::{
    BaseAddress, CameraSource, CanAddress, Carriers, DatagramAddress, ImuAddress, ScannerAddress,
    ScipAddress, SenderAddress,
};

use super::computer::Computer;
use super::finding::Finding;
use super::holders::{HeldPort, holders_of_file, holders_of_port};

/// ARPHRD_CAN, `include/uapi/linux/if_arp.h`.
const TYPE_CAN: u64 = 280;
/// IFF_UP, `include/uapi/linux/if.h`.
const FLAG_UP: u64 = 1;

/// The lines and ports of one robot.
pub(super) fn findings(computer: &Computer, carriers: &Carriers) -> Vec<Finding> {
    let mut findings = Vec::new();
    if let Some(address) = &carriers.lidar {
        findings.extend(datagrams(computer, "[lidar]", address));
    }
    match &carriers.scanner {
        ScannerAddress::Serial(line) => findings.push(device(computer, "[scanner]", &line.device)),
        ScannerAddress::Datagrams(address) => findings.extend(datagrams(computer, "[scanner]", address)),
        ScannerAddress::Wire(ScipAddress::Serial(line), _) => {
            findings.push(device(computer, "[scanner]", &line.device));
        }
        // Whether it answers is seen when the robot starts: to ask here would end what it sends to another program.
        ScannerAddress::Wire(ScipAddress::Tcp(_), _) => {}
    }
    let rear_scanner = carriers.rear_scanner.as_ref();
    findings.extend(rear_scanner.map(|line| device(computer, "[rear_scanner]", &line.device)));
    match &carriers.imu {
        Some(ImuAddress::Serial(line)) => findings.push(device(computer, "[imu]", &line.device)),
        Some(ImuAddress::Datagrams(address)) => findings.extend(datagrams(computer, "[imu]", address)),
        None => {}
    }
    match &carriers.can {
        Some(CanAddress::SocketCan(interface)) => findings.push(can(computer, interface)),
        Some(CanAddress::Slcan(line)) => findings.push(device(computer, "[can]", line)),
        Some(CanAddress::Line(line)) => findings.push(device(computer, "[base] drives", &line.device)),
        None => {}
    }
    match &carriers.base {
        Some(BaseAddress::Datagrams(address, _)) => findings.extend(datagrams(computer, "[base]", address)),
        Some(BaseAddress::Serial(line)) => findings.push(device(computer, "[base]", &line.device)),
        None => {}
    }
    if let Some(CameraSource::Devices { depth, colour }) =
        carriers.camera.as_ref().map(|camera| &camera.source)
    {
        findings.push(device(computer, "[camera] source", depth));
        findings.extend(colour.iter().map(|colour| device(computer, "[camera] colour_source", colour)));
    }
    findings
}

/// A device file: there, permitted, and not open elsewhere.
fn device(computer: &Computer, section: &str, path: &Path) -> Finding {
    let what = format!("{section} {}", path.display());
    if !computer.exists(path) {
        return Finding::bad(
            what,
            "not there",
            "plug it in; packaging/udev/70-floorguard.rules gives adapters lasting names",
        );
    }
    if !computer.may_use(path) {
        return Finding::bad(
            what,
            "this user may not read and write it",
            "add the user to the group dialout (serial lines) or video (cameras), then log in again",
        );
    }
    let holders = holders_of_file(computer, path);
    match holders.is_empty() {
        true => Finding::good(what, "there, permitted, not open elsewhere"),
        false => Finding::bad(
            what,
            format!("open in {}", holders.join(", ")),
            "end that program: two readers share the bytes of a line, and both lose some",
        ),
    }
}

/// A port: free, and its address on this computer reachable by the sender.
fn datagrams(computer: &Computer, section: &str, address: &DatagramAddress) -> Vec<Finding> {
    let what = format!("{section} udp:{}", address.local);
    let port = match holders_of_port(computer, address.local) {
        HeldPort::Free => Finding::good(what, "free"),
        HeldPort::Held(holders) => {
            let who =
                if holders.is_empty() { "another user's program".to_owned() } else { holders.join(", ") };
            Finding::bad(
                what,
                format!("taken by {who}"),
                "end that program, or change the device's port and `source`",
            )
        }
        HeldPort::Unknown => Finding::warning(what, "not known whether it is free", "/proc is not mounted"),
    };
    let sender = unnamed_sender(section, address.local, address.sender);
    std::iter::once(port).chain(sender).collect()
}

fn unnamed_sender(section: &str, local: SocketAddr, sender: Option<SenderAddress>) -> Option<Finding> {
    (sender.is_none() && !local.ip().is_loopback()).then(|| {
        Finding::warning(
            format!("{section} sender"),
            "not named: the first device that is understood counts",
            "write sender = \"ADDRESS\", so that a neighbour's device is not taken for this robot's",
        )
    })
}

fn can(computer: &Computer, interface: &str) -> Finding {
    let what = format!("[can] {interface}");
    let folder = format!("/sys/class/net/{interface}");
    if !computer.exists(Path::new(&folder)) {
        return Finding::bad(
            what,
            "no such network interface",
            "load the adapter's driver; `ip link` lists what is there",
        );
    }
    if computer.number(&format!("{folder}/type")) != Some(TYPE_CAN) {
        return Finding::bad(what, "no CAN interface", "name the CAN interface, for example can0");
    }
    let flags = computer.text(&format!("{folder}/flags"));
    let flags = flags.and_then(|text| u64::from_str_radix(text.trim_start_matches("0x"), 16).ok());
    match flags.is_some_and(|flags| flags & FLAG_UP != 0) {
        true => Finding::good(what, "up"),
        false => Finding::bad(
            what,
            "down",
            format!("ip link set {interface} up type can bitrate 500000 restart-ms 100"),
        ),
    }
}
