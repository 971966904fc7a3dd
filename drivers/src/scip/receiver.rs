//! From a stream of bytes to replies, line by line (SCIP 2.0, section 7).
//!
//! A reply is an echo of the command, a status, lines with a check character each, and an empty line. Whatever is damaged
//! refuses the whole reply, and the next empty line ends it.

use floorguard_types::number::truncating_u32;
use floorguard_types::time::{Age, Stamp};
use heapless::Vec;

use super::command::{RangeKind, ScanRange};
use super::encoding::{checked, decimal, decode_number, six_bits};
use super::parameters::SensorParameters;
use super::scan::RawScan;

/// The longest line: a maker's name and address. Lines of data have 65 bytes.
const LINE_BYTES: usize = 160;
/// A reply without a byte for so long has been broken off.
const SILENCE_US: u64 = 500_000;

/// What a status means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Status {
    /// 00.
    Accepted,
    /// 99: data of a scan.
    Data,
    /// 98: it measures again after an interruption.
    Resumed,
    /// 10: the laser is off.
    LaserOff,
    /// 21 to 49: it has stopped to look for an error.
    Interrupted(u8),
    /// 50 to 97: laser, motor or another part does not work.
    Trouble(u8),
    /// The command is refused: its parameters, or it is not known.
    Refused([u8; 2]),
}

impl Status {
    fn of(code: [u8; 2]) -> Self {
        match (&code, decimal(&code).and_then(|number| u8::try_from(number).ok())) {
            (b"00", _) => Self::Accepted,
            (b"99", _) => Self::Data,
            (b"98", _) => Self::Resumed,
            (b"10", _) => Self::LaserOff,
            (_, Some(number @ 21..=49)) => Self::Interrupted(number),
            (_, Some(number @ 50..=97)) => Self::Trouble(number),
            _ => Self::Refused(code),
        }
    }
}

/// Why a reply is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RefusedReply {
    /// A line's check character is wrong.
    CheckCharacter,
    /// A character that the encoding has not.
    Character,
    /// Other values than its echo promises.
    Values {
        /// So many were found.
        found: usize,
        /// So many were promised.
        expected: usize,
    },
    /// No echo, no status or no time where there must be one.
    Form,
    /// A line, or a scan, that is longer than there may be.
    TooLong,
    /// It ended in the middle.
    BrokenOff,
}

/// What the sensor sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reply<'a> {
    /// A scan.
    Scan(&'a RawScan),
    /// A status without data; the first two letters of the command.
    Status {
        /// `MD`, `QT`…; `SC` for `SCIP2.0`.
        command: [u8; 2],
        /// What it says.
        status: Status,
    },
    /// The answer to `PP`.
    Parameters(SensorParameters),
    /// The answer to `TM1`: the sensor's counter of 24 bits, milliseconds.
    Time(u32),
    /// A reply that is damaged: nothing of it is given.
    Refused(RefusedReply),
}

/// What happened so far. Totals that saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReceiverCounters {
    /// Bytes taken.
    pub bytes: u32,
    /// Scans given.
    pub scans: u32,
    /// Replies that were refused.
    pub refused: u32,
    /// Of them with a wrong check character.
    pub check_characters: u32,
}

impl ReceiverCounters {
    fn count(&mut self, refused: RefusedReply) {
        self.refused = self.refused.saturating_add(1);
        let is_sum = u32::from(refused == RefusedReply::CheckCharacter);
        self.check_characters = self.check_characters.saturating_add(is_sum);
    }
}

/// What the echo promises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Echo {
    Scans,
    Parameters,
    Time,
    Other([u8; 2]),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Expects {
    Echo,
    Status,
    Stamp,
    Data,
    /// `KEY:value` lines.
    Lines,
    /// The empty line.
    End,
    /// The empty line, then the refusal is given.
    EndOfRefused(RefusedReply),
}

/// Takes bytes in any portions. Its size is that of a scan, 12 kB.
#[derive(Clone, Debug)]
pub struct Receiver {
    line: Vec<u8, LINE_BYTES>,
    is_line_too_long: bool,
    expects: Expects,
    echo: Echo,
    status: Status,
    scan: RawScan,
    parameters: SensorParameters,
    /// A value whose characters have come in part: its bits, and how many characters.
    partial: (u32, u8),
    values: usize,
    last_byte: Stamp,
    counters: ReceiverCounters,
}

impl Default for Receiver {
    fn default() -> Self {
        Self::new()
    }
}

