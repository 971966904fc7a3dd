//! A serial line that may be unplugged and come back.
//!
//! USB adapters vanish and return under the same name. Reading from a line that is gone waits until it is back; the
//! guard notices by the age of the source, not by an error here. What is written meanwhile is lost and counted.

use std::convert::Infallible;
use std::io;
use std::path::PathBuf;

use embassy_time::Timer;
use embedded_io_async::{ErrorType, Read, Write};

use super::serial::SerialLine;

/// Pause between two attempts to open, milliseconds: quick for a human, idle for a machine.
const RETRY_MS: u64 = 250;

/// A serial line that is opened again whenever it fails.
pub struct ReconnectingLine {
    device: PathBuf,
    baud: u32,
    line: Option<SerialLine>,
    losses: u32,
    unsent_bytes: u64,
}

impl ReconnectingLine {
    /// Opens the line now, so that a wrong name is an error at start.
    ///
    /// # Errors
    /// The device is absent or refuses the speed.
    pub fn open(device: PathBuf, baud: u32) -> io::Result<Self> {
        let line = Some(SerialLine::open(&device, baud)?);
        Ok(Self { device, baud, line, losses: 0, unsent_bytes: 0 })
    }

    /// Times that the line was lost.
    #[must_use]
    pub const fn losses(&self) -> u32 {
        self.losses
    }

    /// Bytes that found no line.
    #[must_use]
    pub const fn unsent_bytes(&self) -> u64 {
        self.unsent_bytes
    }

    fn drop_line(&mut self) {
        self.line = None;
        self.losses = self.losses.saturating_add(1);
    }
}

impl ErrorType for ReconnectingLine {
    type Error = Infallible;
}

impl Read for ReconnectingLine {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        loop {
            match &mut self.line {
                Some(line) => match line.read(buffer).await {
                    // A terminal whose other end is closed reads as empty for ever.
                    Ok(0) | Err(_) => self.drop_line(),
                    Ok(count) => return Ok(count),
                },
                None => {
                    Timer::after_millis(RETRY_MS).await;
                    self.line = SerialLine::open(&self.device, self.baud).ok();
                }
            }
        }
    }
}

impl Write for ReconnectingLine {
    async fn write(&mut self, buffer: &[u8]) -> Result<usize, Infallible> {
        let written = match &mut self.line {
            Some(line) => line.write(buffer).await,
            None => Err(io::Error::from(io::ErrorKind::NotConnected)),
        };
        Ok(written.unwrap_or_else(|_| {
            self.unsent_bytes = self.unsent_bytes.saturating_add(buffer.len() as u64);
            buffer.len()
        }))
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
