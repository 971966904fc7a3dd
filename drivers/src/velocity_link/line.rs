//! Frames on a serial line: the same bytes, one frame after another. Book, Velocity link: Serial line.
//!
//! A frame is found by its start and confirmed by its checksum; after damage the search goes on at the next byte, so that
//! nothing behind it is lost.

use super::frame::{self, FRAME_BYTES_MAX, MAGIC, START_BYTES, VERSION};

/// Finds frames of any kind.
///
/// ```
/// use floorguard_drivers::velocity_link::{LineReceiver, StopDemand, VelocityRequest};
/// use floorguard_types::geometry::Twist2;
///
/// let twist = Twist2 { linear_mps: 0.5, angular_radps: 0.0 };
/// let request =
///     VelocityRequest { sender: 7, sequence: 1, sent_ms: 0, deadline_ms: 100, stop: StopDemand::None, twist };
/// let mut receiver = LineReceiver::new();
/// let mut found = Vec::new();
/// for byte in b"FGnoise".iter().chain(&request.encode()) {
///     if let Some(frame) = receiver.byte(*byte) {
///         found.push(VelocityRequest::decode(frame));
///     }
/// }
/// assert_eq!(found, [Ok(request)]);
/// ```
#[derive(Clone, Debug)]
pub struct LineReceiver {
    buffer: [u8; FRAME_BYTES_MAX],
    length: usize,
    /// Bytes of a frame that was given out, still in front.
    given: usize,
    discarded: u32,
}

/// What stands in front of the buffer.
enum Front {
    Frame(usize),
    Unfinished,
    Nothing,
}

impl Default for LineReceiver {
    fn default() -> Self {
        Self::new()
    }
}

impl LineReceiver {
    /// Has heard nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { buffer: [0; FRAME_BYTES_MAX], length: 0, given: 0, discarded: 0 }
    }

    /// Bytes that belonged to no frame; saturating.
    #[must_use]
    pub const fn discarded(&self) -> u32 {
        self.discarded
    }

    /// Takes in a byte; gives the frame that ends with it, start and checksum confirmed.
    pub fn byte(&mut self, byte: u8) -> Option<&[u8]> {
        let given = core::mem::take(&mut self.given);
        self.drop_front(given);
        // Never full: what fills the buffer is a frame or no frame.
        if let Some(place) = self.buffer.get_mut(self.length) {
            *place = byte;
            self.length = self.length.saturating_add(1);
        }
        for _ in 0..FRAME_BYTES_MAX {
            match self.front() {
                Front::Frame(length) => {
                    self.given = length;
                    return self.buffer.get(..length);
                }
                Front::Unfinished => return None,
                Front::Nothing => {
                    self.drop_front(1);
                    self.discarded = self.discarded.saturating_add(1);
                }
            }
        }
        None
    }

    fn front(&self) -> Front {
        let used = self.buffer.get(..self.length).unwrap_or_default();
        let [first, second] = MAGIC;
        let fits = used.iter().zip([first, second, VERSION]).all(|(found, wanted)| *found == wanted);
        if !fits {
            return Front::Nothing;
        }
        let Some([_, _, _, kind]) = used.first_chunk::<START_BYTES>() else { return Front::Unfinished };
        match frame::length_of(*kind).map(|length| (length, used.get(..length))) {
            Some((length, Some(whole))) if frame::checked(whole, *kind).is_ok() => Front::Frame(length),
            Some((_, None)) => Front::Unfinished,
            _ => Front::Nothing,
        }
    }

    fn drop_front(&mut self, count: usize) {
        let remaining = self.length.saturating_sub(count);
        if count == 0 {
            return;
        }
        for to in 0..remaining.min(FRAME_BYTES_MAX) {
            let moved = self.buffer.get(to.saturating_add(count)).copied().unwrap_or(0);
            if let Some(slot) = self.buffer.get_mut(to) {
                *slot = moved;
            }
        }
        self.length = remaining;
    }
}
