//! Finds telegrams in a stream of bytes: text between a start and an end byte (CoLa A), or binary with a length and a checksum (CoLa B).

use heapless::Vec;

use super::telegram::TELEGRAM_BYTES;

const START: u8 = 0x02;
const END: u8 = 0x03;
/// Start bytes of a binary telegram.
const STARTS: u8 = 4;
/// Bytes of its length.
const LENGTH_BYTES: usize = 4;

/// A telegram without its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame<'a> {
    /// CoLa A: words of text.
    Text(&'a [u8]),
    /// CoLa B, and its checksum is right.
    Binary(&'a [u8]),
    /// A telegram that is too long, or whose checksum is wrong: nothing of it is used.
    Refused,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    /// What stands between two telegrams is nothing.
    #[default]
    Outside,
    /// So many start bytes have come, and nothing else.
    Started(u8),
    Text,
    Length,
    /// So many bytes are to come, then the checksum.
    Binary(usize),
}

/// One stream.
///
/// ```
/// use floorguard_drivers::cola::{Frame, Framer};
///
/// let mut framer = Framer::default();
/// let mut found = 0;
/// for byte in b"\x02sRA one\x03\x02\x02\x02\x02\0\0\0\x02ab\x03" {
///     match framer.byte(*byte) {
///         Some(Frame::Text(text)) => found += usize::from(text == b"sRA one"),
///         Some(Frame::Binary(bytes)) => found += usize::from(bytes == b"ab"),
///         _ => {}
///     }
/// }
/// assert_eq!(found, 2);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Framer {
    state: State,
    bytes: Vec<u8, TELEGRAM_BYTES>,
}

impl Framer {
    /// Takes a byte; gives the telegram that it ends.
    pub fn byte(&mut self, byte: u8) -> Option<Frame<'_>> {
        match self.state {
            State::Outside | State::Text if byte == START => self.begin(State::Started(1)),
            State::Outside => {}
            State::Started(count) if byte == START => {
                let is_binary = count.saturating_add(1) >= STARTS;
                self.state = if is_binary { State::Length } else { State::Started(count.saturating_add(1)) };
            }
            State::Started(_) | State::Text if byte == END => {
                self.state = State::Outside;
                return Some(Frame::Text(&self.bytes));
            }
            State::Started(_) | State::Text => {
                self.state = State::Text;
                return self.keep(byte);
            }
            State::Length => return self.length(byte),
            State::Binary(0) => return Some(self.checked(byte)),
            State::Binary(left) => {
                self.state = State::Binary(left.saturating_sub(1));
                return self.keep(byte);
            }
        }
        None
    }

    fn begin(&mut self, state: State) {
        self.state = state;
        self.bytes.clear();
    }

    fn keep(&mut self, byte: u8) -> Option<Frame<'_>> {
        self.bytes.push(byte).is_err().then(|| self.refuse())
    }

    fn refuse(&mut self) -> Frame<'_> {
        self.begin(State::Outside);
        Frame::Refused
    }

    fn length(&mut self, byte: u8) -> Option<Frame<'_>> {
        // Never full: it is empty before the length.
        let _full = self.bytes.push(byte);
        let bytes = <[u8; LENGTH_BYTES]>::try_from(self.bytes.as_slice()).ok()?;
        match usize::try_from(u32::from_be_bytes(bytes)) {
            Ok(length) if (1..=TELEGRAM_BYTES).contains(&length) => {
                self.begin(State::Binary(length));
                None
            }
            _ => Some(self.refuse()),
        }
    }

    fn checked(&mut self, checksum: u8) -> Frame<'_> {
        if self.bytes.iter().fold(0, |sum, byte| sum ^ byte) != checksum {
            return self.refuse();
        }
        self.state = State::Outside;
        Frame::Binary(&self.bytes)
    }
}
