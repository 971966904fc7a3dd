//! What stands on the line: binary frames of the one layout that was asked for, and sentences of text between them.

use crc::{CRC_16_XMODEM, Crc, Table};
use floorguard_types::time::{Age, Stamp};
use heapless::Vec;

use super::measurement::{FRAME_BYTES, HEADER};

/// Longest sentence that is understood, with its line end, bytes. The text outputs that a device sends as delivered fit.
pub const SENTENCE_MAX: usize = 144;
/// A frame or a sentence is sent without gaps: one that stays unfinished this long is given up, microseconds.
const GAP_MAX_US: u64 = 20_000;
static CHECKSUM: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_XMODEM);

/// A checked message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message<'a> {
    /// What stands between header and checksum of a frame.
    Frame(&'a [u8; 34]),
    /// What stands between `$` and `*` of a sentence.
    Sentence(&'a [u8]),
}

/// What happened on the line; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineCounters {
    /// Bytes received.
    pub bytes: u32,
    /// Right frames.
    pub frames: u32,
    /// Right sentences.
    pub sentences: u32,
    /// Frames and sentences with a wrong checksum.
    pub checksum_failures: u32,
    /// Given up after a silence.
    pub gaps: u32,
    /// Bytes that belong to nothing.
    pub skipped: u32,
}

/// Receives one device.
///
/// ```
/// use floorguard_drivers::vectornav::{LineReceiver, Message};
/// use floorguard_types::time::Stamp;
///
/// // Noise, then an answer, in pieces.
/// let mut receiver = LineReceiver::default();
/// let mut sentences = Vec::new();
/// for piece in [&b"\x00\xFA$VNRRG,0"[..], b"4,3.1.0.0*7", b"7\r\n"] {
///     receiver.push(piece, Stamp::ZERO, |message| match message {
///         Message::Sentence(words) => sentences.push(words.to_vec()),
///         Message::Frame(_) => {}
///     });
/// }
/// assert_eq!(sentences, [b"VNRRG,04,3.1.0.0"]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct LineReceiver {
    bytes: Vec<u8, SENTENCE_MAX>,
    last_byte: Stamp,
    counters: LineCounters,
}

/// What stands at the front of the buffer.
enum Front {
    Frame,
    /// Bytes of its words, and in all.
    Sentence {
        words: usize,
        total: usize,
    },
    /// Perhaps one; more bytes will tell.
    Unfinished,
    /// A wrong checksum.
    Broken,
    Nothing,
}

