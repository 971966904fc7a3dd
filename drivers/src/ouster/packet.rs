//! A lidar packet as a checked view: after [`Packet::new_checked`] no accessor can fail.

use super::beams::{Beams, DataFormat};

/// Positions and values; book, Ouster: Lidar packet.
mod field {
    /// Around the columns of every format but `LEGACY`.
    pub const HEADER_BYTES: usize = 32;
    pub const FOOTER_BYTES: usize = 32;
    pub const LIDAR_TYPE: u16 = 1;
    pub const FRAME: usize = 2;
    /// Of a column of `LEGACY`.
    pub const LEGACY_COLUMN_BYTES: usize = 16;
    pub const LEGACY_FRAME: usize = 10;
    pub const LEGACY_STATUS_BYTES: usize = 4;
    pub const LEGACY_VALID: u32 = u32::MAX;
    /// Of a column of every other format.
    pub const COLUMN_BYTES: usize = 12;
    pub const MEASUREMENT: usize = 8;
    pub const STATUS: usize = 10;
    pub const VALID: u16 = 1;
    /// Range of a pixel: so many low bits.
    pub const LEGACY_RANGE_MASK: u32 = 0xF_FFFF;
    pub const RANGE_MASK: u32 = 0x7_FFFF;
    pub const LOW_RATE_MASK: u32 = 0x7FFF;
    pub const LOW_RATE_MM: u32 = 8;
}

impl DataFormat {
    /// Bytes of a pixel.
    #[must_use]
    pub const fn pixel_bytes(self) -> usize {
        match self {
            Self::Legacy | Self::Single => 12,
            Self::Dual => 16,
            Self::LowRate => 4,
        }
    }

    /// Before and behind the pixels of a column.
    const fn around_column(self) -> [usize; 2] {
        match self {
            Self::Legacy => [field::LEGACY_COLUMN_BYTES, field::LEGACY_STATUS_BYTES],
            _ => [field::COLUMN_BYTES, 0],
        }
    }

    /// Before and behind the columns of a packet.
    const fn around_packet(self) -> [usize; 2] {
        match self {
            Self::Legacy => [0, 0],
            _ => [field::HEADER_BYTES, field::FOOTER_BYTES],
        }
    }

    /// Bytes of a column of so many beams.
    fn column_bytes(self, channels: u8) -> usize {
        let [before, behind] = self.around_column();
        let pixels = usize::from(channels).saturating_mul(self.pixel_bytes());
        before.saturating_add(pixels).saturating_add(behind)
    }
}

/// A datagram that is no lidar packet of this sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PacketError {
    /// Not as long as packets of the sensor in the robot's file are.
    Length {
        /// Bytes received.
        received: usize,
        /// Bytes of its packets.
        expected: usize,
    },
    /// Not the type of a lidar packet.
    Type {
        /// What stands there.
        found: u16,
    },
    /// Columns that do not follow each other, or beyond those of a turn.
    Columns {
        /// The column that should not stand there.
        found: u16,
        /// What should.
        expected: u16,
    },
}

impl core::fmt::Display for PacketError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Length { received, expected } => write!(
                f,
                "lidar packet of {received} bytes; the sensor of this robot's file sends {expected}: do its profile, channels and \
                 columns agree with its metadata?"
            ),
            Self::Type { found } => write!(f, "packet of type {found}; a lidar packet has 1"),
            Self::Columns { found, expected } => {
                write!(
                    f,
                    "lidar column {found} stands where {expected} should; is the sensor's mode that of its metadata?"
                )
            }
        }
    }
}

impl core::error::Error for PacketError {}

/// A checked lidar packet.
///
/// # Invariants
/// As long as its format asks for; its columns follow each other within one turn.
#[derive(Clone, Copy, Debug)]
pub struct Packet<'a> {
    bytes: &'a [u8],
    format: DataFormat,
    channels: u8,
}

impl<'a> Packet<'a> {
    /// Bytes of a packet of a sensor.
    #[must_use]
    pub fn length(beams: &Beams) -> usize {
        let [before, behind] = beams.format.around_packet();
        let columns = usize::from(beams.columns_per_packet);
        let columns = columns.saturating_mul(beams.format.column_bytes(beams.channels));
        before.saturating_add(columns).saturating_add(behind)
    }

