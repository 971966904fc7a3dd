//! The black box as bytes: what the MCU sends on request, and what `floorguard blackbox` reads.
//!
//! Each row is a postcard message, a CRC-32 behind it, the whole packed by COBS, and a zero. A zero stands nowhere else:
//! a reader finds the next row after any damage, and a cut costs the row that was cut and no other.

use crc::{CRC_32_ISO_HDLC, Crc};
use floorguard_guard::{Action, Cause, GuardState};
use floorguard_types::time::Stamp;
use serde::{Deserialize, Serialize};

use crate::shared::BoxEntry;

/// Version of the rows; a reader refuses another one.
pub const LOG_VERSION: u8 = 2;
/// Longest row with its zero.
pub const LOG_ROW_BYTES: usize = 40;

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// A moment without a cause.
const NO_CAUSE: u8 = u8::MAX;

/// What a row says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LogRow {
    /// A read-out begins: version of the rows, entries ever written to the ring.
    Begin(u8, u64),
    /// One moment.
    Moment(LogMoment),
    /// The read-out was complete: moments in it.
    End(u32),
    /// The machine died after the moments before this row, and began anew.
    Restart(LogRestart),
}

/// Why a machine was reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogRestart {
    /// See [`RestartCause`].
    pub cause: u8,
    /// Of a panic its line, of a fault the processor's status word, of an interrupt its number.
    pub detail: u32,
    /// How long it had lived, milliseconds.
    pub uptime_ms: u32,
    /// How often it has died since it was switched on.
    pub deaths: u32,
}

/// What a machine died of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum RestartCause {
    /// A promise of the program was broken.
    Panic = 1,
    /// A fault of the processor: bus, memory protection (stack overflow), instruction.
    Fault = 2,
    /// The guard did not decide in time.
    Watchdog = 3,
    /// An unexpected interrupt.
    Interrupt = 4,
}

impl RestartCause {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 4] = [Self::Panic, Self::Fault, Self::Watchdog, Self::Interrupt];

    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Panic => "panic: a promise of the program was broken",
            Self::Fault => "fault of the processor: bus, memory protection or instruction",
            Self::Watchdog => "watchdog: the guard did not decide in time",
            Self::Interrupt => "interrupt that nobody asked for",
        }
    }
}

impl LogRestart {
    /// What it died of; `None` for a number that this version does not know.
    #[must_use]
    pub fn known_cause(&self) -> Option<RestartCause> {
        RestartCause::ALL.into_iter().find(|cause| *cause as u8 == self.cause)
    }
}

/// A moment in small integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogMoment {
    /// Microseconds on the robot's clock.
    pub stamp_us: u64,
    state: u8,
    action: u8,
    cause: u8,
    holding: u8,
    permitted_mmps: i16,
    measured_mmps: i16,
    limit_mmps: i16,
    field_set: u8,
}

const STATES: [GuardState; 6] = [
    GuardState::Init,
    GuardState::Run,
    GuardState::Slow,
    GuardState::Stop,
    GuardState::Latched,
    GuardState::AwaitsStart,
];
const ACTIONS: [Action; 5] =
    [Action::None, Action::Limit, Action::Category2, Action::Category1, Action::Category0];

fn millimetres(metres: f32) -> i16 {
    // `as` saturates and makes NaN zero: both are outside of what the guard can say.
    libm::roundf(metres * 1_000.0) as i16
}

fn position<T: PartialEq>(list: &[T], wanted: &T) -> u8 {
    list.iter().position(|each| each == wanted).map_or(u8::MAX, |index| index as u8)
}

fn number(cause: Option<Cause>) -> u8 {
    cause.map_or(NO_CAUSE, |cause| cause.index() as u8)
}

/// The cause of a number, if there is one; the outer `None` for a number that stands for nothing.
fn known(number: u8) -> Option<Option<Cause>> {
    match number {
        NO_CAUSE => Some(None),
        index => Cause::all().get(usize::from(index)).copied().map(Some),
    }
}

impl LogMoment {
    /// Of an entry.
    #[must_use]
    pub fn new(stamp: Stamp, entry: &BoxEntry) -> Self {
        Self {
            stamp_us: stamp.as_micros(),
            state: position(&STATES, &entry.state),
            action: position(&ACTIONS, &entry.action),
            cause: number(entry.cause),
            holding: number(entry.holding),
            permitted_mmps: millimetres(entry.permitted_mps),
            measured_mmps: millimetres(entry.measured_mps),
            limit_mmps: millimetres(entry.limit_mps),
            field_set: entry.field_set,
        }
    }

