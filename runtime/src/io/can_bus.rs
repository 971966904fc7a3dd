//! A CAN bus, whatever carries it.

use floorguard_drivers::can::CanFrame;

/// Sends and receives classic CAN frames.
pub trait CanBus {
    /// What can go wrong with the link.
    type Error: core::fmt::Debug;

    /// Waits for the next frame. Dropping the future loses nothing. A bus that may have a frame at any time gives way to
    /// every other task before it takes one.
    ///
    /// # Errors
    /// The link failed, or the bus is off; the caller counts it, pauses and tries again.
    fn receive(&mut self) -> impl Future<Output = Result<CanFrame, Self::Error>>;

    /// Sends a frame.
    ///
    /// # Errors
    /// The link failed; the frame is lost.
    fn send(&mut self, frame: &CanFrame) -> impl Future<Output = Result<(), Self::Error>>;
}
