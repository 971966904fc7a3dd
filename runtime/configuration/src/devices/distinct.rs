//! What two devices cannot share: a serial line, a UDP port, a bit of the safety controller's image; and channels that cannot be safe.

use std::ops::Range;
use std::path::Path;

use floorguard_drivers::flexisoft::InputBits;

use crate::actuated_lidar::{ActuatedLidarConfiguration, ScipAddress};
use crate::address::{BaseAddress, CanAddress, DatagramAddress, ScannerAddress, SerialAddress};
use crate::command::CommandAddress;
use crate::reader::Reader;

/// The addresses of the devices, as far as they were read.
pub(crate) struct Addresses<'a> {
    pub lidar: Option<&'a DatagramAddress>,
    pub scanner: &'a ScannerAddress,
    pub rear_scanner: Option<&'a SerialAddress>,
    pub imu: Option<&'a SerialAddress>,
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
    lines.extend(addresses.imu.map(|line| ("imu", line.device.as_path())));
    match addresses.command {
        Some(CommandAddress::Datagrams(port)) => ports.push(("command", *port)),
        Some(CommandAddress::Serial(line)) => lines.push(("command", &line.device)),
        None => {}
    }
    if let Some(CanAddress::Slcan(device)) = addresses.can {
        lines.push(("can", device));
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

/// The key has a number for each of two channels.
fn is_pair(section: &Reader<'_>, key: &'static str) -> bool {
    let value = section.find(key).and_then(|value| value.get_ref().as_array());
    value.is_some_and(|numbers| numbers.len() > 1)
}

/// Refuses two channels of an input on one bit, and two inputs on one bit. Each input comes with its key.
pub(super) fn check_bits(section: &Reader<'_>, inputs: &[(&'static str, Option<InputBits>)]) {
    let fitted = || inputs.iter().filter_map(|(key, input)| input.map(|input| (*key, input.bits)));
    let place = |key: &'static str| section.find(key).map_or(0..0, |value| value.span());
    for (index, (key, [first, second])) in fitted().enumerate() {
        if first == second && is_pair(section, key) {
            let what = format!("[inputs]: both channels of `{key}` are bit {first}");
            section.refuse_to_drive(
                &place(key),
                what,
                "give each channel its own bit, or write a single one for an input with one channel",
            );
        }
        let shared = |bits: [u8; 2]| [first, second].into_iter().find(|bit| bits.contains(bit));
        let other = fitted().take(index).find_map(|(other, bits)| shared(bits).map(|bit| (other, bit)));
        if let Some((other, bit)) = other {
            let what = format!("[inputs]: bit {bit} of `{key}` is one of `{other}`, too");
            section.refuse_to_drive(&place(key), what, "give each input its own bits");
        }
    }
}

/// Refuses an emergency stop with one channel, and inputs on whose every channel a cut wire means that all is well: the safety manual,
/// section 2, asks for two channels with 1 as the operating state.
pub(super) fn check_channels(section: &Reader<'_>, inputs: &[(&'static str, Option<InputBits>)]) {
    for (key, input) in inputs {
        let Some(InputBits { bits: [first, second], inverted }) = input else { continue };
        let place = section.find(key).map_or(section.span().clone(), |value| value.span());
        if *key == "emergency_stop_bits" && first == second && !is_pair(section, key) && section.good_so_far()
        {
            section.refuse_to_drive(
                &place,
                format!("[inputs]: `{key}` has one channel, bit {first}: a single fault and the button is not heard"),
                "wire both channels of the emergency stop to the safety controller, and write both bits, for example [32, 33]",
            );
        }
        if inverted.iter().all(|inverted| *inverted) && section.good_so_far() {
            section.refuse_to_drive(
                &place,
                format!("[inputs]: every channel of `{key}` is in `inverted_bits`: a cut wire reads as all is well"),
                "let at least one channel be 1 in the operating state, and leave its bit out of `inverted_bits`",
            );
        }
    }
}
