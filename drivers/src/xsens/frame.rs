//! Xbus frames (book, Xsens MTi: Frames): searched for in any portions of bytes, checked, resynchronised.

use floorguard_types::number::truncating_u32;
use floorguard_types::time::{Age, Stamp};
use heapless::Vec;

const PREAMBLE: u8 = 0xFA;
const MASTER: u8 = 0xFF;
/// Data bytes of the longest frame.
const DATA_MAX: usize = 2_048;
/// Preamble, bus, message, length and two more, checksum.
const OVERHEAD_MAX: usize = 7;
const BUFFER_BYTES: usize = DATA_MAX + OVERHEAD_MAX;
/// A frame is sent without gaps: one that stays unfinished this long is given up, microseconds.
const GAP_MAX_US: u64 = 20_000;

/// A checked message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<'a> {
    /// What it is.
    pub id: u8,
    /// Its data.
    pub data: &'a [u8],
}

/// What happened on the line; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameCounters {
    /// Bytes received.
    pub bytes: u32,
    /// Right frames.
    pub frames: u32,
    /// Preambles behind which the checksum was wrong.
    pub checksum_failures: u32,
    /// Frames given up after a silence.
    pub gaps: u32,
    /// Bytes that belong to no frame.
    pub skipped: u32,
}

/// Receives one device. About 2 KiB.
///
/// ```
/// use floorguard_drivers::xsens::FrameReceiver;
/// use floorguard_types::time::Stamp;
///
/// // Noise, then GoToConfig, in pieces.
/// let mut receiver = FrameReceiver::new();
/// let mut messages = Vec::new();
/// for piece in [&[0x00, 0xFA][..], &[0xFA, 0xFF, 0x30], &[0x00, 0xD1]] {
///     receiver.push(piece, Stamp::ZERO, |message, _| messages.push(message.id));
/// }
/// assert_eq!(messages, [0x30]);
/// assert_eq!(receiver.counters().frames, 1);
/// ```
#[derive(Clone, Debug)]
pub struct FrameReceiver {
    buffer: [u8; BUFFER_BYTES],
    length: usize,
    /// Data bytes of the longest frame that is waited for.
    data_max: usize,
    last_byte: Stamp,
    counters: FrameCounters,
}

/// What stands at the front of the buffer.
enum Front {
    /// A right frame.
    Frame {
        /// Bytes before the data.
        header: usize,
        /// Bytes of the data.
        data: usize,
    },
    /// Perhaps one; more bytes will tell.
    Unfinished,
    /// A preamble with a wrong sum behind it.
    Broken,
    /// None.
    Nothing,
}

impl FrameReceiver {
    /// An empty receiver for frames of any length.
    #[must_use]
    pub const fn new() -> Self {
        Self::limited(DATA_MAX)
    }

    /// An empty receiver that takes a length above `data_max` for noise: the longer a false length makes it wait, the
    /// more right frames behind it are late.
    #[must_use]
    pub const fn limited(data_max: usize) -> Self {
        Self {
            buffer: [0; BUFFER_BYTES],
            length: 0,
            data_max: if data_max < DATA_MAX { data_max } else { DATA_MAX },
            last_byte: Stamp::ZERO,
            counters: FrameCounters { bytes: 0, frames: 0, checksum_failures: 0, gaps: 0, skipped: 0 },
        }
    }

