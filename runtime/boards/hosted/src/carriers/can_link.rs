//! The CAN bus that `robot.toml` names, whatever carries it.

use std::io;

use floorguard_drivers::can::CanFrame;
use floorguard_runtime::io::{CanBus, SlcanBus, SlcanBusError};

use super::reconnect::ReconnectingLine;
use super::socket_can::SocketCanBus;
use crate::configuration::CanAddress;

/// Adapters for SLCAN are USB devices: the speed does not matter to them, but must be one that Linux accepts.
const SLCAN_BAUD: u32 = 115_200;

/// A CAN bus on Linux. Use it on the thread that made it.
pub enum CanLink {
    /// An interface of the kernel.
    Socket(SocketCanBus),
    /// An adapter on a serial line.
    Slcan(SlcanBus<ReconnectingLine>),
}

impl CanLink {
    /// The bus of an address, and why it cannot be used yet, if so.
    #[must_use]
    pub fn new(address: &CanAddress) -> (Self, Option<io::Error>) {
        match address {
            CanAddress::SocketCan(interface) => {
                let mut bus = SocketCanBus::new(interface.clone());
                let problem = bus.open().err();
                (Self::Socket(bus), problem)
            }
            CanAddress::Slcan(device) => {
                let (line, problem) = ReconnectingLine::new(device.clone(), SLCAN_BAUD);
                (Self::Slcan(SlcanBus::new(line)), problem)
            }
        }
    }
}

impl CanBus for CanLink {
    type Error = io::Error;

    async fn receive(&mut self) -> io::Result<CanFrame> {
        match self {
            Self::Socket(bus) => bus.receive().await,
            Self::Slcan(bus) => bus.receive().await.map_err(plain),
        }
    }

    async fn send(&mut self, frame: &CanFrame) -> io::Result<()> {
        match self {
            Self::Socket(bus) => bus.send(frame).await,
            Self::Slcan(bus) => bus.send(frame).await.map_err(plain),
        }
    }
}

fn plain(error: SlcanBusError<io::Error>) -> io::Error {
    match error {
        SlcanBusError::Line(error) => error,
        SlcanBusError::Ended => io::Error::from(io::ErrorKind::UnexpectedEof),
    }
}
