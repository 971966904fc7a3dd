//! What comes out of a device, and when.

use crate::can::CanFrame;

/// A line between a device and the robot's computer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stream {
    /// UDP 2368: one datagram an event.
    LidarData,
    /// UDP 8308: one datagram an event.
    LidarPosition,
    /// RS-422 of the S300: any number of bytes an event.
    ScannerSerial,
    /// UDP 6060 of a microScan3: one datagram an event.
    ScannerData,
    /// RS-422 of a second S300, at the rear.
    RearScannerSerial,
    /// RS-232 of the MTi: any number of bytes an event.
    ImuSerial,
    /// CAN: one frame an event.
    Can,
}

/// What is on the wire.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Payload {
    /// Of a datagram or a serial line.
    Bytes(Vec<u8>),
    /// Of the CAN bus.
    Frame(CanFrame),
}

/// The last byte of this has just arrived.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WireEvent {
    /// World time, microseconds since the start.
    pub at_us: u64,
    /// On which line.
    pub stream: Stream,
    /// What.
    pub payload: Payload,
}

impl WireEvent {
    /// Bytes of a datagram or serial line.
    #[must_use]
    pub const fn bytes(at_us: u64, stream: Stream, bytes: Vec<u8>) -> Self {
        Self { at_us, stream, payload: Payload::Bytes(bytes) }
    }
}
