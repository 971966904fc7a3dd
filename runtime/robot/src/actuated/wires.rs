//! The lidar's wire: a serial line, or a TCP connection; both come back after they were lost.

use std::io;

use embedded_io_async::{ErrorType, Read, Write};
use floorguard_configuration::ScipAddress;
use floorguard_host::carriers::{ReconnectingLine, ReconnectingStream};

/// Either.
pub(super) enum ScipWire {
    Line(ReconnectingLine),
    Stream(ReconnectingStream),
}

impl ScipWire {
    /// Opens it, and says why it cannot be used yet, if so.
    pub(super) fn open(address: &ScipAddress) -> (Self, Option<io::Error>) {
        match address {
            ScipAddress::Serial(address) => {
                let (line, problem) = ReconnectingLine::new(address.device.clone(), address.baud);
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
