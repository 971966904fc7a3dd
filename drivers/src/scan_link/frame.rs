//! A datagram of beams as a checked view: after [`BeamsFrame::new_checked`] no accessor can fail.

use crate::link::{CHECKSUM_BYTES, Damage, bytes_at, damage};

/// Positions and values; book, Scan link.
mod field {
    pub const START: [u8; 4] = [b'F', b'G', 1, 5];
    pub const SENDER: u8 = 4;
    pub const SEQUENCE: u8 = 8;
    pub const CLOCK: u8 = 12;
    pub const FIRST_ANGLE: u8 = 20;
    pub const STEP: u8 = 24;
    pub const BETWEEN: u8 = 28;
    pub const BEAMS: u8 = 32;
    pub const FRAGMENT: u8 = 34;
    pub const FRAGMENTS: u8 = 35;
    pub const HEAD_BYTES: usize = 36;
    pub const RANGE_BYTES: usize = 2;
}

/// Beams of a scan at most: those of the finest scanner that the guard takes.
pub const BEAMS_MAX: u16 = 2_751;
/// Beams of each datagram but the last: 1,440 bytes, so that no network divides it.
pub const FRAGMENT_BEAMS: u16 = 700;
/// Angles at most, millionths of a degree.
const ANGLE_MAX_UDEG: i64 = 360_000_000;
/// From beam to beam at most, millionths of a degree: farther apart a leg stands between two.
const STEP_MAX_UDEG: i64 = 10_000_000;
/// From the first beam to the last at most, nanoseconds: slower scans protect nobody.
const SCAN_MAX_NS: i64 = 1_000_000_000;

/// Why a datagram is none of beams.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameError {
    /// It does not begin with FG, version 1, kind 5.
    Start([u8; 4]),
    /// Not as long as its beams ask for.
    Length {
        /// Bytes received.
        found: usize,
        /// Bytes of its beams.
        needed: usize,
    },
    /// The checksum is another: damaged on the way.
    Checksum {
        /// What stands in the frame.
        found: u32,
        /// What its bytes come to.
        computed: u32,
    },
    /// A field outside of its range.
    Field {
        /// Offset in the frame, bytes.
        offset: u8,
        /// The value.
        found: i64,
        /// The least and the greatest allowed value.
        allowed: [i64; 2],
    },
    /// From its first beam to its last more time passes than a scan may take.
    Duration {
        /// Beams of the scan.
        beams: u16,
        /// Nanoseconds from beam to beam.
        between_ns: i32,
    },
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Start(found) => write!(f, "scan datagram begins with {found:02x?}; expected FG, 1, 5"),
            Self::Length { found, needed } => {
                write!(f, "scan datagram of {found} bytes; its beams have {needed}")
            }
            Self::Checksum { found, computed } => write!(
                f,
                "scan datagram with checksum {found:08x}, its bytes come to {computed:08x}: damaged on the way"
            ),
            Self::Field { offset, found, allowed: [least, most] } => {
                write!(f, "scan datagram: field at byte {offset} is {found}; allowed is {least} to {most}")
            }
            Self::Duration { beams, between_ns } => write!(
                f,
                "scan datagram: {beams} beams {between_ns} ns apart take longer than a second; correct the time between beams"
            ),
        }
    }
}

impl core::error::Error for FrameError {}

/// What all datagrams of a scan agree about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScanHead {
    /// Who sends; not 0.
    pub sender: u32,
    /// One more with each scan; wraps.
    pub sequence: u32,
    /// The sender's clock at the first beam, microseconds.
    pub first_beam_us: u64,
    /// Angle of the first beam, counter-clockwise from straight ahead, millionths of a degree.
    pub first_udeg: i32,
    /// From beam to beam, counter-clockwise, millionths of a degree.
    pub step_udeg: u32,
    /// From beam to beam, nanoseconds; negative where the device turns clockwise.
    pub between_ns: i32,
    /// Beams of the scan.
    pub beams: u16,
}

/// A checked datagram.
///
/// # Invariants
/// 2 to 2,751 beams in the scan, 1 to 700 of them here; at most a second from the first to the last; a sender that is not 0; a checksum
/// that is right.
#[derive(Clone, Copy, Debug)]
pub struct BeamsFrame<'a> {
    bytes: &'a [u8],
    head: ScanHead,
    fragment: u8,
    fragments: u8,
}

