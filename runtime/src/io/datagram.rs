//! Datagrams with the time at which they arrived.
//!
//! `embassy-net` and the operating system offer different sockets; the lidar needs this only: the next datagram, and
//! when the board saw it.

use floorguard_types::time::Stamp;

/// A datagram that was received into the caller's buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Received {
    /// Bytes written to the buffer. A longer datagram is cut to the buffer's size.
    pub length: usize,
    /// When it arrived, on the robot's clock.
    pub arrival: Stamp,
}

/// A bound UDP port.
pub trait DatagramReceiver {
    /// What can go wrong with the link.
    type Error: core::fmt::Debug;

    /// Waits for the next datagram.
    ///
    /// # Errors
    /// The link failed; the caller counts it, pauses and tries again.
    fn receive(&mut self, buffer: &mut [u8]) -> impl Future<Output = Result<Received, Self::Error>>;
}
