//! A serial line of the emulated board: bytes wait until the device takes them, none is dropped.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::Context;

/// The emulator opens its sockets within this.
const OPENS_WITHIN: Duration = Duration::from_secs(20);

/// What a busy host was late with by more than this, microseconds of the board's time, it does not make up for: no wire
/// brings bytes faster than its rate, and the guard is to be judged by what wires bring.
const LATE_US: u64 = 1_500;

/// One end of a line.
pub struct Line {
    stream: UnixStream,
    waiting: VecDeque<u8>,
    bytes_per_s: u64,
    /// Millionths of bytes that the line could have carried since.
    allowed: u64,
    /// Bytes given to the line since the start.
    pub sent: u64,
}

impl Line {
    /// Connects to the emulator's socket, as soon as it is there. The emulator does not simulate the rate: we do.
    ///
    /// # Errors
    /// It never is.
    pub fn open(path: &Path, bytes_per_s: u64) -> anyhow::Result<Self> {
        let began = Instant::now();
        let stream = loop {
            match UnixStream::connect(path) {
                Ok(stream) => break stream,
                Err(_) if began.elapsed() < OPENS_WITHIN => std::thread::sleep(Duration::from_millis(10)),
                Err(error) => return Err(error).context("the emulator does not open its serial lines"),
            }
        };
        stream.set_nonblocking(true)?;
        Ok(Self { stream, waiting: VecDeque::new(), bytes_per_s, allowed: 0, sent: 0 })
    }

    /// Sends bytes, now or as soon as the line takes them.
    pub fn send(&mut self, bytes: &[u8]) {
        self.waiting.extend(bytes);
        self.sent += bytes.len() as u64;
    }

    /// Hands over what waits, no faster than the line's bit rate and as long as at most `window` bytes are in flight;
    /// the board has `taken` so many so far, `elapsed_us` of its time after the call before.
    ///
    /// # Errors
    /// The emulator has gone.
    pub fn flush(&mut self, taken: u32, window: u64, elapsed_us: u64) -> anyhow::Result<()> {
        let handed_over = self.sent - self.waiting.len() as u64;
        let in_flight = handed_over.saturating_sub(u64::from(taken));
        self.allowed = (self.allowed + elapsed_us * self.bytes_per_s).min(LATE_US * self.bytes_per_s);
        let free = window.saturating_sub(in_flight).min(self.allowed / 1_000_000);
        let mut left = usize::try_from(free)?;
        while !self.waiting.is_empty() && left > 0 {
            let (front, _) = self.waiting.as_slices();
            match self.stream.write(front.get(..left).unwrap_or(front)) {
                Ok(count) => {
                    self.waiting.drain(..count);
                    left -= count;
                    self.allowed = self.allowed.saturating_sub(count as u64 * 1_000_000);
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) => return Err(error).context("a serial line of the emulator broke"),
            }
        }
        Ok(())
    }

    /// What the board has written.
    ///
    /// # Errors
    /// The emulator has gone.
    pub fn receive(&mut self) -> anyhow::Result<Vec<u8>> {
        let mut bytes = vec![0; 4_096];
        match self.stream.read(&mut bytes) {
            Ok(count) => bytes.truncate(count),
            Err(error) if error.kind() == ErrorKind::WouldBlock => bytes.clear(),
            Err(error) => return Err(error).context("a serial line of the emulator broke"),
        }
        Ok(bytes)
    }
}
