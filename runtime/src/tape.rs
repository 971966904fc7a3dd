//! A tape: every byte that reached the robot, with the moment at which it did.
//!
//! The simulator's run on the host writes one; the firmware on the emulated board plays it, without the simulator, on
//! the same virtual clock. Equal input then must give equal output, bit for bit.
//!
//! Layout, little-endian: magic, `u64` duration in µs, then records of `u64` moment of delivery, `u64` moment of
//! arrival, `u16` line, `u16` length, the bytes, and zeros up to a multiple of 4. The first record with line 0xFFFF
//! ends it.

use floorguard_drivers::can::CanFrame;
use floorguard_types::geometry::Point2;

use crate::mission::{ROUTE_WAYPOINTS_MAX, Route, RouteLimits};

/// First bytes of a tape.
pub const TAPE_MAGIC: &[u8; 8] = b"FGTAPE02";
/// Line number of the record that ends a tape.
pub const TAPE_END: u16 = u16::MAX;
/// Magic and duration.
pub const TAPE_HEADER_BYTES: usize = 16;
/// In front of the bytes of a record.
pub const TAPE_RECORD_BYTES: usize = 20;

/// Marks an identifier of 29 bits, of which fifteen are kept: no device of ours uses more.
const EXTENDED: u16 = 0x8000;

/// Identifier of a frame as tapes and recordings hold it; none for one that they cannot hold.
#[must_use]
pub fn frame_identifier(frame: &CanFrame) -> Option<u16> {
    let extended = || u16::try_from(frame.extended_id()?).ok().filter(|id| *id < EXTENDED);
    frame.standard_id().or_else(|| extended().map(|id| id | EXTENDED))
}

/// The frame of an identifier that a tape or a recording holds.
#[must_use]
pub fn frame_of(identifier: u16, payload: &[u8]) -> CanFrame {
    let extended =
        || CanFrame::extended(u32::from(identifier & !EXTENDED), payload.get(..8).unwrap_or(payload));
    let is_extended = identifier & EXTENDED != 0;
    is_extended.then(extended).flatten().unwrap_or_else(|| CanFrame::standard(identifier, payload))
}

/// Where a record belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapeLine {
    /// A lidar datagram.
    Lidar,
    /// Bytes of the safety scanner.
    Scanner,
    /// Bytes of the inertial sensor.
    Imu,
    /// A CAN frame: identifier in two bytes, then the data.
    Can,
    /// The operator pressed reset.
    Reset,
    /// What the mission drives: the first record of a tape, see [`decode_route`].
    Route,
    /// The operator pressed pause.
    Pause,
    /// The operator pressed resume.
    Resume,
    /// The operator gave the start command.
    Start,
    /// Bytes of the second safety scanner.
    RearScanner,
    /// An operator's order to the mission, as text.
    MissionOrder,
}

impl TapeLine {
    /// Number in the record.
    #[must_use]
    pub const fn number(self) -> u16 {
        match self {
            Self::Lidar => 1,
            Self::Scanner => 2,
            Self::Imu => 3,
            Self::Can => 4,
            Self::Reset => 5,
            Self::Route => 6,
            Self::Pause => 7,
            Self::Resume => 8,
            Self::Start => 9,
            Self::RearScanner => 10,
            Self::MissionOrder => 11,
        }
    }

    /// The line of a number.
    #[must_use]
    pub const fn from_number(number: u16) -> Option<Self> {
        match number {
            1 => Some(Self::Lidar),
            2 => Some(Self::Scanner),
            3 => Some(Self::Imu),
            4 => Some(Self::Can),
            5 => Some(Self::Reset),
            6 => Some(Self::Route),
            7 => Some(Self::Pause),
            8 => Some(Self::Resume),
            9 => Some(Self::Start),
            10 => Some(Self::RearScanner),
            11 => Some(Self::MissionOrder),
            _ => None,
        }
    }
}

/// One delivery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TapeRecord<'a> {
    /// When the tasks get it, µs.
    pub deliver_us: u64,
    /// When it arrived, µs.
    pub arrival_us: u64,
    /// Where.
    pub line: TapeLine,
    /// What.
    pub data: &'a [u8],
}

