//! Whole frames in both directions: a socket, or a serial line on which frames are found.

use embassy_time::Timer;
use embedded_io_async::{Read, Write};
use floorguard_drivers::velocity_link::LineReceiver;
use floorguard_types::time::Stamp;

use crate::clock;

/// Bytes taken from a line at once.
const PORTION_BYTES: usize = 64;

/// A frame that was received into the caller's buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PortFrame {
    /// Bytes written to the buffer. A longer frame is cut to the buffer's size.
    pub length: usize,
    /// When it arrived, on the robot's clock.
    pub arrival: Stamp,
    /// A number for the other end; the same for the same address.
    pub peer: u64,
}

/// A link to a program or a device that speaks in frames.
pub trait FramePort {
    /// What can go wrong with the link.
    type Error: core::fmt::Debug;

    /// Waits for the next frame. Dropping the future loses at most that frame.
    ///
    /// # Errors
    /// The link failed; the caller pauses and tries again.
    fn receive(&mut self, buffer: &mut [u8]) -> impl Future<Output = Result<PortFrame, Self::Error>>;

    /// From now on answers go to the sender of the frame received last.
    fn follow(&mut self);

    /// Sends a frame to the one that is followed, and to all who only listen; without any of them nowhere.
    ///
    /// # Errors
    /// The link failed; the frame is lost.
    fn send(&mut self, frame: &[u8]) -> impl Future<Output = Result<(), Self::Error>>;
}

/// Waits for a moment, if one is given, and then for the next frame: a link that fails at once, again and again, must not keep a task
/// from its deadlines.
///
/// # Errors
/// As [`FramePort::receive`].
pub async fn receive_from<P: FramePort>(
    begin: Option<Stamp>,
    port: &mut P,
    buffer: &mut [u8],
) -> Result<PortFrame, P::Error> {
    if let Some(stamp) = begin {
        Timer::at(clock::instant(stamp)).await;
    }
    port.receive(buffer).await
}

/// A serial line, on which one end speaks with one other.
pub struct LinePort<L> {
    line: L,
    receiver: LineReceiver,
    portion: [u8; PORTION_BYTES],
    /// What is left of the portion.
    from: usize,
    to: usize,
}

/// The line failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinePortError<E> {
    /// The line.
    Line(E),
    /// The line has ended.
    Ended,
}

impl<L: Read + Write> LinePort<L> {
    /// On an open line.
    #[must_use]
    pub const fn new(line: L) -> Self {
        Self { line, receiver: LineReceiver::new(), portion: [0; PORTION_BYTES], from: 0, to: 0 }
    }

    /// The next frame in the portion that was read, copied.
    fn buffered(&mut self, buffer: &mut [u8]) -> Option<usize> {
        for _ in 0..PORTION_BYTES {
            let byte = *self.portion.get(..self.to)?.get(self.from)?;
            self.from = self.from.saturating_add(1);
            if let Some(frame) = self.receiver.byte(byte) {
                for (place, byte) in buffer.iter_mut().zip(frame) {
                    *place = *byte;
                }
                return Some(frame.len().min(buffer.len()));
            }
        }
        None
    }
}

impl<L: Read + Write> FramePort for LinePort<L> {
    type Error = LinePortError<L::Error>;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<PortFrame, Self::Error> {
        loop {
            if let Some(length) = self.buffered(buffer) {
                return Ok(PortFrame { length, arrival: clock::now(), peer: 0 });
            }
            match self.line.read(&mut self.portion).await.map_err(LinePortError::Line)? {
                0 => return Err(LinePortError::Ended),
                count => (self.from, self.to) = (0, count),
            }
        }
    }

    fn follow(&mut self) {}

    async fn send(&mut self, frame: &[u8]) -> Result<(), Self::Error> {
        let mut rest = frame;
        // Each turn writes at least a byte or ends.
        for _ in 0..frame.len() {
            let count = self.line.write(rest).await.map_err(LinePortError::Line)?;
            rest = rest.get(count..).unwrap_or_default();
            if rest.is_empty() {
                return Ok(());
            }
        }
        Err(LinePortError::Ended)
    }
}