    /// Takes in bytes that arrived at `now`. `message` is called for each right frame, with its length on the line.
    pub fn push(&mut self, bytes: &[u8], now: Stamp, mut message: impl FnMut(Message<'_>, usize)) {
        let silent = matches!(self.last_byte.age(now), Age::Past(us) if us > GAP_MAX_US);
        if silent && self.length > 0 {
            self.counters.gaps = self.counters.gaps.saturating_add(1);
            self.discard_preamble();
            self.consume(&mut message);
        }
        for byte in bytes {
            self.counters.bytes = self.counters.bytes.saturating_add(1);
            if let Some(slot) = self.buffer.get_mut(self.length) {
                *slot = *byte;
                self.length = self.length.saturating_add(1);
            }
            self.consume(&mut message);
        }
        self.last_byte = now;
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> FrameCounters {
        self.counters
    }

    /// Takes frames off the front until it is unfinished. Each turn removes at least one byte.
    fn consume(&mut self, message: &mut impl FnMut(Message<'_>, usize)) {
        for _ in 0..BUFFER_BYTES {
            match self.front() {
                Front::Frame { header, data } => {
                    self.counters.frames = self.counters.frames.saturating_add(1);
                    let end = header.saturating_add(data);
                    let total = end.saturating_add(1);
                    if let (Some(id), Some(data)) = (self.buffer.get(2), self.buffer.get(header..end)) {
                        message(Message { id: *id, data }, total);
                    }
                    self.discard(total);
                }
                Front::Broken => {
                    self.counters.checksum_failures = self.counters.checksum_failures.saturating_add(1);
                    self.discard_preamble();
                }
                Front::Nothing => self.discard_preamble(),
                Front::Unfinished => return,
            }
        }
    }

    fn front(&self) -> Front {
        let bytes = self.buffer.get(..self.length).unwrap_or_default();
        let (header, data): (usize, usize) = match *bytes {
            [] => return Front::Unfinished,
            [first, ..] if first != PREAMBLE => return Front::Nothing,
            [_, second, ..] if second != MASTER => return Front::Nothing,
            [_, _, _, 0xFF, high, low, ..] => match u16::from_be_bytes([high, low]) {
                // 254 bytes and fewer are sent in the short form.
                0..0xFF => return Front::Nothing,
                length => (6, usize::from(length)),
            },
            [_, _, _, length, ..] if length != 0xFF => (4, usize::from(length)),
            _ => return Front::Unfinished,
        };
        if data > self.data_max {
            return Front::Nothing;
        }
        let Some(summed) = bytes.get(1..=header.saturating_add(data)) else { return Front::Unfinished };
        let sum = summed.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        if sum == 0 { Front::Frame { header, data } } else { Front::Broken }
    }

    /// Drops the first byte, and then everything that cannot begin a frame.
    fn discard_preamble(&mut self) {
        let used = self.buffer.get(..self.length).unwrap_or_default();
        let next = used.iter().skip(1).position(|byte| *byte == PREAMBLE);
        let count = next.map_or(self.length, |position| position.saturating_add(1));
        self.counters.skipped = self.counters.skipped.saturating_add(truncating_u32(count));
        self.discard(count);
    }

    fn discard(&mut self, count: usize) {
        let kept = self.length.saturating_sub(count);
        for index in 0..BUFFER_BYTES {
            if index >= kept {
                break;
            }
            let byte = self.buffer.get(index.saturating_add(count)).copied().unwrap_or_default();
            if let Some(slot) = self.buffer.get_mut(index) {
                *slot = byte;
            }
        }
        self.length = kept;
    }
}

impl Default for FrameReceiver {
    fn default() -> Self {
        Self::new()
    }
}

/// A short frame around at most 128 data bytes; `None` for more. The master sends nothing longer.
///
/// ```
/// use floorguard_drivers::xsens::encode;
///
/// assert_eq!(encode(0x30, &[]).unwrap(), [0xFA, 0xFF, 0x30, 0x00, 0xD1]);
/// assert_eq!(encode(0x30, &[0; 129]), None);
/// ```
#[must_use]
pub fn encode(id: u8, data: &[u8]) -> Option<Vec<u8, 133>> {
    let length = u8::try_from(data.len()).ok().filter(|length| *length <= 128)?;
    let mut frame = Vec::new();
    frame.extend_from_slice(&[PREAMBLE, MASTER, id, length]).ok()?;
    frame.extend_from_slice(data).ok()?;
    let sum = frame.iter().skip(1).fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    frame.push(sum.wrapping_neg()).ok()?;
    Some(frame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec as StdVec;

    type Found = StdVec<(u8, StdVec<u8>)>;

    fn received(portions: &[&[u8]]) -> (Found, FrameCounters) {
        let mut receiver = FrameReceiver::new();
        let mut found = StdVec::new();
        for portion in portions {
            receiver.push(portion, Stamp::ZERO, |message, _| found.push((message.id, message.data.to_vec())));
        }
        (found, receiver.counters())
    }

    fn hex(text: &str) -> StdVec<u8> {
        text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
    }

    /// Commands and replies of the book, Xsens MTi: Test frames.
    #[test]
    fn published_frames() {
        let frames = [
            ("FA FF 30 00 D1", 0x30, ""),
            ("FA FF 31 00 D0", 0x31, ""),
            ("FA FF 10 00 F1", 0x10, ""),
            ("FA FF 3F 00 C2", 0x3F, ""),
            ("FA FF 40 00 C1", 0x40, ""),
            ("FA FF 00 00 01", 0x00, ""),
            ("FA FF 1C 00 E5", 0x1C, ""),
            ("FA FF 18 01 80 68", 0x18, "80"),
            ("FA FF 42 01 21 9D", 0x42, "21"),
        ];
        for (bytes, id, data) in frames {
            let (bytes, data) = (hex(bytes), hex(data));
            assert_eq!(received(&[&bytes]).0, [(id, data.clone())]);
            assert_eq!(encode(id, &data).unwrap().as_slice(), bytes);
        }
        assert_eq!(encode(0, &[0; 129]), None);
    }

    /// The checksum does not cover the preamble.
    #[test]
    fn frame_needs_preamble_and_own_address() {
        for bytes in ["FB FF 31 00 D0", "FA FE 31 00 D1"] {
            let (found, counters) = received(&[&hex(bytes), &hex("FA FF 30 00 D1")]);
            assert_eq!(found, [(0x30, StdVec::new())], "{bytes}");
            assert_eq!((counters.frames, counters.checksum_failures), (1, 0), "{bytes}");
        }
    }

    /// XS-9: starting in the middle of a frame with false preambles loses it, but not the next.
    #[test]
    fn false_preambles_cost_one_frame_only() {
        let frame = hex("FA FF 36 0C 10 20 02 FA FF 10 60 04 FA FF 36 00 F1");
        let next = hex("FA FF 31 00 D0");
        for start in 1..frame.len() {
            let mut bytes = frame[start..].to_vec();
            // A false length makes the receiver wait for 101 bytes at most; then every frame behind it is found.
            bytes.extend(next.repeat(30));
            let (found, _) = received(&[&bytes]);
            assert_eq!(found, std::vec![(0x31, StdVec::new()); 30], "{start}");
        }
    }

    /// XS-10: 260 data bytes need the long form, 254 the short one.
    #[test]
    fn extended_length() {
        let items: StdVec<u8> = (0..0x34_u8).flat_map(|k| [0x10, 0x20, 0x02, 0x00, k]).collect();
        let mut bytes = hex("FA FF 36 FF 01 04");
        bytes.extend(&items);
        bytes.push(0x71);
        assert_eq!(bytes.len(), 267);
        assert_eq!(received(&[&bytes]).0, [(0x36, items.clone())]);
        let mut short = hex("FA FF 36 FE");
        short.extend(&items[..254]);
        let sum = short[1..].iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        short.push(sum.wrapping_neg());
        assert_eq!(received(&[&short]).0, [(0x36, items[..254].to_vec())]);
    }

    /// The longest frame of the protocol fits, whatever stands before it, and little more.
    #[test]
    fn the_longest_frame_fits() {
        let mut bytes = hex("FA FF 36 FF 08 00");
        bytes.extend((0..2_048_u32).map(|k| k as u8));
        let sum = bytes[1..].iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        bytes.push(sum.wrapping_neg());
        let (found, counters) = received(&[&hex("00 FA FF"), &bytes, &hex("FA FF 31 00 D0")]);
        assert_eq!(found.iter().map(|(_, data)| data.len()).collect::<StdVec<_>>(), [2_048, 0]);
        assert_eq!(counters.frames, 2);
        assert!(size_of::<FrameReceiver>() < 2_200, "about 2 KiB, as documented");
    }

    #[test]
    fn bad_length_and_silence_block_nothing() {
        let next = hex("FA FF 31 00 D0");
        assert_eq!(received(&[&hex("FA FF 36 FF 08 01"), &next]).0.len(), 1);
        let mut receiver = FrameReceiver::new();
        let mut count = 0;
        receiver.push(&hex("FA FF 36 64 00"), Stamp::ZERO, |_, _| count += 1);
        receiver.push(&next, Stamp::from_micros(30_000), |_, _| count += 1);
        assert_eq!((count, receiver.counters().gaps), (1, 1));
    }

    #[test]
    fn overlong_frames_are_noise_longest_is_accepted() {
        for (data_max, found) in [(3, 0), (4, 1), (5, 1)] {
            let (mut receiver, mut count) = (FrameReceiver::limited(data_max), 0);
            receiver.push(&hex("FA FF 36 04 00 00 00 00 C7"), Stamp::ZERO, |_, _| count += 1);
            assert_eq!(count, found, "{data_max}");
        }
    }

    proptest! {
        #[test]
        fn portions_do_not_matter(
            bytes in proptest::collection::vec(prop_oneof![Just(0xFA_u8), Just(0xFF), 0_u8..8, any::<u8>()], 0..400),
            cut in 0_usize..400,
        ) {
            let whole = received(&[&bytes]);
            let (a, b) = bytes.split_at(cut.min(bytes.len()));
            prop_assert_eq!(received(&[a, b]), whole);
        }
    }
}