impl Receiver {
    /// At the beginning of a reply.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            line: Vec::new(),
            is_line_too_long: false,
            expects: Expects::Echo,
            echo: Echo::Other([0; 2]),
            status: Status::Accepted,
            scan: RawScan::EMPTY,
            parameters: SensorParameters::NONE,
            partial: (0, 0),
            values: 0,
            last_byte: Stamp::ZERO,
            counters: ReceiverCounters { bytes: 0, scans: 0, refused: 0, check_characters: 0 },
        }
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> ReceiverCounters {
        self.counters
    }

    /// Takes bytes that arrived at a time; `event` is called for each reply that they complete. Cost: some ten operations a
    /// byte.
    pub fn push(&mut self, bytes: &[u8], now: Stamp, mut event: impl FnMut(Reply<'_>)) {
        let is_silent = matches!(self.last_byte.age(now), Age::Past(us) if us > SILENCE_US);
        if is_silent && (self.expects != Expects::Echo || !self.line.is_empty()) {
            self.restart();
            self.counters.count(RefusedReply::BrokenOff);
            event(Reply::Refused(RefusedReply::BrokenOff));
        }
        self.counters.bytes = self.counters.bytes.saturating_add(truncating_u32(bytes.len()));
        for byte in bytes {
            if *byte == b'\n' {
                self.end_line(&mut event);
            } else if self.line.push(*byte).is_err() {
                self.is_line_too_long = true;
            }
        }
        self.last_byte = now;
    }

    fn restart(&mut self) {
        self.line.clear();
        self.is_line_too_long = false;
        self.expects = Expects::Echo;
    }

    fn end_line(&mut self, event: &mut impl FnMut(Reply<'_>)) {
        if self.line.is_empty() {
            self.end_reply(event);
            return;
        }
        if self.is_line_too_long {
            self.refuse(RefusedReply::TooLong);
        } else if let Err(refused) = self.take_line() {
            self.refuse(refused);
        }
        self.line.clear();
        self.is_line_too_long = false;
    }

    fn refuse(&mut self, refused: RefusedReply) {
        // The first reason counts.
        if !matches!(self.expects, Expects::EndOfRefused(_)) {
            self.expects = Expects::EndOfRefused(refused);
        }
    }

    fn take_line(&mut self) -> Result<(), RefusedReply> {
        self.expects = match self.expects {
            Expects::Echo => self.take_echo(),
            Expects::Status => self.take_status()?,
            Expects::Stamp => {
                self.scan.sensor_ms = self.number()?;
                if self.echo == Echo::Time { Expects::End } else { Expects::Data }
            }
            Expects::Data => self.take_data()?,
            Expects::Lines => self.take_parameter()?,
            Expects::End => return Err(RefusedReply::Form),
            refused @ Expects::EndOfRefused(_) => refused,
        };
        Ok(())
    }

    fn take_echo(&mut self) -> Expects {
        (self.partial, self.values) = ((0, 0), 0);
        self.scan.distances_mm.clear();
        self.scan.strengths.clear();
        self.parameters = SensorParameters::NONE;
        let line = self.line.as_slice();
        self.echo = match line {
            b"PP" => Echo::Parameters,
            [b'T', b'M', b'1', ..] => Echo::Time,
            [first, second, ..] => Echo::Other([*first, *second]),
            [..] => Echo::Other([0; 2]),
        };
        if let Some(ScanEcho { kind, range, remaining }) = ScanEcho::of(line) {
            (self.scan.kind, self.scan.range, self.scan.remaining) = (kind, range, remaining);
            self.echo = Echo::Scans;
        }
        Expects::Status
    }

    fn take_status(&mut self) -> Result<Expects, RefusedReply> {
        let content = checked(&self.line).ok_or(RefusedReply::CheckCharacter)?;
        let code = <[u8; 2]>::try_from(content).map_err(|_| RefusedReply::Form)?;
        self.status = Status::of(code);
        // The newest scan is sent with status 00, scans from now on with 99.
        let is_scan = match self.scan.remaining {
            None => self.status == Status::Accepted,
            Some(_) => self.status == Status::Data,
        };
        Ok(match self.echo {
            Echo::Scans if is_scan => Expects::Stamp,
            Echo::Time if self.status == Status::Accepted => Expects::Stamp,
            Echo::Parameters if self.status == Status::Accepted => Expects::Lines,
            Echo::Scans | Echo::Time | Echo::Parameters => Expects::End,
            // Lines of text that are not read, as of VV and II.
            Echo::Other(_) => Expects::Lines,
        })
    }

    fn number(&self) -> Result<u32, RefusedReply> {
        let content = checked(&self.line).ok_or(RefusedReply::CheckCharacter)?;
        if content.len() != 4 {
            return Err(RefusedReply::Form);
        }
        decode_number(content).ok_or(RefusedReply::Character)
    }

    fn take_data(&mut self) -> Result<Expects, RefusedReply> {
        let content = checked(&self.line).ok_or(RefusedReply::CheckCharacter)?;
        let characters = self.scan.kind.characters();
        for character in content.iter().take(LINE_BYTES) {
            let bits = six_bits(*character).ok_or(RefusedReply::Character)?;
            let (number, count) = (self.partial.0 << 6 | bits, self.partial.1.saturating_add(1));
            if count < characters {
                self.partial = (number, count);
                continue;
            }
            let is_strength = self.scan.kind == RangeKind::Strength && self.values % 2 == 1;
            let list = if is_strength { &mut self.scan.strengths } else { &mut self.scan.distances_mm };
            list.push(number).map_err(|_| RefusedReply::TooLong)?;
            (self.partial, self.values) = ((0, 0), self.values.saturating_add(1));
        }
        Ok(Expects::Data)
    }

    fn take_parameter(&mut self) -> Result<Expects, RefusedReply> {
        // The semicolon before the check character is not in the sum.
        if self.echo == Echo::Parameters {
            let (sum, line) = self.line.split_last().ok_or(RefusedReply::Form)?;
            let line = line.strip_suffix(b";").ok_or(RefusedReply::Form)?;
            if super::check_character(line) != *sum {
                return Err(RefusedReply::CheckCharacter);
            }
            self.parameters.take(line);
        }
        Ok(Expects::Lines)
    }

    /// An empty line.
    fn end_reply(&mut self, event: &mut impl FnMut(Reply<'_>)) {
        let expects = core::mem::replace(&mut self.expects, Expects::Echo);
        let letters = match self.echo {
            Echo::Scans => [if self.scan.remaining.is_some() { b'M' } else { b'G' }, self.scan.kind.letter()],
            Echo::Parameters => *b"PP",
            Echo::Time => *b"TM",
            Echo::Other(letters) => letters,
        };
        let reply = match (expects, self.echo) {
            // An empty line between replies.
            (Expects::Echo, _) => return,
            (Expects::EndOfRefused(refused), _) => Reply::Refused(refused),
            (Expects::Status | Expects::Stamp, _) => Reply::Refused(RefusedReply::Form),
            (Expects::Data, _) => match self.whole_scan() {
                Ok(()) => Reply::Scan(&self.scan),
                Err(refused) => Reply::Refused(refused),
            },
            (Expects::Lines, Echo::Parameters) => Reply::Parameters(self.parameters),
            (Expects::End, Echo::Time) if self.status == Status::Accepted => Reply::Time(self.scan.sensor_ms),
            (Expects::Lines | Expects::End, _) => Reply::Status { command: letters, status: self.status },
        };
        match reply {
            Reply::Scan(_) => self.counters.scans = self.counters.scans.saturating_add(1),
            Reply::Refused(refused) => self.counters.count(refused),
            _ => {}
        }
        event(reply);
    }

    fn whole_scan(&self) -> Result<(), RefusedReply> {
        let expected = self.scan.range.values();
        let found = self.scan.distances_mm.len();
        let has_strengths = self.scan.kind != RangeKind::Strength || self.scan.strengths.len() == expected;
        if found == expected && has_strengths && self.partial.1 == 0 {
            Ok(())
        } else {
            Err(RefusedReply::Values { found, expected })
        }
    }
}

/// The echo of a command for scans.
struct ScanEcho {
    kind: RangeKind,
    range: ScanRange,
    remaining: Option<u8>,
}

impl ScanEcho {
    /// `None` for other commands, and where digits are missing.
    fn of(line: &[u8]) -> Option<Self> {
        let (&[command, letter], numbers) = line.split_first_chunk::<2>()?;
        let kind = RangeKind::of_letter(letter)?;
        let (steps, rest) = numbers.split_first_chunk::<10>()?;
        let number = |digits: Option<&[u8]>| decimal(digits?);
        let range = ScanRange {
            first_step: u16::try_from(number(steps.get(..4))?).ok()?,
            last_step: u16::try_from(number(steps.get(4..8))?).ok()?,
            cluster: u8::try_from(number(steps.get(8..))?).ok()?,
        };
        let remaining = match command {
            b'G' => None,
            b'M' => Some(u8::try_from(number(rest.get(1..3))?).ok()?),
            _ => return None,
        };
        (range.first_step <= range.last_step).then_some(Self { kind, range, remaining })
    }
}