impl<'a> BeamsFrame<'a> {
    /// Checks a payload.
    ///
    /// # Errors
    /// [`FrameError`].
    pub fn new_checked(bytes: &'a [u8]) -> Result<Self, FrameError> {
        let start = bytes.first_chunk::<4>().copied().unwrap_or_default();
        if start != field::START {
            return Err(FrameError::Start(start));
        }
        let head = head_of(bytes);
        let (fragment, fragments) = (u8_at(bytes, field::FRAGMENT), u8_at(bytes, field::FRAGMENTS));
        let due = head.beams.div_ceil(FRAGMENT_BEAMS);
        let limits = [
            (field::SENDER, i64::from(head.sender), [1, i64::from(u32::MAX)]),
            (field::FIRST_ANGLE, i64::from(head.first_udeg), [-ANGLE_MAX_UDEG, ANGLE_MAX_UDEG]),
            (field::STEP, i64::from(head.step_udeg), [1, STEP_MAX_UDEG]),
            (field::BEAMS, i64::from(head.beams), [2, i64::from(BEAMS_MAX)]),
            (field::FRAGMENTS, i64::from(fragments), [i64::from(due); 2]),
            (field::FRAGMENT, i64::from(fragment), [0, i64::from(due.saturating_sub(1))]),
        ];
        let outside = |(_, found, [least, most]): &(u8, i64, [i64; 2])| found < least || found > most;
        if let Some((offset, found, allowed)) = limits.into_iter().find(outside) {
            return Err(FrameError::Field { offset, found, allowed });
        }
        let frame = Self { bytes, head, fragment, fragments };
        let needed = usize::from(frame.here())
            .saturating_mul(field::RANGE_BYTES)
            .saturating_add(field::HEAD_BYTES + CHECKSUM_BYTES);
        if bytes.len() != needed {
            return Err(FrameError::Length { found: bytes.len(), needed });
        }
        if let Some(Damage { found, computed }) = damage(bytes) {
            return Err(FrameError::Checksum { found, computed });
        }
        if head.duration_ns().abs() > SCAN_MAX_NS {
            return Err(FrameError::Duration { beams: head.beams, between_ns: head.between_ns });
        }
        Ok(frame)
    }

    /// What all datagrams of its scan agree about.
    #[must_use]
    pub const fn head(&self) -> ScanHead {
        self.head
    }

    /// Which datagram of the scan it is, from 0.
    #[must_use]
    pub const fn fragment(&self) -> u8 {
        self.fragment
    }

    /// Datagrams of the scan: 1 to 4.
    #[must_use]
    pub const fn fragments(&self) -> u8 {
        self.fragments
    }

    /// The number of its first beam in the scan.
    #[must_use]
    pub fn first_beam(&self) -> u16 {
        u16::from(self.fragment).saturating_mul(FRAGMENT_BEAMS)
    }

    /// Ranges of its beams, millimetres; 0 is no return.
    pub fn ranges_mm(&self) -> impl Iterator<Item = u16> + use<'a> {
        let end = self.bytes.len().saturating_sub(CHECKSUM_BYTES);
        let ranges = self.bytes.get(field::HEAD_BYTES..end).unwrap_or_default();
        ranges
            .chunks_exact(field::RANGE_BYTES)
            .map(|bytes| bytes.first_chunk::<2>().map_or(0, |bytes| u16::from_le_bytes(*bytes)))
    }

    /// Its beams: all that remain of the scan, up to those of a datagram.
    fn here(&self) -> u16 {
        self.head.beams.saturating_sub(self.first_beam()).min(FRAGMENT_BEAMS)
    }
}

impl ScanHead {
    /// From the first beam to the last, nanoseconds.
    #[must_use]
    pub fn duration_ns(&self) -> i64 {
        i64::from(self.between_ns).saturating_mul(i64::from(self.beams.saturating_sub(1)))
    }
}

fn head_of(bytes: &[u8]) -> ScanHead {
    ScanHead {
        sender: u32::from_le_bytes(bytes_at(bytes, field::SENDER)),
        sequence: u32::from_le_bytes(bytes_at(bytes, field::SEQUENCE)),
        first_beam_us: u64::from_le_bytes(bytes_at(bytes, field::CLOCK)),
        first_udeg: i32::from_le_bytes(bytes_at(bytes, field::FIRST_ANGLE)),
        step_udeg: u32::from_le_bytes(bytes_at(bytes, field::STEP)),
        between_ns: i32::from_le_bytes(bytes_at(bytes, field::BETWEEN)),
        beams: u16::from_le_bytes(bytes_at(bytes, field::BEAMS)),
    }
}

fn u8_at(bytes: &[u8], at: u8) -> u8 {
    let [byte] = bytes_at(bytes, at);
    byte
}
