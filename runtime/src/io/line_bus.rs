//! The serial line of motor controllers, carried as a bus: bytes in frames of up to eight with the identifier 0. So it goes the same way
//! as a bus does: through the same task, onto the same recordings.

use embedded_io_async::{Read, Write};
use floorguard_drivers::can::CanFrame;

use super::can_bus::CanBus;
use super::slcan_bus::SlcanBusError;

/// Bytes of a frame.
const FRAME_BYTES: usize = 8;

/// A serial line.
pub struct LineBus<L> {
    line: L,
}

impl<L: Read + Write> LineBus<L> {
    /// A line.
    #[must_use]
    pub const fn new(line: L) -> Self {
        Self { line }
    }
}

impl<L: Read + Write> CanBus for LineBus<L> {
    type Error = SlcanBusError<L::Error>;

    async fn receive(&mut self) -> Result<CanFrame, Self::Error> {
        let mut portion = [0; FRAME_BYTES];
        match self.line.read(&mut portion).await {
            Ok(0) => Err(SlcanBusError::Ended),
            Ok(count) => Ok(CanFrame::standard(0, portion.get(..count).unwrap_or_default())),
            Err(error) => Err(SlcanBusError::Line(error)),
        }
    }

    async fn send(&mut self, frame: &CanFrame) -> Result<(), Self::Error> {
        let mut rest = frame.payload();
        // Each turn writes at least a byte or ends.
        for _ in 0..FRAME_BYTES {
            if rest.is_empty() {
                return Ok(());
            }
            match self.line.write(rest).await {
                Ok(count) => rest = rest.get(count..).unwrap_or_default(),
                Err(error) => return Err(SlcanBusError::Line(error)),
            }
        }
        if rest.is_empty() { Ok(()) } else { Err(SlcanBusError::Ended) }
    }
}
