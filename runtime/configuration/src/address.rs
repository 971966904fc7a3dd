//! Where the bytes come from: `udp:ADDRESS:PORT`, `serial:DEVICE`, `socketcan:INTERFACE`, `slcan:DEVICE`.

use std::fmt;
use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;

use floorguard_runtime::configuration::RangingModel;

/// A UDP socket to bind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DatagramAddress {
    /// Address and port on this computer.
    pub local: SocketAddr,
    /// The accepted sender; without it, the first that is understood.
    pub sender: Option<SenderAddress>,
}

/// The device that sends datagrams, from any of its ports or from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SenderAddress {
    /// Its address.
    pub address: IpAddr,
    /// Its port, where it is given.
    pub port: Option<u16>,
}

impl SenderAddress {
    /// Parses `ADDRESS` or `ADDRESS:PORT`.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let with_port = text.parse::<SocketAddr>().ok();
        let with_port = with_port.map(|sender| Self { address: sender.ip(), port: Some(sender.port()) });
        with_port.or_else(|| text.parse().ok().map(|address| Self { address, port: None }))
    }

    /// Whether a datagram from there is the device's.
    #[must_use]
    pub fn is(&self, from: SocketAddr) -> bool {
        self.address == from.ip() && self.port.is_none_or(|port| port == from.port())
    }
}

impl fmt::Display for SenderAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.port {
            Some(port) => SocketAddr::new(self.address, port).fmt(f),
            None => self.address.fmt(f),
        }
    }
}

/// A serial line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialAddress {
    /// Device file.
    pub device: PathBuf,
    /// Symbols per second.
    pub baud: u32,
}

/// Where a sensor is that must be asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScipAddress {
    /// A serial line, or USB that looks like one.
    Serial(SerialAddress),
    /// A TCP port of the sensor.
    Tcp(SocketAddr),
}

/// What an inertial sensor is connected to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImuAddress {
    /// A line.
    Serial(SerialAddress),
    /// The port to which a bridge sends.
    Datagrams(DatagramAddress),
}

impl ImuAddress {
    /// The line, where it is one.
    #[must_use]
    pub const fn line(&self) -> Option<&SerialAddress> {
        match self {
            Self::Serial(line) => Some(line),
            Self::Datagrams(_) => None,
        }
    }
}

/// What a scanner is connected to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScannerAddress {
    /// An S300's line.
    Serial(SerialAddress),
    /// The port to which a microScan3 or a bridge sends.
    Datagrams(DatagramAddress),
    /// The line or the connection of a scanner that must be asked.
    Wire(ScipAddress, RangingModel),
}

/// A CAN bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CanAddress {
    /// A network interface of the kernel.
    SocketCan(String),
    /// A serial adapter that speaks SLCAN.
    Slcan(PathBuf),
    /// No bus: the line of motor controllers that speak text.
    Line(SerialAddress),
}

/// Where a base that takes velocities is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BaseAddress {
    /// The port to which it reports its motion, and where it takes velocities.
    Datagrams(DatagramAddress, SocketAddr),
    /// A line for both.
    Serial(SerialAddress),
}

impl DatagramAddress {
    /// Parses `udp:ADDRESS:PORT`.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let local = text.strip_prefix("udp:")?.parse().ok()?;
        Some(Self { local, sender: None })
    }
}

impl CanAddress {
    /// Parses `socketcan:INTERFACE` or `slcan:DEVICE`.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        match text.split_once(':')? {
            // The kernel's limit for interface names, IFNAMSIZ − 1.
            ("socketcan", name) if (1..16).contains(&name.len()) => Some(Self::SocketCan(name.to_owned())),
            ("slcan", device) if device.starts_with('/') => Some(Self::Slcan(PathBuf::from(device))),
            _ => None,
        }
    }
}

/// Parses `serial:DEVICE`.
#[must_use]
pub(super) fn parse_serial(text: &str) -> Option<PathBuf> {
    text.strip_prefix("serial:").filter(|device| device.starts_with('/')).map(PathBuf::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sender_is_matched_by_address_and_port() {
        let from = |text: &str| text.parse::<SocketAddr>().unwrap();
        let any = SenderAddress::parse("192.168.1.201").unwrap();
        assert!(any.is(from("192.168.1.201:2368")) && any.is(from("192.168.1.201:9")));
        assert!(!any.is(from("192.168.1.202:2368")));
        let one = SenderAddress::parse("192.168.1.201:2368").unwrap();
        assert!(one.is(from("192.168.1.201:2368")) && !one.is(from("192.168.1.201:9")));
        assert_eq!([any.to_string(), one.to_string()], ["192.168.1.201", "192.168.1.201:2368"]);
        for wrong in ["", "lidar", "192.168.1", "192.168.1.201:", "udp:192.168.1.201:2368"] {
            assert_eq!(SenderAddress::parse(wrong), None, "{wrong}");
        }
    }
}