    /// Checks a payload.
    ///
    /// # Errors
    /// [`PacketError`]; another sensor, another mode, or no lidar packet.
    pub fn new_checked(bytes: &'a [u8], beams: &Beams) -> Result<Self, PacketError> {
        let expected = Self::length(beams);
        if bytes.len() != expected {
            return Err(PacketError::Length { received: bytes.len(), expected });
        }
        let packet = Self { bytes, format: beams.format, channels: beams.channels };
        if packet.format != DataFormat::Legacy && u16_at(bytes, 0) != field::LIDAR_TYPE {
            return Err(PacketError::Type { found: u16_at(bytes, 0) });
        }
        let mut expected: Option<u16> = None;
        for column in packet.columns() {
            let found = column.measurement();
            let wanted = expected.unwrap_or(found.min(beams.columns_per_turn.saturating_sub(1)));
            if found != wanted {
                return Err(PacketError::Columns { found, expected: wanted });
            }
            expected = Some(wanted.saturating_add(1));
        }
        Ok(packet)
    }

    /// Number of the turn; wraps.
    #[must_use]
    pub fn frame(&self) -> u16 {
        match self.format {
            DataFormat::Legacy => u16_at(self.bytes, field::LEGACY_FRAME),
            _ => u16_at(self.bytes, field::FRAME),
        }
    }

    /// Its columns, in the order of time.
    pub fn columns(&self) -> impl Iterator<Item = Column<'a>> + use<'a> {
        let [before, behind] = self.format.around_packet();
        let end = self.bytes.len().saturating_sub(behind);
        let columns = self.bytes.get(before..end).unwrap_or_default();
        let (format, channels) = (self.format, self.channels);
        columns.chunks_exact(format.column_bytes(channels).max(1)).map(move |bytes| Column {
            bytes,
            format,
            channels,
        })
    }
}

/// A column of a checked packet.
#[derive(Clone, Copy, Debug)]
pub struct Column<'a> {
    bytes: &'a [u8],
    format: DataFormat,
    channels: u8,
}

impl Column<'_> {
    /// The sensor's clock, nanoseconds.
    #[must_use]
    pub fn sensor_ns(&self) -> u64 {
        self.bytes.first_chunk::<8>().map_or(0, |bytes| u64::from_le_bytes(*bytes))
    }

    /// Number of the column within the turn.
    #[must_use]
    pub fn measurement(&self) -> u16 {
        u16_at(self.bytes, field::MEASUREMENT)
    }

    /// It was measured; a column that was not says nothing.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        match self.format {
            DataFormat::Legacy => {
                let at = self.bytes.len().saturating_sub(field::LEGACY_STATUS_BYTES);
                u32_at(self.bytes, at) == field::LEGACY_VALID
            }
            _ => u16_at(self.bytes, field::STATUS) & field::VALID != 0,
        }
    }

    /// Range and reflectivity of a beam, millimetres; the nearer of two echoes, `None` without one.
    #[must_use]
    pub fn pixel(&self, channel: u8) -> Option<(u32, u8)> {
        if channel >= self.channels {
            return None;
        }
        let [before, _] = self.format.around_column();
        let at = before.saturating_add(usize::from(channel).saturating_mul(self.format.pixel_bytes()));
        let byte = |offset: usize| self.bytes.get(at.saturating_add(offset)).copied().unwrap_or(0);
        let word = |offset: usize| u32_at(self.bytes, at.saturating_add(offset));
        let echo = |range_mm: u32, reflectivity: u8| (range_mm > 0).then_some((range_mm, reflectivity));
        match self.format {
            DataFormat::Legacy => echo(word(0) & field::LEGACY_RANGE_MASK, byte(4)),
            DataFormat::Single => echo(word(0) & field::RANGE_MASK, byte(4)),
            DataFormat::Dual => {
                let first = echo(word(0) & field::RANGE_MASK, byte(3));
                let second = echo(word(4) & field::RANGE_MASK, byte(7));
                match (first, second) {
                    (Some(first), Some(second)) => Some(if second.0 < first.0 { second } else { first }),
                    (first, second) => first.or(second),
                }
            }
            DataFormat::LowRate => {
                let raw = u32::from(u16_at(self.bytes, at)) & field::LOW_RATE_MASK;
                echo(raw.saturating_mul(field::LOW_RATE_MM), byte(2))
            }
        }
    }
}

/// Beyond the end: 0.
fn u16_at(bytes: &[u8], at: usize) -> u16 {
    let found = bytes.get(at..).and_then(<[u8]>::first_chunk::<2>);
    found.map_or(0, |bytes| u16::from_le_bytes(*bytes))
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let found = bytes.get(at..).and_then(<[u8]>::first_chunk::<4>);
    found.map_or(0, |bytes| u32::from_le_bytes(*bytes))
}
