//! SLCAN (Lawicel ASCII): one line of text per frame (book, CAN frames: SLCAN).
//!
//! Stricter than the Python package: a line that is not exactly what its length digit says is refused and counted.

use floorguard_types::number::truncating_u8;

use embedded_can::{ExtendedId, Frame, Id, StandardId};
use heapless::Vec;

use super::frame::CanFrame;

/// The longest line: `T`, eight digits, length, sixteen digits, four of a time stamp, CR, and reserve.
pub const SLCAN_LINE_BYTES: usize = 32;
const CARRIAGE_RETURN: u8 = 0x0D;
const BELL: u8 = 0x07;

/// What the line reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlcanEvent {
    /// A frame from the bus.
    Frame(CanFrame),
    /// The adapter refused a command.
    AdapterError,
}

/// What happened on the line; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SlcanCounters {
    /// Good frames.
    pub frames: u32,
    /// Lines that are neither a frame nor an answer.
    pub refused: u32,
    /// Refusals by the adapter.
    pub adapter_errors: u32,
}

/// Cuts a byte stream into lines.
///
/// ```
/// use floorguard_drivers::can::{CanFrame, SlcanEvent, SlcanReceiver};
///
/// let mut receiver = SlcanReceiver::new();
/// let frames: Vec<_> = b"t8000\rt4563112233\r".iter().filter_map(|byte| receiver.byte(*byte)).collect();
/// // 800 is no identifier of 11 bits: refused and counted.
/// assert_eq!(frames, [SlcanEvent::Frame(CanFrame::standard(0x456, &[0x11, 0x22, 0x33]))]);
/// assert_eq!(receiver.counters().refused, 1);
/// ```
#[derive(Clone, Debug, Default)]
pub struct SlcanReceiver {
    line: Vec<u8, SLCAN_LINE_BYTES>,
    overlong: bool,
    counters: SlcanCounters,
}

impl SlcanReceiver {
    /// Nothing received yet.
    #[must_use]
    pub const fn new() -> Self {
        let counters = SlcanCounters { frames: 0, refused: 0, adapter_errors: 0 };
        Self { line: Vec::new(), overlong: false, counters }
    }

    /// Takes in bytes in any portions. Resynchronises at the next line end, whatever came before.
    pub fn push(&mut self, bytes: &[u8], mut event: impl FnMut(SlcanEvent)) {
        for byte in bytes {
            if let Some(found) = self.byte(*byte) {
                event(found);
            }
        }
    }

    /// Takes in one byte.
    pub fn byte(&mut self, byte: u8) -> Option<SlcanEvent> {
        match byte {
            CARRIAGE_RETURN => self.end_of_line(),
            BELL => {
                self.line.clear();
                self.overlong = false;
                self.counters.adapter_errors = self.counters.adapter_errors.saturating_add(1);
                Some(SlcanEvent::AdapterError)
            }
            _ => {
                self.overlong |= self.line.push(byte).is_err();
                None
            }
        }
    }

