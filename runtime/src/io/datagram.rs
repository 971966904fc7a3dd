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

    /// The datagram that was received last was the device's: from now on no other address is listened to (FG-REQ-037).
    /// Links that have only one end do nothing.
    fn keep_sender(&mut self) {}
}

/// The address whose messages were understood first: no other one is the device (FG-REQ-037).
///
/// ```
/// use floorguard_runtime::io::FirstSender;
///
/// let mut first = FirstSender::UNKNOWN;
/// assert!(first.hears("stranger") && first.hears("lidar"));
/// first.keep();
/// assert!(first.hears("lidar") && !first.hears("stranger"));
/// first.keep();
/// assert_eq!(first.device(), Some("lidar"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FirstSender<A> {
    newest: Option<A>,
    device: Option<A>,
}

impl<A> Default for FirstSender<A> {
    fn default() -> Self {
        Self { newest: None, device: None }
    }
}

impl<A: Copy + PartialEq> FirstSender<A> {
    /// Nothing was understood yet.
    pub const UNKNOWN: Self = Self { newest: None, device: None };

    /// A message arrived; whether it may be the device's.
    pub fn hears(&mut self, from: A) -> bool {
        let is_heard = self.device.is_none_or(|device| device == from);
        if is_heard {
            self.newest = Some(from);
        }
        is_heard
    }

    /// The newest message that was heard is the device's.
    pub fn keep(&mut self) {
        self.device = self.device.or(self.newest);
    }

    /// The device, once it is known.
    #[must_use]
    pub fn device(&self) -> Option<A> {
        self.device
    }
}
