//! A data packet as a checked view: after [`Packet::new_checked`] no accessor can fail.

/// Positions and values of the packet; book, Hesai: Data packet.
mod field {
    pub const HEADER_BYTES: usize = 12;
    pub const TAIL_BYTES: usize = 28;
    pub const START: [u8; 2] = [0xEE, 0xFF];
    pub const MAJOR: u8 = 6;
    pub const UNIT_MM: u8 = 4;
    /// Azimuth of a block.
    pub const AZIMUTH_BYTES: usize = 2;
    /// Distance, reflectivity and confidence of a channel.
    pub const CELL_BYTES: usize = 4;
    pub const SEQUENCE_FLAG: u8 = 1;
}

/// Blocks of a packet.
pub(super) const BLOCKS: usize = 8;
/// A whole turn, hundredths of a degree.
const TURN_CDEG: u16 = 36_000;

/// Which echoes a packet carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReturnMode {
    /// One echo: the first, the second, the strongest or the last one.
    Single,
    /// Two echoes, in pairs of blocks of the same azimuth.
    Dual,
}

/// A datagram that is no data packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PacketError {
    /// Neither the 568 bytes of an XT-16 nor the 1,080 of an XT-32, or not those of the lasers that it names.
    Length {
        /// Bytes received.
        received: usize,
    },
    /// It does not start with EE FF, protocol 6.
    Start {
        /// The first three bytes.
        found: [u8; 3],
    },
    /// Neither 16 nor 32 lasers in 8 blocks, with a distance unit of 4 mm.
    Shape {
        /// Lasers.
        lasers: u8,
        /// Blocks.
        blocks: u8,
        /// Millimetres a count.
        unit_mm: u8,
    },
    /// An azimuth above 36,000.
    Azimuth {
        /// The block, 0…7.
        block: u8,
        /// Hundredths of a degree.
        azimuth_cdeg: u16,
    },
    /// A return mode with more than two echoes, or an unknown one.
    ReturnMode {
        /// The byte.
        found: u8,
    },
    /// A time of day beyond its limits.
    Time {
        /// Minute, second.
        found: [u8; 2],
        /// Microseconds of the second.
        micros: u32,
    },
}

impl core::fmt::Display for PacketError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Length { received } => {
                write!(f, "lidar packet of {received} bytes; an XT-16 sends 568, an XT-32 1080")
            }
            Self::Start { found: [a, b, major] } => {
                write!(f, "lidar packet starts with {a:02X} {b:02X} {major:02X}; expected EE FF 06")
            }
            Self::Shape { lasers, blocks, unit_mm } => {
                write!(
                    f,
                    "lidar packet of {lasers} lasers, {blocks} blocks, {unit_mm} mm; expected 16 or 32, 8, 4"
                )
            }
            Self::Azimuth { block, azimuth_cdeg } => {
                write!(f, "lidar block {block} has azimuth {azimuth_cdeg} cdeg; the limit is 36000")
            }
            Self::ReturnMode { found } => {
                write!(f, "lidar return mode 0x{found:02X}; set the lidar to one or two returns")
            }
            Self::Time { found: [minute, second], micros } => {
                write!(f, "lidar time {minute} min {second} s {micros} us; the limits are 59, 60 and 999999")
            }
        }
    }
}

impl core::error::Error for PacketError {}

/// A checked data packet.
///
/// # Invariants
/// As long as its number of lasers asks for; eight blocks with an azimuth of at most 36,000, which is 0; one or two echoes; a time
/// of day.
///
/// ```
/// use floorguard_drivers::hesai::{Packet, PacketError};
///
/// let mut bytes = [0; 568];
/// bytes[..12].copy_from_slice(&[0xEE, 0xFF, 6, 1, 0, 0, 16, 8, 0, 4, 1, 1]);
/// bytes[550] = 0x37;
/// bytes[12..18].copy_from_slice(&[0x10, 0x27, 0xFA, 0x00, 40, 0]);
/// let packet = Packet::new_checked(&bytes).unwrap();
/// let block = packet.blocks().next().unwrap();
/// // 100°; the uppermost laser sees something 1 m away.
/// assert_eq!((block.azimuth_cdeg, block.cells().next()), (10_000, Some((250, 40))));
/// assert_eq!(Packet::new_checked(&bytes[..567]).unwrap_err(), PacketError::Length { received: 567 });
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Packet<'a> {
    lasers: u8,
    body: &'a [u8],
    mode: ReturnMode,
    rpm: u16,
    hour_us: u32,
    sequence: Option<u32>,
}

/// One firing of all lasers.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// Hundredths of a degree, 0…35,999, clockwise seen from above.
    pub azimuth_cdeg: u16,
    cells: &'a [u8],
}

