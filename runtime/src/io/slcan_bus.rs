//! CAN over a serial line by SLCAN text.

use embedded_io_async::{Read, Write};
use floorguard_drivers::can::{CanFrame, SlcanCounters, SlcanEvent, SlcanReceiver, encode_slcan};

use super::can_bus::CanBus;

/// Bytes taken from the line at once: four frames.
const PORTION_BYTES: usize = 128;

/// Close, 500 kbit/s, open (book, CAN frames: SLCAN).
const OPEN: &[u8] = b"C\rS6\rO\r";

/// An adapter on a serial line.
pub struct SlcanBus<L> {
    line: L,
    receiver: SlcanReceiver,
    portion: [u8; PORTION_BYTES],
    /// What is left of the portion.
    from: usize,
    to: usize,
    opened: bool,
}

/// The line failed, or the adapter refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlcanBusError<E> {
    /// The line.
    Line(E),
    /// The line has ended.
    Ended,
}

impl<L: Read + Write> SlcanBus<L> {
    /// An adapter that is opened with the first use.
    #[must_use]
    pub const fn new(line: L) -> Self {
        let portion = [0; PORTION_BYTES];
        Self { line, receiver: SlcanReceiver::new(), portion, from: 0, to: 0, opened: false }
    }

    /// What happened on the line.
    #[must_use]
    pub const fn counters(&self) -> SlcanCounters {
        self.receiver.counters()
    }

    async fn open(&mut self) -> Result<(), SlcanBusError<L::Error>> {
        if !self.opened {
            self.write(OPEN).await?;
            self.opened = true;
        }
        Ok(())
    }

    async fn write(&mut self, bytes: &[u8]) -> Result<(), SlcanBusError<L::Error>> {
        let mut rest = bytes;
        // Each turn writes at least a byte or ends.
        for _ in 0..bytes.len() {
            let count = match self.line.write(rest).await {
                Ok(count) => count,
                Err(error) => return Err(self.lost(SlcanBusError::Line(error))),
            };
            rest = rest.get(count..).unwrap_or_default();
            if rest.is_empty() {
                return Ok(());
            }
        }
        Err(self.lost(SlcanBusError::Ended))
    }

    /// An adapter that comes back has forgotten that it was opened.
    fn lost(&mut self, error: SlcanBusError<L::Error>) -> SlcanBusError<L::Error> {
        self.opened = false;
        error
    }

    /// The next frame in the portion that was read.
    fn buffered(&mut self) -> Option<CanFrame> {
        for _ in 0..PORTION_BYTES {
            if self.from >= self.to {
                return None;
            }
            let byte = *self.portion.get(self.from)?;
            self.from = self.from.saturating_add(1);
            if let Some(SlcanEvent::Frame(frame)) = self.receiver.byte(byte) {
                return Some(frame);
            }
        }
        None
    }
}

impl<L: Read + Write> CanBus for SlcanBus<L> {
    type Error = SlcanBusError<L::Error>;

    async fn receive(&mut self) -> Result<CanFrame, Self::Error> {
        self.open().await?;
        loop {
            if let Some(frame) = self.buffered() {
                return Ok(frame);
            }
            match self.line.read(&mut self.portion).await {
                Ok(0) => return Err(self.lost(SlcanBusError::Ended)),
                Ok(count) => (self.from, self.to) = (0, count),
                Err(error) => return Err(self.lost(SlcanBusError::Line(error))),
            }
        }
    }

    async fn send(&mut self, frame: &CanFrame) -> Result<(), Self::Error> {
        self.open().await?;
        self.write(&encode_slcan(frame)).await
    }
}