    fn end_of_line(&mut self) -> Option<SlcanEvent> {
        let frame = if self.overlong { None } else { parse(&self.line) };
        let answer = !self.overlong && is_answer(&self.line);
        self.line.clear();
        self.overlong = false;
        match frame {
            Some(frame) => {
                self.counters.frames = self.counters.frames.saturating_add(1);
                Some(SlcanEvent::Frame(frame))
            }
            None => {
                if !answer {
                    self.counters.refused = self.counters.refused.saturating_add(1);
                }
                None
            }
        }
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> SlcanCounters {
        self.counters
    }
}

/// Empty line, acknowledgement of a transmission, version, serial number, status.
fn is_answer(line: &[u8]) -> bool {
    matches!(line, [] | [b'z' | b'Z'] | [b'V', _, _, _, _] | [b'N', _, _, _, _] | [b'F', _, _])
}

fn parse(line: &[u8]) -> Option<CanFrame> {
    let (kind, rest) = line.split_first()?;
    let (digits, remote) = match kind {
        b't' => (3, false),
        b'r' => (3, true),
        b'T' => (8, false),
        b'R' => (8, true),
        _ => return None,
    };
    let (id, rest) = rest.split_at_checked(digits)?;
    let (length, rest) = rest.split_first()?;
    let raw = number(id)?;
    let id = if digits == 3 {
        Id::Standard(StandardId::new(u16::try_from(raw).ok()?)?)
    } else {
        Id::Extended(ExtendedId::new(raw)?)
    };
    let length = usize::from(nibble(*length)?);
    let data_digits = if remote { 0 } else { length.checked_mul(2)? };
    let (data, stamp) = rest.split_at_checked(data_digits)?;
    let stamp_good = stamp.is_empty() || (stamp.len() == 4 && number(stamp).is_some());
    if length > 8 || !stamp_good {
        return None;
    }
    if remote {
        return CanFrame::new_remote(id, length);
    }
    let mut bytes = [0; 8];
    for (cell, pair) in bytes.iter_mut().zip(data.chunks(2)) {
        *cell = u8::try_from(number(pair)?).ok()?;
    }
    CanFrame::new(id, bytes.get(..length)?)
}

fn number(digits: &[u8]) -> Option<u32> {
    let mut value = 0_u32;
    for digit in digits {
        value = (value << 4) | u32::from(nibble(*digit)?);
    }
    Some(value)
}

fn nibble(digit: u8) -> Option<u8> {
    match digit {
        b'0'..=b'9' => Some(digit.wrapping_sub(b'0')),
        b'A'..=b'F' => Some(digit.wrapping_sub(b'A').wrapping_add(10)),
        b'a'..=b'f' => Some(digit.wrapping_sub(b'a').wrapping_add(10)),
        _ => None,
    }
}

/// The line that sends a frame, CR included.
///
/// ```
/// use floorguard_drivers::can::{CanFrame, encode_slcan};
///
/// let line = encode_slcan(&CanFrame::standard(0x201, &[0x0F, 0, 0x10, 0x27, 0, 0]));
/// assert_eq!(line, *b"t20160F0010270000\r");
/// ```
#[must_use]
pub fn encode_slcan(frame: &CanFrame) -> Vec<u8, SLCAN_LINE_BYTES> {
    let mut line = Vec::new();
    let (kind, raw, digits) = match (frame.id(), frame.is_remote_frame()) {
        (Id::Standard(id), false) => (b't', u32::from(id.as_raw()), 3),
        (Id::Standard(id), true) => (b'r', u32::from(id.as_raw()), 3),
        (Id::Extended(id), false) => (b'T', id.as_raw(), 8),
        (Id::Extended(id), true) => (b'R', id.as_raw(), 8),
    };
    // 1 + 8 + 1 + 16 + 1 bytes at most: never full.
    let _ = line.push(kind);
    for place in 0..8_u32 {
        if place < digits {
            let shift = digits.saturating_sub(place).saturating_sub(1).saturating_mul(4);
            let _ = line.push(digit(truncating_u8(raw.wrapping_shr(shift))));
        }
    }
    let _ = line.push(digit(truncating_u8(frame.dlc())));
    for byte in frame.data() {
        let _ = line.push(digit(byte >> 4));
        let _ = line.push(digit(*byte));
    }
    let _ = line.push(CARRIAGE_RETURN);
    line
}

/// The lowest four bits as a digit.
const fn digit(value: u8) -> u8 {
    match value & 0x0F {
        low @ 0..=9 => low.wrapping_add(b'0'),
        high => high.wrapping_sub(10).wrapping_add(b'A'),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec as StdVec;

    fn frames(bytes: &[u8]) -> (StdVec<CanFrame>, SlcanCounters) {
        let mut receiver = SlcanReceiver::new();
        let mut found = StdVec::new();
        receiver.push(bytes, |event| match event {
            SlcanEvent::Frame(frame) => found.push(frame),
            SlcanEvent::AdapterError => {}
        });
        (found, receiver.counters())
    }

    /// Every example of the book, CAN frames: SLCAN, both ways.
    #[test]
    fn published_vectors() {
        let standard = |id: u16, data: &[u8]| CanFrame::standard(id, data);
        let remote = |id: u16, length| CanFrame::new_remote(StandardId::new(id).unwrap(), length).unwrap();
        let vectors = [
            ("t0800\r", standard(0x080, &[])),
            ("t20160F0010270000\r", standard(0x201, &[0x0F, 0, 0x10, 0x27, 0, 0])),
            ("t60184000100000000000\r", standard(0x601, &[0x40, 0, 0x10, 0, 0, 0, 0, 0])),
            ("T01ABCDEF3010203\r", CanFrame::extended(0x01AB_CDEF, &[1, 2, 3]).unwrap()),
            ("r7FF8\r", remote(0x7FF, 8)),
            ("t4563112233\r", standard(0x456, &[0x11, 0x22, 0x33])),
            ("T12ABCDEF2AA55\r", CanFrame::extended(0x12AB_CDEF, &[0xAA, 0x55]).unwrap()),
            ("R12ABCDEF6\r", CanFrame::new_remote(ExtendedId::new(0x12AB_CDEF).unwrap(), 6).unwrap()),
            ("t1815370200FFFF\r", standard(0x181, &[0x37, 2, 0, 0xFF, 0xFF])),
        ];
        for (line, frame) in vectors {
            assert_eq!(frames(line.as_bytes()).0, [frame], "{line}");
            assert_eq!(encode_slcan(&frame).as_slice(), line.as_bytes(), "{line}");
        }
    }

    #[test]
    fn inputs_wrongly_accepted_by_the_python_package() {
        for line in ["t7011\r", "t1239\r", "t8000\r", "T200000000\r", "t45631122334\r", "tXYZ0\r", "q\r"] {
            let (found, counters) = frames(line.as_bytes());
            assert_eq!((found.len(), counters.refused), (0, 1), "{line:?}");
        }
        let long = [b't'; 40];
        let mut bytes = long.to_vec();
        bytes.extend(b"\rt0800\r");
        let (found, counters) = frames(&bytes);
        assert_eq!((found.len(), counters.refused), (1, 1));
    }

    #[test]
    fn lower_case_digits_accepted_long_lines_refused() {
        assert_eq!(frames(b"t0812abcf\r").0, [CanFrame::standard(0x081, &[0xAB, 0xCF])]);
        // The longest line with a time stamp is a frame; further characters in the same line invalidate it.
        let longest = b"T01ABCDEF811223344556677881A2B";
        let mut bytes = longest.to_vec();
        bytes.push(b'\r');
        assert_eq!(frames(&bytes).0.len(), 1);
        bytes.truncate(longest.len());
        bytes.resize(SLCAN_LINE_BYTES, b'0');
        bytes.extend(b"00\r");
        assert_eq!(frames(&bytes).0, []);
    }

    #[test]
    fn answers_time_stamps_and_split_lines() {
        let (found, counters) = frames(b"\rz\rZ\rV1013\rNA123\rF00\rt08001A2B\r\x07t0800\r");
        assert_eq!((found.len(), counters.refused, counters.adapter_errors), (2, 0, 1));
        let mut receiver = SlcanReceiver::new();
        let mut count = 0;
        receiver.push(b"T12ABCDEF", |_| count += 1);
        receiver.push(b"2AA55\rT12", |_| count += 1);
        assert_eq!(count, 1);
        receiver.push(b"ABCDEF2AA55\r", |_| count += 1);
        assert_eq!(count, 2);
    }

    proptest! {
        #[test]
        fn portioning_does_not_change_frames(bytes: StdVec<u8>, cut in 0_usize..64) {
            let whole = frames(&bytes);
            let mut receiver = SlcanReceiver::new();
            let mut found = StdVec::new();
            let (a, b) = bytes.split_at(cut.min(bytes.len()));
            for part in [a, b] {
                receiver.push(part, |event| if let SlcanEvent::Frame(frame) = event { found.push(frame) });
            }
            prop_assert_eq!((found, receiver.counters()), whole);
        }

        #[test]
        fn what_is_written_is_read(id in 0_u16..0x800, data in proptest::collection::vec(any::<u8>(), 0..=8)) {
            let frame = CanFrame::standard(id, &data);
            prop_assert_eq!(frames(&encode_slcan(&frame)).0, [frame]);
        }
    }
}
