//! A serial line that may be absent at the start, be unplugged, and come back.
//!
//! USB adapters vanish and return under the same name. Losing the line is an error once, so that the guard hears of it
//! at once and not only by the age of the source; then reading waits until the line is back. What is written meanwhile
//! is refused.

use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use embassy_time::Timer;
use embedded_io_async::{ErrorType, Read, Write};

use super::serial::SerialLine;

/// Pause between two attempts to open: quick for a human, idle for a machine.
const RETRY: Duration = Duration::from_millis(250);

/// How a device is opened at a speed.
type Opening = fn(&Path, u32) -> io::Result<SerialLine>;

/// A serial line that is opened again whenever it fails. Use it on the thread that made it.
pub struct ReconnectingLine {
    device: PathBuf,
    baud: u32,
    /// How it is opened.
    open: Opening,
    line: Option<SerialLine>,
    tried: Instant,
    losses: u32,
}

impl ReconnectingLine {
    /// Opens the line, and says why it cannot be used yet, if so.
    #[must_use]
    pub fn new(device: PathBuf, baud: u32) -> (Self, Option<io::Error>) {
        Self::opened((device, baud), SerialLine::open)
    }

    /// The same for the adapter of an RPLidar, see [`SerialLine::open_with_motor`].
    #[must_use]
    pub fn with_motor(device: PathBuf, baud: u32) -> (Self, Option<io::Error>) {
        Self::opened((device, baud), SerialLine::open_with_motor)
    }

    fn opened((device, baud): (PathBuf, u32), open: Opening) -> (Self, Option<io::Error>) {
        let (line, problem) = match open(&device, baud) {
            Ok(line) => (Some(line), None),
            Err(error) => (None, Some(error)),
        };
        (Self { device, baud, open, line, tried: Instant::now(), losses: 0 }, problem)
    }

    /// Times that the line was lost.
    #[must_use]
    pub const fn losses(&self) -> u32 {
        self.losses
    }

    fn lose(&mut self, error: io::Error) -> io::Error {
        self.line = None;
        self.tried = Instant::now();
        self.losses = self.losses.saturating_add(1);
        error
    }

    fn reopen_if_due(&mut self) {
        if self.line.is_none() && self.tried.elapsed() >= RETRY {
            self.tried = Instant::now();
            self.line = (self.open)(&self.device, self.baud).ok();
        }
    }
}

impl ErrorType for ReconnectingLine {
    type Error = io::Error;
}

impl Read for ReconnectingLine {
    async fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            self.reopen_if_due();
            let Some(line) = &mut self.line else {
                Timer::after_millis(RETRY.as_millis() as u64).await;
                continue;
            };
            return match line.read(buffer).await {
                // A terminal whose other end is closed reads as empty for ever.
                Ok(0) => Err(self.lose(io::Error::from(io::ErrorKind::UnexpectedEof))),
                Ok(count) => Ok(count),
                Err(error) => Err(self.lose(error)),
            };
        }
    }
}

impl Write for ReconnectingLine {
    async fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.reopen_if_due();
        let Some(line) = &mut self.line else { return Err(io::Error::from(io::ErrorKind::NotConnected)) };
        match line.write(buffer).await {
            Ok(count) => Ok(count),
            Err(error) => Err(self.lose(error)),
        }
    }

    async fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::carriers::PseudoTerminal;
    use crate::executor::{StopFlag, run_until};
    use std::cell::Cell;

    /// The cable is pulled, the loss is reported once, and bytes flow again when it is back under the same name.
    #[test]
    fn a_line_that_comes_back_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let name = folder.path().join("scanner");
        let (line, problem) = ReconnectingLine::new(name.clone(), 115_200);
        assert!(problem.is_some());
        let flag = StopFlag::default();
        let (seen, lost) = (Cell::new(0), Cell::new(0));
        run_until(&flag, |tasks| {
            let (seen, lost, flag) = (&seen, &lost, &flag);
            tasks.spawn(async move {
                let mut line = line;
                let mut buffer = [0; 8];
                while seen.get() < 2 {
                    match line.read(&mut buffer).await {
                        Ok(_) => seen.set(seen.get() + 1),
                        Err(_) => lost.set(lost.get() + 1),
                    }
                }
                flag.stop();
            });
            tasks.spawn(async move {
                for expected in 1..=2 {
                    let terminal = PseudoTerminal::open().unwrap();
                    std::os::unix::fs::symlink(&terminal.device, &name).unwrap();
                    // Bytes that are written before the line is opened wait in it.
                    rustix::io::write(&terminal.near, b"bytes").unwrap();
                    while seen.get() < expected {
                        Timer::after_millis(20).await;
                    }
                    std::fs::remove_file(&name).unwrap();
                }
            });
            Ok(())
        })
        .unwrap();
        assert_eq!((seen.get(), lost.get()), (2, 1));
    }
}
