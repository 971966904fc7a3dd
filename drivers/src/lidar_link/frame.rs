//! A datagram of columns as a checked view: after [`ColumnsFrame::new_checked`] no accessor can fail.

use crate::link::{CHECKSUM_BYTES, Damage, damage};

/// Positions and values; book, Lidar link.
mod field {
    pub const START: [u8; 4] = [b'F', b'G', 1, 4];
    pub const HEAD_BYTES: usize = 24;
    /// Azimuth and time of a column.
    pub const COLUMN_HEAD_BYTES: usize = 4;
    /// Range and reflectivity of a ring.
    pub const CELL_BYTES: usize = 3;
}

/// Rings of a column at most.
pub const RINGS_MAX: u8 = 32;
/// Columns of a datagram at most.
const COLUMNS_MAX: u8 = 24;
/// Millimetres a count at most: sixteen bits then reach 655 m.
const UNIT_MM_MAX: u8 = 10;
/// A whole turn, hundredths of a degree.
const TURN_CDEG: u16 = 36_000;

/// Why a datagram is none of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameError {
    /// It does not begin with FG, version 1, kind 4.
    Start([u8; 4]),
    /// Not as long as its columns and rings ask for.
    Length {
        /// Bytes received.
        found: usize,
        /// Bytes of its columns and rings.
        needed: usize,
    },
    /// The checksum is another: damaged on the way.
    Checksum {
        /// What stands in the frame.
        found: u32,
        /// What its bytes come to.
        computed: u32,
    },
    /// A field outside of its range: its offset, and what stands there.
    Field {
        /// Offset in the frame, bytes.
        offset: u8,
        /// The value.
        found: u8,
    },
    /// Columns run clockwise, each no earlier than the one before, below 360°.
    Order {
        /// The column.
        column: u8,
        /// Its azimuth, hundredths of a degree.
        azimuth_cdeg: u16,
    },
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Start(found) => write!(f, "lidar datagram begins with {found:02x?}; expected FG, 1, 4"),
            Self::Length { found, needed } => {
                write!(f, "lidar datagram of {found} bytes; its columns and rings have {needed}")
            }
            Self::Checksum { found, computed } => {
                write!(f, "checksum {found:08x}, the bytes come to {computed:08x}: damaged on the way")
            }
            Self::Field { offset, found } => {
                write!(f, "field at byte {offset} is {found}, outside of its range")
            }
            Self::Order { column, azimuth_cdeg } => write!(
                f,
                "column {column} at {azimuth_cdeg} cdeg does not follow the one before: columns run clockwise and in time"
            ),
        }
    }
}

impl core::error::Error for FrameError {}

/// A checked datagram.
///
/// # Invariants
/// 1 to 24 columns of 1 to 32 rings, clockwise and in time; a sender that is not 0; a checksum that is right.
#[derive(Clone, Copy, Debug)]
pub struct ColumnsFrame<'a> {
    bytes: &'a [u8],
    rings: u8,
}

impl<'a> ColumnsFrame<'a> {
    /// Checks a payload.
    ///
    /// # Errors
    /// [`FrameError`].
    pub fn new_checked(bytes: &'a [u8]) -> Result<Self, FrameError> {
        let start = bytes.first_chunk::<4>().copied().unwrap_or_default();
        if start != field::START {
            return Err(FrameError::Start(start));
        }
        let byte = |offset: u8| bytes.get(usize::from(offset)).copied().unwrap_or(0);
        let (rings, columns) = (byte(20), byte(21));
        let limits = [(20, rings, RINGS_MAX), (21, columns, COLUMNS_MAX), (22, byte(22), UNIT_MM_MAX)];
        if let Some((offset, found, _)) =
            limits.into_iter().find(|(_, found, most)| !(1..=*most).contains(found))
        {
            return Err(FrameError::Field { offset, found });
        }
        let needed = usize::from(columns)
            .saturating_mul(column_bytes(rings))
            .saturating_add(field::HEAD_BYTES + CHECKSUM_BYTES);
        if bytes.len() != needed {
            return Err(FrameError::Length { found: bytes.len(), needed });
        }
        if u32_at(bytes, 4) == 0 {
            return Err(FrameError::Field { offset: 4, found: 0 });
        }
        if let Some(Damage { found, computed }) = damage(bytes) {
            return Err(FrameError::Checksum { found, computed });
        }
        let frame = Self { bytes, rings };
        let mut before: Option<Column<'_>> = None;
        for (column, next) in (0_u8..).zip(frame.columns()) {
            let azimuth_cdeg = next.azimuth_cdeg;
            let follows = before.is_none_or(|before| {
                let turned = (u32::from(azimuth_cdeg) + 36_000)
                    .saturating_sub(u32::from(before.azimuth_cdeg))
                    % 36_000;
                (1..18_000).contains(&turned) && next.offset_us >= before.offset_us
            });
            if azimuth_cdeg >= TURN_CDEG || !follows {
                return Err(FrameError::Order { column, azimuth_cdeg });
            }
            before = Some(next);
        }
        Ok(frame)
    }

    /// Who sends; not 0.
    #[must_use]
    pub fn sender(&self) -> u32 {
        u32_at(self.bytes, 4)
    }

    /// One more with each datagram; wraps.
    #[must_use]
    pub fn sequence(&self) -> u32 {
        u32_at(self.bytes, 8)
    }

    /// The sender's clock at the first column, microseconds.
    #[must_use]
    pub fn sent_us(&self) -> u64 {
        let bytes = self.bytes.get(12..).and_then(<[u8]>::first_chunk::<8>);
        bytes.map_or(0, |bytes| u64::from_le_bytes(*bytes))
    }

    /// Rings of each column, the lowest first.
    #[must_use]
    pub const fn rings(&self) -> u8 {
        self.rings
    }

    /// Millimetres a count.
    #[must_use]
    pub fn range_unit_mm(&self) -> u8 {
        self.bytes.get(22).copied().unwrap_or(1)
    }

    /// The columns.
    pub fn columns(&self) -> impl Iterator<Item = Column<'a>> + use<'a> {
        let end = self.bytes.len().saturating_sub(CHECKSUM_BYTES);
        let columns = self.bytes.get(field::HEAD_BYTES..end).unwrap_or_default();
        columns.chunks_exact(column_bytes(self.rings)).map(|bytes| Column {
            azimuth_cdeg: u16_at(bytes, 0),
            offset_us: u16_at(bytes, 2),
            cells: bytes.get(field::COLUMN_HEAD_BYTES..).unwrap_or_default(),
        })
    }
}

/// What all rings measured at one azimuth.
#[derive(Clone, Copy, Debug)]
pub struct Column<'a> {
    /// Clockwise from the lidar's forward, hundredths of a degree, 0…35,999.
    pub azimuth_cdeg: u16,
    /// After [`ColumnsFrame::sent_us`].
    pub offset_us: u16,
    cells: &'a [u8],
}

impl Column<'_> {
    /// Range in counts, 0 for none, and reflectivity of each ring, the lowest first.
    pub fn cells(&self) -> impl Iterator<Item = (u16, u8)> {
        self.cells
            .chunks_exact(field::CELL_BYTES)
            .map(|cell| (u16_at(cell, 0), cell.get(2).copied().unwrap_or(0)))
    }
}

fn column_bytes(rings: u8) -> usize {
    usize::from(rings).saturating_mul(field::CELL_BYTES).saturating_add(field::COLUMN_HEAD_BYTES)
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
