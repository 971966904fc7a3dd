//! Where the bytes come from: `udp:ADDRESS:PORT`, `serial:DEVICE`, `socketcan:INTERFACE`, `slcan:DEVICE`.

use std::net::SocketAddr;
use std::path::PathBuf;

/// A UDP socket to bind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DatagramAddress(pub SocketAddr);

/// A serial line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialAddress {
    /// Device file.
    pub device: PathBuf,
    /// Symbols per second.
    pub baud: u32,
}

/// What a safety scanner is connected to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScannerAddress {
    /// An S300's line.
    Serial(SerialAddress),
    /// The port to which a microScan3 sends.
    Datagrams(DatagramAddress),
}

/// A CAN bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CanAddress {
    /// A network interface of the kernel.
    SocketCan(String),
    /// A serial adapter that speaks SLCAN.
    Slcan(PathBuf),
}

impl DatagramAddress {
    /// Parses `udp:ADDRESS:PORT`.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        text.strip_prefix("udp:")?.parse().ok().map(Self)
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