impl Block<'_> {
    /// Raw distance (4 mm; 0: none) and reflectivity of each laser, from the uppermost down. 16 or 32.
    pub fn cells(&self) -> impl Iterator<Item = (u16, u8)> {
        let (cells, _) = self.cells.as_chunks::<{ field::CELL_BYTES }>();
        cells.iter().map(|[low, high, reflectivity, _]| (u16::from_le_bytes([*low, *high]), *reflectivity))
    }
}

impl<'a> Packet<'a> {
    /// Checks everything that the packet says of itself.
    ///
    /// # Errors
    /// [`PacketError`] names the first value that is wrong.
    pub fn new_checked(payload: &'a [u8]) -> Result<Self, PacketError> {
        let length = PacketError::Length { received: payload.len() };
        let (header, rest) = payload.split_first_chunk::<{ field::HEADER_BYTES }>().ok_or(length)?;
        let [start, second, major, _, _, _, lasers, blocks, _, unit_mm, _, flags] = *header;
        if [start, second] != field::START || major != field::MAJOR {
            return Err(PacketError::Start { found: [start, second, major] });
        }
        if !matches!(lasers, 16 | 32) || usize::from(blocks) != BLOCKS || unit_mm != field::UNIT_MM {
            return Err(PacketError::Shape { lasers, blocks, unit_mm });
        }
        let body_bytes = BLOCKS * (field::AZIMUTH_BYTES + field::CELL_BYTES * usize::from(lasers));
        let (body, tail) = rest.split_at_checked(body_bytes).ok_or(length)?;
        let tail: &[u8; field::TAIL_BYTES] = tail.try_into().map_err(|_| length)?;
        let packet = Self::with_tail((lasers, body), tail, flags & field::SEQUENCE_FLAG != 0)?;
        for (number, (azimuth_cdeg, _)) in (0_u8..).zip(packet.raw_blocks()) {
            if azimuth_cdeg > TURN_CDEG {
                return Err(PacketError::Azimuth { block: number, azimuth_cdeg });
            }
        }
        Ok(packet)
    }

    fn with_tail(
        (lasers, body): (u8, &'a [u8]),
        tail: &[u8; field::TAIL_BYTES],
        has_sequence: bool,
    ) -> Result<Self, PacketError> {
        let [_, _, _, _, _, _, _, _, _, _, mode, rpm_low, rpm_high, _, _, _, _, minute, second, rest @ ..] =
            *tail;
        let [micros @ .., _, s0, s1, s2, s3] = rest;
        let micros = u32::from_le_bytes(micros);
        // A leap second is the sixtieth.
        if minute > 59 || second > 60 || micros > 999_999 {
            return Err(PacketError::Time { found: [minute, second], micros });
        }
        let mode = match mode {
            0x33 | 0x34 | 0x37 | 0x38 => ReturnMode::Single,
            0x39..=0x3C | 0x3E => ReturnMode::Dual,
            found => return Err(PacketError::ReturnMode { found }),
        };
        let seconds = u32::from(minute).saturating_mul(60).saturating_add(u32::from(second));
        Ok(Self {
            lasers,
            body,
            mode,
            rpm: u16::from_le_bytes([rpm_low, rpm_high]),
            hour_us: seconds.saturating_mul(1_000_000).saturating_add(micros),
            sequence: has_sequence.then_some(u32::from_le_bytes([s0, s1, s2, s3])),
        })
    }

    /// Azimuth as sent, and the cells, of each block.
    fn raw_blocks(&self) -> impl Iterator<Item = (u16, &'a [u8])> {
        let block_bytes = field::AZIMUTH_BYTES + field::CELL_BYTES * usize::from(self.lasers);
        self.body.chunks_exact(block_bytes).filter_map(|block| {
            let (azimuth, cells) = block.split_first_chunk::<{ field::AZIMUTH_BYTES }>()?;
            Some((u16::from_le_bytes(*azimuth), cells))
        })
    }

    /// The eight blocks in the order of the wire, which is that of time.
    pub fn blocks(&self) -> impl Iterator<Item = Block<'a>> {
        self.raw_blocks().map(|(azimuth_cdeg, cells)| Block {
            azimuth_cdeg: if azimuth_cdeg >= TURN_CDEG { 0 } else { azimuth_cdeg },
            cells,
        })
    }

    /// 16 or 32.
    #[must_use]
    pub const fn lasers(&self) -> u8 {
        self.lasers
    }

    /// Which echoes.
    #[must_use]
    pub const fn return_mode(&self) -> ReturnMode {
        self.mode
    }

    /// Turns of the head a minute.
    #[must_use]
    pub const fn rpm(&self) -> u16 {
        self.rpm
    }

    /// The sensor's time at the end of the packet, microseconds since the top of its hour, up to a second into the next.
    #[must_use]
    pub const fn hour_us(&self) -> u32 {
        self.hour_us
    }

    /// Running number of the packet, where it is sent.
    #[must_use]
    pub const fn sequence(&self) -> Option<u32> {
        self.sequence
    }
}
