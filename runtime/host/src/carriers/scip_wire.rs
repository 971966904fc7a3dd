//! The wire of a scanner that must be asked: a serial line, or a TCP connection; both come back after they were lost.

use std::io;
use std::path::PathBuf;

use embedded_io_async::{ErrorType, Read, Write};
use floorguard_configuration::ScipAddress;

use super::reconnect::ReconnectingLine;
use super::stream::ReconnectingStream;

/// Either.
pub enum ScipWire {
    /// A serial line.
    Line(ReconnectingLine),
    /// A TCP connection.
    Stream(ReconnectingStream),
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
        }
    }
}

impl Write for ScipWire {
    async fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        match self {
            Self::Line(line) => line.write(buffer).await,
            Self::Stream(stream) => stream.write(buffer).await,
        }
    }

    async fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
