//! Finds frames in bytes that come in any portions: a datagram at a time, or from a serial line.

use super::frame::{
    FRAME_BYTES_MAX, FrameError, LENGTH_KNOWN, SAMPLES_MAX, START, SamplesFrame, frame_bytes,
};

/// Collects bytes until they are a frame.
#[derive(Clone, Debug)]
pub struct FrameReceiver {
    bytes: [u8; FRAME_BYTES_MAX],
    length: usize,
}

impl Default for FrameReceiver {
    fn default() -> Self {
        Self { bytes: [0; FRAME_BYTES_MAX], length: 0 }
    }
}

impl FrameReceiver {
    /// Takes bytes. Each frame that is whole goes to `found`, with what is wrong with it, if something is.
    pub fn push(&mut self, bytes: &[u8], mut found: impl FnMut(Result<SamplesFrame<'_>, FrameError>)) {
        for byte in bytes {
            if let Some(place) = self.bytes.get_mut(self.length) {
                *place = *byte;
                self.length = self.length.saturating_add(1);
            }
            // Each attempt that fails drops a byte at least: no more of them are needed than bytes are there.
            for _ in 0..FRAME_BYTES_MAX {
                if !self.settle(&mut found) {
                    break;
                }
            }
        }
    }

    /// Whether something was dropped or found, so that the bytes behind it may be more.
    fn settle(&mut self, found: &mut impl FnMut(Result<SamplesFrame<'_>, FrameError>)) -> bool {
        let held = self.bytes.get(..self.length).unwrap_or_default();
        let begins = START.iter().zip(held).all(|(expected, byte)| expected == byte);
        if !begins {
            self.drop_to_start();
            return true;
        }
        if self.length < LENGTH_KNOWN {
            return false;
        }
        let count = held.get(LENGTH_KNOWN.saturating_sub(1)).copied().unwrap_or(0);
        if count == 0 || count > SAMPLES_MAX {
            self.drop_to_start();
            return true;
        }
        let needed = frame_bytes(count);
        let Some(frame) = held.get(..needed) else { return false };
        let checked = SamplesFrame::new_checked(frame);
        let is_whole = !matches!(checked, Err(FrameError::Checksum { .. }));
        found(checked);
        if is_whole {
            self.keep_from(needed);
        } else {
            // The start may have stood in damaged data.
            self.drop_to_start();
        }
        true
    }

    /// Drops the first byte, and those after it up to where a frame may begin.
    fn drop_to_start(&mut self) {
        let held = self.bytes.get(1..self.length).unwrap_or_default();
        let [first, ..] = START;
        let skipped = held.iter().position(|byte| *byte == first).unwrap_or(held.len());
        self.keep_from(skipped.saturating_add(1));
    }

    fn keep_from(&mut self, from: usize) {
        let mut kept = [0; FRAME_BYTES_MAX];
        for (place, byte) in kept.iter_mut().zip(self.bytes.iter().skip(from)) {
            *place = *byte;
        }
        self.bytes = kept;
        self.length = self.length.saturating_sub(from);
    }
}
