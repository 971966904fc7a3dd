//! Whether a camera's frames are living ones: stamped in order, not from the future, and not the same picture again and
//! again.
//!
//! Noise makes every picture of a living camera another one, dark or bright. One that repeats itself shows a floor of
//! long ago, however young its stamps are.

use crate::time::{Age, Stamp};

/// Identical pictures in a row that mean a frozen camera: real noise never repeats 10⁴ values once.
pub const FROZEN_FRAMES: u8 = 3;

/// Why a frame is not to be believed, whatever it shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameFault {
    /// Stamped later than now, µs.
    FromTheFuture(u64),
    /// Not newer than the frame before.
    OutOfOrder,
    /// The same picture again and again: how often.
    Frozen(u8),
}

impl core::fmt::Display for FrameFault {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::FromTheFuture(early) => write!(formatter, "the image is stamped {early} µs from now"),
            Self::OutOfOrder => write!(formatter, "the image is not newer than the one before"),
            Self::Frozen(times) => write!(formatter, "the camera is frozen: the same image {times} times"),
        }
    }
}

impl core::error::Error for FrameFault {}

/// What is remembered of the frames of one camera.
///
/// ```
/// use floorguard_types::sensing::{FrameFault, FrameWatch};
/// use floorguard_types::time::Stamp;
///
/// let mut watch = FrameWatch::NEW;
/// let mut show = |micros, picture| {
///     watch.accept(Stamp::from_micros(micros), picture, Stamp::from_micros(micros))
/// };
/// assert_eq!(show(10, 0xA), Ok(()));
/// assert_eq!(show(20, 0xA), Ok(()));
/// assert_eq!(show(30, 0xA), Err(FrameFault::Frozen(3)));
/// assert_eq!(show(40, 0xB), Ok(()));
/// assert_eq!(show(40, 0xC), Err(FrameFault::OutOfOrder));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameWatch {
    last: Option<(Stamp, u64)>,
    repeats: u8,
}

impl FrameWatch {
    /// Nothing seen yet.
    pub const NEW: Self = Self { last: None, repeats: 0 };

    /// Takes a frame with the [`fingerprint`] of its pixels; `now` is the time of the call.
    ///
    /// # Errors
    /// The frame says nothing about the present.
    pub fn accept(&mut self, stamp: Stamp, fingerprint: u64, now: Stamp) -> Result<(), FrameFault> {
        if let Age::Future(early) = stamp.age(now) {
            return Err(FrameFault::FromTheFuture(early));
        }
        if let Some((before, same)) = self.last {
            if stamp <= before {
                return Err(FrameFault::OutOfOrder);
            }
            self.repeats = if same == fingerprint { self.repeats.saturating_add(1) } else { 0 };
        }
        self.last = Some((stamp, fingerprint));
        let times = self.repeats.saturating_add(1);
        if times >= FROZEN_FRAMES { Err(FrameFault::Frozen(times)) } else { Ok(()) }
    }
}

/// A number that differs, but for one chance in 2⁶⁴, where two pictures differ in one of the values.
///
/// ```
/// use floorguard_types::sensing::fingerprint;
///
/// assert_ne!(fingerprint([1, 2].into_iter()), fingerprint([2, 1].into_iter()));
/// ```
#[must_use]
pub fn fingerprint(values: impl Iterator<Item = u64>) -> u64 {
    // FNV-1a over words: offset basis and prime of its authors.
    values.fold(0xcbf2_9ce4_8422_2325, |hash, value| (hash ^ value).wrapping_mul(0x0000_0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frozen_late_and_future_frames_are_reported() {
        let mut watch = FrameWatch::NEW;
        let at = Stamp::from_micros;
        let picture = |value: u64| fingerprint([7, value].into_iter());
        assert_eq!(watch.accept(at(9), picture(1), at(5)), Err(FrameFault::FromTheFuture(4)));
        assert_eq!(watch.accept(at(10), picture(1), at(10)), Ok(()));
        assert_eq!(watch.accept(at(10), picture(2), at(11)), Err(FrameFault::OutOfOrder));
        assert_eq!(watch.accept(at(20), picture(1), at(20)), Ok(()));
        assert_eq!(watch.accept(at(30), picture(1), at(30)), Err(FrameFault::Frozen(3)));
        assert_eq!(watch.accept(at(40), picture(2), at(40)), Ok(()));
    }
}
