//! Both kinds of lines, both ways.
//!
//! `W sequence deadline_ms follow speed…*CRC` goes to the controller, `M sequence heard age_ms state speed count…*CRC` comes back, with a
//! speed, or a speed and a count, for each wheel.

use core::fmt::Write;

use crc::{CRC_16_IBM_3740, Crc, Table};
use heapless::{String, Vec};

use crate::text_lines::{LINE_BYTES_MAX, whole};

/// Wheels at most.
pub const LINE_WHEELS_MAX: usize = 4;

static CHECKSUM: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_3740);

/// One wheel's value each, left to right and front to rear.
pub type WheelValues<T> = Vec<T, LINE_WHEELS_MAX>;

/// Why a line is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelLineError {
    /// It ends with no checksum, or with another one.
    Checksum,
    /// It is none of these lines.
    Kind,
    /// A word is no number of its range, or there are too few or too many.
    Words,
}

/// What the wheels are to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WheelRequest {
    /// One more with each request, wrapping. An old one is not obeyed.
    pub sequence: u32,
    /// How long it holds after its arrival, milliseconds.
    pub deadline_ms: u16,
    /// Torque is on, and the wheels follow; else it is off.
    pub follow: bool,
    /// Speeds of the rims over ground, mm/s.
    pub speeds_mmps: WheelValues<i32>,
}

/// What a controller does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelState {
    /// No torque, as commanded.
    Off,
    /// Follows the newest request.
    Follows,
    /// The deadline has passed: it stops, or has stopped, by itself.
    Expired,
    /// It cannot.
    Fault,
}

/// A wheel as measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WheelValue {
    /// Speed of the rim over ground, mm/s.
    pub speed_mmps: i32,
    /// Of its encoder, wrapping.
    pub count: i32,
}

/// What the controller measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WheelReport {
    /// One more with each report, wrapping.
    pub sequence: u32,
    /// Sequence of the newest request that was taken.
    pub heard: u32,
    /// Time from the measurement to the sending, milliseconds.
    pub age_ms: u16,
    /// What it does.
    pub state: WheelState,
    /// The wheels.
    pub wheels: WheelValues<WheelValue>,
}

type Text = String<LINE_BYTES_MAX>;

/// Checksum and end behind what is written; a line that does not fit is empty.
fn closed(mut text: Text, is_whole: bool) -> Text {
    let checksum = CHECKSUM.checksum(text.as_bytes());
    if !is_whole || writeln!(text, "*{checksum:04X}").is_err() {
        text.clear();
    }
    text
}

/// The words of a line whose checksum is right.
fn opened(line: &[u8]) -> Result<impl Iterator<Item = &[u8]>, WheelLineError> {
    let end = line.len().checked_sub(5).ok_or(WheelLineError::Checksum)?;
    let (text, sum) = line.split_at_checked(end).ok_or(WheelLineError::Checksum)?;
    let given = sum
        .strip_prefix(b"*")
        .filter(|digits| digits.iter().all(|digit| matches!(digit, b'0'..=b'9' | b'A'..=b'F')))
        .and_then(|digits| core::str::from_utf8(digits).ok())
        .and_then(|digits| u16::from_str_radix(digits, 16).ok());
    if given != Some(CHECKSUM.checksum(text)) {
        return Err(WheelLineError::Checksum);
    }
    Ok(text.split(|byte| *byte == b' '))
}

fn word<'a, T: core::str::FromStr>(words: &mut impl Iterator<Item = &'a [u8]>) -> Result<T, WheelLineError> {
    words.next().and_then(whole).ok_or(WheelLineError::Words)
}

fn kind<'a>(words: &mut impl Iterator<Item = &'a [u8]>, letter: &[u8]) -> Result<(), WheelLineError> {
    if words.next() == Some(letter) { Ok(()) } else { Err(WheelLineError::Kind) }
}

impl WheelRequest {
    /// The line, with its end.
    ///
    /// ```
    /// use floorguard_drivers::wheel_line::WheelRequest;
    ///
    /// let speeds_mmps = [250, -250].into_iter().collect();
    /// let request = WheelRequest { sequence: 7, deadline_ms: 100, follow: true, speeds_mmps };
    /// let line = request.encode();
    /// assert_eq!(line, "W 7 100 1 250 -250*3AF2\n");
    /// assert_eq!(WheelRequest::decode(line.trim_end().as_bytes()), Ok(request));
    /// ```
    #[must_use]
    pub fn encode(&self) -> Text {
        let mut text = Text::new();
        let mut is_whole =
            write!(text, "W {} {} {}", self.sequence, self.deadline_ms, u8::from(self.follow)).is_ok();
        for speed in &self.speeds_mmps {
            is_whole &= write!(text, " {speed}").is_ok();
        }
        closed(text, is_whole)
    }

    /// Decodes a line without its end.
    ///
    /// # Errors
    /// It is damaged, or none.
    pub fn decode(line: &[u8]) -> Result<Self, WheelLineError> {
        let mut words = opened(line)?;
        let words = &mut words;
        kind(words, b"W")?;
        let (sequence, deadline_ms) = (word(words)?, word(words)?);
        let follow = match word::<u8>(words)? {
            0 => false,
            1 => true,
            _ => return Err(WheelLineError::Words),
        };
        let mut speeds_mmps = WheelValues::new();
        for text in words.take(LINE_BYTES_MAX) {
            let speed = whole(text).ok_or(WheelLineError::Words)?;
            speeds_mmps.push(speed).map_err(|_| WheelLineError::Words)?;
        }
        if speeds_mmps.is_empty() {
            return Err(WheelLineError::Words);
        }
        Ok(Self { sequence, deadline_ms, follow, speeds_mmps })
    }
}

impl WheelReport {
    /// The line, with its end.
    #[must_use]
    pub fn encode(&self) -> Text {
        let mut text = Text::new();
        let state = match self.state {
            WheelState::Off => 0,
            WheelState::Follows => 1,
            WheelState::Expired => 2,
            WheelState::Fault => 3,
        };
        let head = write!(text, "M {} {} {} {state}", self.sequence, self.heard, self.age_ms);
        let mut is_whole = head.is_ok();
        for wheel in &self.wheels {
            is_whole &= write!(text, " {} {}", wheel.speed_mmps, wheel.count).is_ok();
        }
        closed(text, is_whole)
    }

    /// Decodes a line without its end.
    ///
    /// # Errors
    /// It is damaged, or none.
    pub fn decode(line: &[u8]) -> Result<Self, WheelLineError> {
        let mut words = opened(line)?;
        let words = &mut words;
        kind(words, b"M")?;
        let (sequence, heard, age_ms) = (word(words)?, word(words)?, word(words)?);
        let state = match word::<u8>(words)? {
            0 => WheelState::Off,
            1 => WheelState::Follows,
            2 => WheelState::Expired,
            3 => WheelState::Fault,
            _ => return Err(WheelLineError::Words),
        };
        let mut wheels = WheelValues::new();
        for _ in 0..=LINE_WHEELS_MAX {
            let Some(text) = words.next() else { break };
            let speed_mmps = whole(text).ok_or(WheelLineError::Words)?;
            let value = WheelValue { speed_mmps, count: word(words)? };
            wheels.push(value).map_err(|_| WheelLineError::Words)?;
        }
        if wheels.is_empty() {
            return Err(WheelLineError::Words);
        }
        Ok(Self { sequence, heard, age_ms, state, wheels })
    }
}