impl LineReceiver {
    /// Takes in bytes that arrived at `now`. `message` is called for each right frame and sentence.
    pub fn push(&mut self, bytes: &[u8], now: Stamp, mut message: impl FnMut(Message<'_>)) {
        let is_silent = matches!(self.last_byte.age(now), Age::Past(us) if us > GAP_MAX_US);
        if is_silent && !self.bytes.is_empty() {
            self.counters.gaps = self.counters.gaps.saturating_add(1);
            self.skip();
            self.consume(&mut message);
        }
        for byte in bytes {
            self.counters.bytes = self.counters.bytes.saturating_add(1);
            // Never full: as many bytes are a message or none, and both leave the buffer.
            let _ = self.bytes.push(*byte);
            self.consume(&mut message);
        }
        self.last_byte = now;
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> LineCounters {
        self.counters
    }

    /// Takes messages off the front until it is unfinished. Each turn removes at least one byte.
    fn consume(&mut self, message: &mut impl FnMut(Message<'_>)) {
        for _ in 0..SENTENCE_MAX {
            match self.front() {
                Front::Frame => {
                    self.counters.frames = self.counters.frames.saturating_add(1);
                    if let Some((_, payload)) = self.bytes.split_first_chunk::<{ HEADER.len() }>()
                        && let Some(payload) = payload.first_chunk()
                    {
                        message(Message::Frame(payload));
                    }
                    self.discard(FRAME_BYTES);
                }
                Front::Sentence { words, total } => {
                    self.counters.sentences = self.counters.sentences.saturating_add(1);
                    if let Some(words) = self.bytes.get(1..=words) {
                        message(Message::Sentence(words));
                    }
                    self.discard(total);
                }
                Front::Broken => {
                    self.counters.checksum_failures = self.counters.checksum_failures.saturating_add(1);
                    self.skip();
                }
                Front::Nothing => self.skip(),
                Front::Unfinished => return,
            }
        }
    }

    fn front(&self) -> Front {
        match self.bytes.first() {
            None => Front::Unfinished,
            Some(b'$') => sentence_at_front(&self.bytes),
            Some(_) if self.bytes.iter().zip(HEADER).all(|(byte, expected)| *byte == expected) => {
                let Some((frame, _)) = self.bytes.split_first_chunk::<FRAME_BYTES>() else {
                    return Front::Unfinished;
                };
                // The checksum behind what it covers leaves nothing.
                let covered = frame.get(1..).unwrap_or_default();
                if CHECKSUM.checksum(covered) == 0 { Front::Frame } else { Front::Broken }
            }
            Some(_) => Front::Nothing,
        }
    }

    /// Drops the first byte, and then everything that can begin nothing.
    fn skip(&mut self) {
        let next = self.bytes.iter().skip(1).position(|byte| matches!(*byte, b'$' | 0xFA));
        let count = next.map_or(self.bytes.len(), |position| position.saturating_add(1));
        self.counters.skipped =
            self.counters.skipped.saturating_add(u32::try_from(count).unwrap_or(u32::MAX));
        self.discard(count);
    }

    fn discard(&mut self, count: usize) {
        let count = count.min(self.bytes.len());
        self.bytes.rotate_left(count);
        self.bytes.truncate(self.bytes.len().saturating_sub(count));
    }
}

/// A sentence: `$`, words, `*`, checksum of two or four hexadecimal digits, line end. A byte that no text holds ends the search early:
/// frames behind a false `$` are not held up.
fn sentence_at_front(bytes: &[u8]) -> Front {
    let Some(end) = bytes.iter().position(|byte| !matches!(byte, b' '..=b'~')) else {
        return if bytes.len() < SENTENCE_MAX { Front::Unfinished } else { Front::Nothing };
    };
    let text = bytes.get(1..end).unwrap_or_default();
    match (bytes.get(end), bytes.get(end.saturating_add(1))) {
        (Some(b'\r'), None) if bytes.len() < SENTENCE_MAX => return Front::Unfinished,
        (Some(b'\r'), Some(b'\n')) => {}
        _ => return Front::Nothing,
    }
    let Some(star) = text.iter().rposition(|byte| *byte == b'*') else { return Front::Nothing };
    let (words, digits) = (text.get(..star).unwrap_or_default(), text.get(star..).unwrap_or_default());
    let is_right = match (digits.get(1..), hexadecimal(digits.get(1..).unwrap_or_default())) {
        (Some([_, _]), Some(sum)) => sum == u16::from(exclusive_or(words)),
        (Some([_, _, _, _]), Some(sum)) => sum == CHECKSUM.checksum(words),
        _ => false,
    };
    if is_right { Front::Sentence { words: star, total: end.saturating_add(2) } } else { Front::Broken }
}

/// A number in hexadecimal digits.
pub(super) fn hexadecimal(digits: &[u8]) -> Option<u16> {
    u16::from_str_radix(core::str::from_utf8(digits).ok()?, 16).ok()
}

fn exclusive_or(words: &[u8]) -> u8 {
    words.iter().fold(0, |sum, byte| sum ^ byte)
}

/// A sentence around at most 58 bytes of words; `None` for more. The robot sends nothing longer.
///
/// ```
/// use floorguard_drivers::vectornav::sentence;
///
/// assert_eq!(sentence(b"VNRRG,44").unwrap(), b"$VNRRG,44*73\r\n");
/// ```
#[must_use]
pub fn sentence(words: &[u8]) -> Option<Vec<u8, 64>> {
    let mut sentence = Vec::new();
    sentence.push(b'$').ok()?;
    sentence.extend_from_slice(words).ok()?;
    sentence.push(b'*').ok()?;
    let sum = exclusive_or(words);
    for digit in [sum >> 4, sum & 0xF] {
        let digit = core::char::from_digit(u32::from(digit), 16)?.to_ascii_uppercase();
        sentence.push(u8::try_from(digit).ok()?).ok()?;
    }
    sentence.extend_from_slice(b"\r\n").ok()?;
    Some(sentence)
}