    /// The entry again, to the millimetre. `None` when a number stands for nothing that this version knows.
    #[must_use]
    pub fn entry(&self) -> Option<(Stamp, BoxEntry)> {
        let (cause, holding) = (known(self.cause)?, known(self.holding)?);
        let metres = |millimetres: i16| f32::from(millimetres) / 1_000.0;
        let entry = BoxEntry {
            state: *STATES.get(usize::from(self.state))?,
            action: *ACTIONS.get(usize::from(self.action))?,
            cause,
            holding,
            permitted_mps: metres(self.permitted_mmps),
            measured_mps: metres(self.measured_mmps),
            limit_mps: metres(self.limit_mmps),
            field_set: self.field_set,
        };
        Some((Stamp::from_micros(self.stamp_us), entry))
    }
}

/// A row as bytes, ready for a serial line or a file.
#[must_use]
pub fn encode_row(row: &LogRow) -> heapless::Vec<u8, LOG_ROW_BYTES> {
    let mut plain = [0; LOG_ROW_BYTES];
    let mut packed = heapless::Vec::<u8, LOG_ROW_BYTES>::new();
    let _ = packed.resize(LOG_ROW_BYTES, 0);
    // The largest row has 28 bytes with its checksum; COBS adds one, the zero another.
    let length = match postcard::to_slice_crc32(row, &mut plain, CRC.digest()) {
        Ok(bytes) => cobs::try_encode(bytes, &mut packed).unwrap_or(0),
        Err(_) => 0,
    };
    packed.truncate(length);
    let _ = packed.push(0);
    packed
}

/// A row from the bytes between two zeros, in place. `None`: damaged.
pub fn decode_row(packed: &mut [u8]) -> Option<LogRow> {
    let length = cobs::decode_in_place(packed).ok()?;
    postcard::from_bytes_crc32(packed.get(..length)?, CRC.digest()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(stamp_us: u64, cause: Option<Cause>) -> LogRow {
        let entry = BoxEntry {
            state: GuardState::Latched,
            action: Action::Category0,
            cause,
            holding: cause,
            permitted_mps: -0.123,
            measured_mps: 1.0,
            limit_mps: 0.3,
            field_set: 7,
        };
        LogRow::Moment(LogMoment::new(Stamp::from_micros(stamp_us), &entry))
    }

    #[test]
    fn rows_round_trip_without_inner_zeros() {
        let causes = Cause::all().into_iter().map(Some).chain([None]);
        let moments = causes.flat_map(|cause| [moment(0, cause), moment(u64::MAX, cause)]);
        let restart = LogRestart { cause: 3, detail: u32::MAX, uptime_ms: u32::MAX, deaths: u32::MAX };
        let others = [LogRow::Begin(LOG_VERSION, u64::MAX), LogRow::End(u32::MAX), LogRow::Restart(restart)];
        for row in moments.chain(others) {
            let bytes = encode_row(&row);
            let (end, inside) = bytes.split_last().unwrap();
            assert!(*end == 0 && !inside.contains(&0) && !inside.is_empty(), "{row:?}");
            assert_eq!(decode_row(&mut std::vec::Vec::from(inside)), Some(row));
        }
    }

    #[test]
    fn flipped_or_cut_rows_are_rejected() {
        let bytes = encode_row(&moment(123_456_789, Some(Cause::EmergencyStop)));
        let inside = &bytes[..bytes.len() - 1];
        for bit in 0..inside.len() * 8 {
            let mut damaged = std::vec::Vec::from(inside);
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(decode_row(&mut damaged), None, "bit {bit}");
        }
        for cut in 0..inside.len() {
            assert_eq!(decode_row(&mut std::vec::Vec::from(&inside[..cut])), None, "cut at {cut}");
        }
    }

    #[test]
    fn entries_come_back_to_the_millimetre() {
        let LogRow::Moment(moment) = moment(5, Some(Cause::BumperRear)) else { panic!() };
        let (stamp, entry) = moment.entry().unwrap();
        assert_eq!(
            (stamp, entry.state, entry.cause),
            (Stamp::from_micros(5), GuardState::Latched, Some(Cause::BumperRear))
        );
        assert!((entry.permitted_mps + 0.123).abs() < 1e-6 && entry.field_set == 7);
        for unknown in [LogMoment { cause: 200, ..moment }, LogMoment { holding: 200, ..moment }] {
            assert_eq!(unknown.entry(), None);
        }
    }
}
