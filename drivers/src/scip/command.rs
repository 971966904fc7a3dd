//! What the host asks for.

use heapless::Vec;

/// Bytes of the longest command.
pub const COMMAND_BYTES: usize = 16;

/// What is measured at each step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RangeKind {
    /// Distance in three characters: `MD`, `GD`.
    #[default]
    Distance,
    /// Distance in two characters, up to 4,095 mm: `MS`, `GS`.
    ShortDistance,
    /// Distance and strength, three characters each: `ME`, `GE`. Not with a URG-04LX.
    Strength,
}

impl RangeKind {
    /// Characters of a value.
    #[must_use]
    pub const fn characters(self) -> u8 {
        match self {
            Self::Distance | Self::Strength => 3,
            Self::ShortDistance => 2,
        }
    }

    pub(super) const fn letter(self) -> u8 {
        match self {
            Self::Distance => b'D',
            Self::ShortDistance => b'S',
            Self::Strength => b'E',
        }
    }

    pub(super) const fn of_letter(letter: u8) -> Option<Self> {
        match letter {
            b'D' => Some(Self::Distance),
            b'S' => Some(Self::ShortDistance),
            b'E' => Some(Self::Strength),
            _ => None,
        }
    }
}

/// Steps of a scan. Steps run counter-clockwise as seen from above the sensor, 0 first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScanRange {
    /// 0…9,999.
    pub first_step: u16,
    /// The last one, not before the first.
    pub last_step: u16,
    /// Neighbouring steps that become one value, the nearest of them; 0 and 1: none. At most 99.
    pub cluster: u8,
}

impl ScanRange {
    /// Values of a scan.
    #[must_use]
    pub fn values(self) -> usize {
        let steps = usize::from(self.last_step.saturating_sub(self.first_step)).saturating_add(1);
        steps.div_ceil(usize::from(self.cluster.max(1)))
    }
}

/// A command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// Speak SCIP 2.0: a URG-04LX may begin with SCIP 1.1.
    UseScip2,
    /// Ranges, steps and speed of the sensor: `PP`.
    Parameters,
    /// Maker, product, serial number: `VV`.
    Version,
    /// What the sensor is doing: `II`.
    State,
    /// Begin to measure: `BM`.
    LaserOn,
    /// Stop measuring and sending: `QT`.
    Stop,
    /// As after power was switched on: `RS`.
    Reset,
    /// Begin to tell the time, `TM0`; the laser goes out.
    ClockBegin,
    /// The sensor's time: `TM1`.
    ClockRead,
    /// No more times: `TM2`.
    ClockEnd,
    /// The newest scan: `GD`, `GS`, `GE`.
    Latest(RangeKind, ScanRange),
    /// Scans from now on: `MD`, `MS`, `ME`.
    Scans {
        /// What is measured.
        kind: RangeKind,
        /// Which steps.
        range: ScanRange,
        /// Scans that are left out between two, 0…9.
        interval: u8,
        /// How many, 1…99; 0: until [`Self::Stop`].
        count: u8,
    },
}

impl Command {
    /// The bytes, with the line feed at their end. Numbers beyond their digits are cut to the largest that fits.
    ///
    /// ```
    /// use floorguard_drivers::scip::{Command, RangeKind, ScanRange};
    ///
    /// let range = ScanRange { first_step: 44, last_step: 725, cluster: 1 };
    /// let command = Command::Scans { kind: RangeKind::Distance, range, interval: 0, count: 0 };
    /// assert_eq!(command.encode(), b"MD0044072501000\n");
    /// assert_eq!(Command::Latest(RangeKind::Distance, range).encode(), b"GD0044072501\n");
    /// ```
    #[must_use]
    pub fn encode(&self) -> Vec<u8, COMMAND_BYTES> {
        let mut line = Vec::new();
        let mut put = |bytes: &[u8]| {
            // The longest command is as long as the capacity.
            let _full = line.extend_from_slice(bytes);
        };
        match *self {
            Self::UseScip2 => put(b"SCIP2.0"),
            Self::Parameters => put(b"PP"),
            Self::Version => put(b"VV"),
            Self::State => put(b"II"),
            Self::LaserOn => put(b"BM"),
            Self::Stop => put(b"QT"),
            Self::Reset => put(b"RS"),
            Self::ClockBegin => put(b"TM0"),
            Self::ClockRead => put(b"TM1"),
            Self::ClockEnd => put(b"TM2"),
            Self::Latest(kind, range) => {
                put(&[b'G', kind.letter()]);
                put(&steps(range));
            }
            Self::Scans { kind, range, interval, count } => {
                put(&[b'M', kind.letter()]);
                put(&steps(range));
                put(&[digit(u16::from(interval.min(9)), 1)]);
                put(&[digit(u16::from(count.min(99)), 10), digit(u16::from(count.min(99)), 1)]);
            }
        }
        put(b"\n");
        line
    }
}

fn digit(number: u16, place: u16) -> u8 {
    // Below ten: one byte. Places are 1, 10, 100 and 1,000.
    let value = number.checked_div(place).unwrap_or(0) % 10;
    let [low, _] = value.to_le_bytes();
    b'0'.saturating_add(low)
}

fn steps(range: ScanRange) -> [u8; 10] {
    let (first, last) = (range.first_step.min(9_999), range.last_step.min(9_999));
    let cluster = u16::from(range.cluster.min(99));
    [
        digit(first, 1_000),
        digit(first, 100),
        digit(first, 10),
        digit(first, 1),
        digit(last, 1_000),
        digit(last, 100),
        digit(last, 10),
        digit(last, 1),
        digit(cluster, 10),
        digit(cluster, 1),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_those_of_the_specification() {
        let short = [
            (Command::UseScip2, "SCIP2.0\n"),
            (Command::Parameters, "PP\n"),
            (Command::LaserOn, "BM\n"),
            (Command::Stop, "QT\n"),
            (Command::ClockRead, "TM1\n"),
        ];
        for (command, text) in short {
            assert_eq!(command.encode(), text.as_bytes());
        }
        // From step 10 to 750, three steps each, every second scan, five of them.
        let range = ScanRange { first_step: 10, last_step: 750, cluster: 3 };
        let command = Command::Scans { kind: RangeKind::ShortDistance, range, interval: 1, count: 5 };
        assert_eq!(command.encode(), b"MS0010075003105\n");
        assert_eq!(range.values(), 247);
        let huge = ScanRange { first_step: 60_000, last_step: 60_000, cluster: 200 };
        let command = Command::Scans { kind: RangeKind::Strength, range: huge, interval: 77, count: 200 };
        assert_eq!(command.encode(), b"ME9999999999999\n");
    }
}