/// Reads a tape.
#[derive(Clone, Copy, Debug)]
pub struct TapeReader<'a> {
    duration_us: u64,
    rest: &'a [u8],
}

impl<'a> TapeReader<'a> {
    /// `None` when the bytes are no tape of this version.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let (magic, rest) = bytes.split_first_chunk::<8>()?;
        let (duration, rest) = rest.split_first_chunk::<8>()?;
        (magic == TAPE_MAGIC).then(|| Self { duration_us: u64::from_le_bytes(*duration), rest })
    }

    /// How long the run lasts, µs.
    #[must_use]
    pub const fn duration_us(&self) -> u64 {
        self.duration_us
    }

    fn take(&mut self) -> Option<TapeRecord<'a>> {
        let (deliver, rest) = self.rest.split_first_chunk::<8>()?;
        let (arrival, rest) = rest.split_first_chunk::<8>()?;
        let (line, rest) = rest.split_first_chunk::<2>()?;
        let (length, rest) = rest.split_first_chunk::<2>()?;
        let length = usize::from(u16::from_le_bytes(*length));
        let padded = length.next_multiple_of(4);
        let line = TapeLine::from_number(u16::from_le_bytes(*line))?;
        let (data, _) = rest.split_at_checked(length)?;
        self.rest = rest.get(padded..)?;
        let (deliver_us, arrival_us) = (u64::from_le_bytes(*deliver), u64::from_le_bytes(*arrival));
        Some(TapeRecord { deliver_us, arrival_us, line, data })
    }
}

impl<'a> Iterator for TapeReader<'a> {
    type Item = TapeRecord<'a>;

    /// Ends at the end mark, and at anything that is no record.
    fn next(&mut self) -> Option<TapeRecord<'a>> {
        let record = self.take();
        if record.is_none() {
            self.rest = &[];
        }
        record
    }
}

/// A route and its limits: speed, turning rate, look-ahead, reach and repeat (0 or 1), then x and y of each waypoint, all
/// `f32`. `None` when the numbers are too few.
#[must_use]
pub fn decode_route(data: &[u8]) -> Option<(Route, RouteLimits)> {
    let (numbers, _) = data.as_chunks::<4>();
    let mut numbers = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes));
    let limits = RouteLimits {
        speed_mps: numbers.next()?,
        turn_radps: numbers.next()?,
        look_ahead_m: numbers.next()?,
        reached_m: numbers.next()?,
    };
    let mut route = Route { repeat: numbers.next()? > 0.5, ..Route::default() };
    for _ in 0..ROUTE_WAYPOINTS_MAX {
        let (Some(x_m), Some(y_m)) = (numbers.next(), numbers.next()) else { break };
        // The loop ends with the capacity.
        let _ = route.waypoints.push(Point2::new(x_m, y_m));
    }
    Some((route, limits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn record(line: u16, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        bytes.extend(7_u64.to_le_bytes());
        bytes.extend(5_u64.to_le_bytes());
        bytes.extend(line.to_le_bytes());
        bytes.extend((data.len() as u16).to_le_bytes());
        bytes.extend(data);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    }

    #[test]
    fn records_come_back_until_the_end_mark() {
        let mut bytes = TAPE_MAGIC.to_vec();
        bytes.extend(99_u64.to_le_bytes());
        bytes.extend(record(4, &[1, 2, 3]));
        bytes.extend(record(5, &[]));
        bytes.extend(record(TAPE_END, &[]));
        bytes.extend(record(4, &[9]));
        let reader = TapeReader::new(&bytes).unwrap();
        assert_eq!(reader.duration_us(), 99);
        let records: Vec<_> = reader.collect();
        assert_eq!(records.len(), 2);
        assert_eq!((records[0].line, records[0].data), (TapeLine::Can, [1, 2, 3].as_slice()));
        assert_eq!((records[1].deliver_us, records[1].arrival_us), (7, 5));
        for cut in 0..bytes.len() {
            let _ = TapeReader::new(&bytes[..cut]).map(Iterator::count);
        }
    }
}
