//! The wire of a sensor that is asked, or that sends frames: a serial line or a TCP connection, which come back after they were lost, or
//! a UDP port.

use std::io;
use std::path::PathBuf;

use embedded_io_async::{ErrorType, Read, Write};
use floorguard_configuration::ScipAddress;
use floorguard_runtime::io::DatagramReceiver as _;

use super::reconnect::ReconnectingLine;
use super::socket::UdpReceiver;
use super::stream::ReconnectingStream;

/// One of them.
pub enum ScipWire {
    /// A serial line.
    Line(ReconnectingLine),
    /// A TCP connection.
    Stream(ReconnectingStream),
    /// A UDP port: each read gives a datagram. Nothing is written to it.
    Datagrams(UdpReceiver),
}

impl ScipWire {
    /// Opens it, and says why it cannot be used yet, if so.
    #[must_use]
    pub fn open(address: &ScipAddress) -> (Self, Option<io::Error>) {
        Self::opened(address, ReconnectingLine::new)
    }

    /// The same for the adapter of an RPLidar, whose motor a line with "data terminal ready" low sets going.
    #[must_use]
    pub fn open_with_motor(address: &ScipAddress) -> (Self, Option<io::Error>) {
        Self::opened(address, ReconnectingLine::with_motor)
    }

    fn opened(
        address: &ScipAddress,
        open: impl FnOnce(PathBuf, u32) -> (ReconnectingLine, Option<io::Error>),
    ) -> (Self, Option<io::Error>) {
        match address {
            ScipAddress::Serial(address) => {
                let (line, problem) = open(address.device.clone(), address.baud);
                (Self::Line(line), problem)
            }
            ScipAddress::Tcp(address) => (Self::Stream(ReconnectingStream::new(*address)), None),
        }
    }
}

impl ErrorType for ScipWire {
    type Error = io::Error;
}

impl Read for ScipWire {
    async fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Line(line) => line.read(buffer).await,
            Self::Stream(stream) => stream.read(buffer).await,
            Self::Datagrams(port) => loop {
                let received = port.receive(buffer).await?;
                // An empty datagram is none of a bridge, and would pass for the end of a line.
                if received.length > 0 {
                    return Ok(received.length);
                }
            },
        }
    }
}

impl Write for ScipWire {
    async fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        match self {
            Self::Line(line) => line.write(buffer).await,
            Self::Stream(stream) => stream.write(buffer).await,
            Self::Datagrams(_) => Ok(buffer.len()),
        }
    }

    async fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
