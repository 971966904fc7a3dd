//! A data packet of 1,206 bytes as a checked view: after [`Packet::new_checked`] no accessor can fail.

use floorguard_types::number::{truncating_u16, truncating_u32};

/// Positions in the packet; book, Velodyne: Data packet.
mod field {
    pub const BLOCK_BYTES: usize = 100;
    pub const BLOCKS: usize = 12;
    pub const CHANNELS: usize = 32;
    pub const FLAG: [u8; 2] = [0xff, 0xee];
    pub const STAMP: core::ops::Range<usize> = 1_200..1_204;
    pub const RETURN_MODE: usize = 1_204;
    pub const PRODUCT: usize = 1_205;
    pub const PACKET_BYTES: usize = 1_206;
}

/// Data blocks of a packet.
pub(super) const BLOCKS: usize = field::BLOCKS;

/// Which echoes a packet carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReturnMode {
    /// The strongest echo.
    Strongest,
    /// The last echo.
    Last,
    /// Last and strongest, in pairs of blocks.
    Dual,
}

/// A datagram that is no data packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PacketError {
    /// Not 1,206 bytes long.
    Length {
        /// Bytes received.
        received: usize,
    },
    /// A block does not start with FF EE.
    BlockFlag {
        /// Which block, 0…11.
        block: u8,
        /// What stands there.
        found: [u8; 2],
    },
    /// An azimuth above 36,000 in this block and in every other; a packet with one that has an azimuth is taken.
    Azimuth {
        /// The first block.
        block: u8,
        /// Hundredths of a degree.
        azimuth_cdeg: u16,
    },
    /// A return mode that the manual does not know.
    ReturnMode {
        /// The byte.
        found: u8,
    },
    /// A stamp beyond the hour (3,601 s are tolerated at the roll-over).
    Stamp {
        /// Microseconds since the top of the hour.
        micros: u32,
    },
}

impl core::fmt::Display for PacketError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Length { received } => {
                write!(f, "lidar packet of {received} bytes; a data packet has {}", field::PACKET_BYTES)
            }
            Self::BlockFlag { block, found: [a, b] } => {
                write!(f, "lidar block {block} starts with {a:02X} {b:02X}; expected FF EE")
            }
            Self::Azimuth { block, azimuth_cdeg } => {
                write!(f, "lidar block {block} has azimuth {azimuth_cdeg} cdeg; the limit is 36000: left out")
            }
            Self::ReturnMode { found } => {
                write!(f, "lidar return mode 0x{found:02X}; known are 0x37, 0x38, 0x39")
            }
            Self::Stamp { micros } => {
                write!(f, "lidar stamp {micros} us after the hour; the limit is {STAMP_LIMIT_US} us")
            }
        }
    }
}

impl core::error::Error for PacketError {}

/// A whole turn, hundredths of a degree. Early firmware sends it in place of 0 (book, Velodyne: Data packet).
const TURN_CDEG: u16 = 36_000;

/// Stamps up to one second into the next hour have been seen at the roll-over (book, Velodyne: Clock).
pub const STAMP_LIMIT_US: u32 = 3_601_000_000;

/// A checked data packet.
///
/// # Invariants
/// 1,206 bytes; every block starts with FF EE, and one at least has an azimuth of at most 36,000, which is 0; the return mode is
/// known; the stamp is within the hour and one second.
///
/// ```
/// use floorguard_drivers::velodyne::{Packet, PacketError, ReturnMode};
///
/// let mut bytes = [0; 1_206];
/// for (azimuth_cdeg, block) in (0_u16..).step_by(40).zip(bytes.chunks_exact_mut(100)) {
///     block[..2].copy_from_slice(&[0xFF, 0xEE]);
///     block[2..4].copy_from_slice(&azimuth_cdeg.to_le_bytes());
/// }
/// bytes[1_204..].copy_from_slice(&[0x37, 0x22]);
/// let packet = Packet::new_checked(&bytes).unwrap();
/// assert_eq!((packet.return_mode(), packet.product_byte()), (ReturnMode::Strongest, 0x22));
/// assert_eq!(packet.azimuths()[11], 440);
/// assert_eq!(packet.gaps(), [40; 12]);
/// // Cut, or damaged: refused whole, with what was found.
/// assert_eq!(Packet::new_checked(&bytes[1..]).unwrap_err(), PacketError::Length { received: 1_205 });
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Packet<'a> {
    blocks: &'a [u8],
    stamp_us: u32,
    return_mode: ReturnMode,
    product_byte: u8,
}

/// One block of a packet.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// Hundredths of a degree, clockwise, at the first firing; above 35,999 it is none, and nobody knows where the
    /// block looked.
    pub azimuth_cdeg: u16,
    channels: &'a [u8],
}

/// Where the head was at a block, and how it turned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BlockTurn {
    /// At the first firing, hundredths of a degree, 0…35,999; `None` where the wire has no azimuth. Of a dual return
    /// both blocks of a pair have one, or none.
    pub azimuth_cdeg: Option<u16>,
    /// Rotation within the block, hundredths of a degree.
    pub gap_cdeg: u16,
    /// Closed sector between the block (pair) before and this one, hundredths of a degree: a lidar that is set to a
    /// field of view leaves out what it fires elsewhere. 0 where the head has turned evenly.
    pub skipped_cdeg: u16,
}

/// At 1,200 rpm a block turns 80 cdeg; the margin is for a head that overshoots (book, Velodyne: Azimuth).
pub(super) const GAP_MAX_CDEG: u16 = 100;

impl<'a> Packet<'a> {
    /// Checks a UDP payload.
    ///
    /// # Errors
    /// [`PacketError`], with what was found; the packet is rejected whole.
    pub fn new_checked(payload: &'a [u8]) -> Result<Self, PacketError> {
        let bytes: &[u8; field::PACKET_BYTES] =
            payload.try_into().map_err(|_| PacketError::Length { received: payload.len() })?;
        let blocks = bytes.get(..field::BLOCKS * field::BLOCK_BYTES).unwrap_or_default();
        let mut odd = 0;
        for (block, bytes) in (0u8..12).zip(blocks.chunks_exact(field::BLOCK_BYTES)) {
            let [flag_low, flag_high, low, high, ..] = *bytes else { continue };
            if [flag_low, flag_high] != field::FLAG {
                return Err(PacketError::BlockFlag { block, found: [flag_low, flag_high] });
            }
            odd += usize::from(u16::from_le_bytes([low, high]) > TURN_CDEG);
        }
        let return_mode = match bytes[field::RETURN_MODE] {
            0x37 => ReturnMode::Strongest,
            0x38 => ReturnMode::Last,
            0x39 => ReturnMode::Dual,
            found => return Err(PacketError::ReturnMode { found }),
        };
        let stamp = bytes.get(field::STAMP).and_then(|four| four.try_into().ok()).unwrap_or([0; 4]);
        let stamp_us = u32::from_le_bytes(stamp);
        if stamp_us > STAMP_LIMIT_US {
            return Err(PacketError::Stamp { micros: stamp_us });
        }
        let packet = Self { blocks, stamp_us, return_mode, product_byte: bytes[field::PRODUCT] };
        if odd == field::BLOCKS
            && let Some(first) = packet.odd_blocks().next()
        {
            return Err(first);
        }
        Ok(packet)
    }

    /// The blocks whose azimuth is above 36,000: their returns have no direction and are left out. At most eleven.
    pub fn odd_blocks(&self) -> impl Iterator<Item = PacketError> + use<'a> {
        let numbered = (0_u8..).zip(self.blocks());
        numbered
            .filter(|(_, block)| block.azimuth_cdeg >= TURN_CDEG)
            .map(|(block, odd)| PacketError::Azimuth { block, azimuth_cdeg: odd.azimuth_cdeg })
    }

    /// Microseconds since the top of the sensor's hour, at the first firing.
    #[must_use]
    pub const fn stamp_us(&self) -> u32 {
        self.stamp_us
    }

    /// Which echoes it carries.
    #[must_use]
    pub const fn return_mode(&self) -> ReturnMode {
        self.return_mode
    }

    /// Two echoes per firing, in pairs of blocks.
    #[must_use]
    pub fn is_dual(&self) -> bool {
        self.return_mode == ReturnMode::Dual
    }

    /// The product byte of the wire.
    #[must_use]
    pub const fn product_byte(&self) -> u8 {
        self.product_byte
    }

    /// The twelve blocks.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = Block<'a>> + Clone + use<'a> {
        self.blocks.chunks_exact(field::BLOCK_BYTES).map(|bytes| match bytes {
            [_, _, low, high, channels @ ..] => {
                // A whole turn is none.
                let azimuth_cdeg = u16::from_le_bytes([*low, *high]);
                Block { azimuth_cdeg: if azimuth_cdeg == TURN_CDEG { 0 } else { azimuth_cdeg }, channels }
            }
            _ => Block { azimuth_cdeg: 0, channels: &[] },
        })
    }

    /// Azimuths of the twelve blocks as on the wire, a whole turn as 0; above 35,999 there is none.
    #[must_use]
    pub fn azimuths(&self) -> [u16; field::BLOCKS] {
        let mut azimuths = [0; field::BLOCKS];
        for (azimuth, block) in azimuths.iter_mut().zip(self.blocks()) {
            *azimuth = block.azimuth_cdeg;
        }
        azimuths
    }

    /// Rotation within each block, hundredths of a degree; see [`Self::turns`].
    #[must_use]
    pub fn gaps(&self) -> [u16; field::BLOCKS] {
        self.turns().map(|turn| turn.gap_cdeg)
    }

    /// Where the head was at each block and how it turned; book, Velodyne: Azimuth. A block without an azimuth lies
    /// between its neighbours: they have turned evenly over it. The last block (pair) has no successor and takes the gap
    /// of the one before, and so does one before a closed sector: nothing is spread over what was not measured.
    #[must_use]
    pub fn turns(&self) -> [BlockTurn; field::BLOCKS] {
        let step = if self.is_dual() { 2 } else { 1 };
        let mut turns = self.known_azimuths();
        let mut last: Option<(usize, u16)> = None;
        for at in (0..field::BLOCKS).step_by(step) {
            let Some(azimuth_cdeg) = turns.get(at).and_then(|turn| turn.azimuth_cdeg) else { continue };
            if let Some((from, last_cdeg)) = last {
                // Both are below 36,000, so the sum cannot overflow 17 bits nor underflow.
                let turned_cdeg = (u32::from(azimuth_cdeg) + 36_000 - u32::from(last_cdeg)) % 36_000;
                let steps = truncating_u32((at - from) / step);
                let gap_cdeg = truncating_u16(turned_cdeg.checked_div(steps).unwrap_or(0));
                turns.iter_mut().take(at).skip(from).for_each(|turn| turn.gap_cdeg = gap_cdeg);
            }
            last = Some((at, azimuth_cdeg));
        }
        let behind = last.map_or(0, |(from, _)| from);
        close_sectors(&mut turns, behind, self.is_dual());
        turns
    }

    /// The azimuths, without gaps; of a pair both or none.
    fn known_azimuths(&self) -> [BlockTurn; field::BLOCKS] {
        let mut turns = [BlockTurn::default(); field::BLOCKS];
        for (turn, block) in turns.iter_mut().zip(self.blocks()) {
            turn.azimuth_cdeg = (block.azimuth_cdeg < TURN_CDEG).then_some(block.azimuth_cdeg);
        }
        if self.is_dual() {
            for [first, second] in turns.as_chunks_mut::<2>().0 {
                if first.azimuth_cdeg.is_none() || second.azimuth_cdeg.is_none() {
                    (first.azimuth_cdeg, second.azimuth_cdeg) = (None, None);
                }
            }
        }
        turns
    }
}

/// Takes out of the gaps what no head turns within a block, if any other gap tells how fast the head turns. `behind` is
/// the last block (pair) with an azimuth.
fn close_sectors(turns: &mut [BlockTurn; BLOCKS], behind: usize, is_dual: bool) {
    let step = if is_dual { 2 } else { 1 };
    let known = turns.iter().take(behind).filter(|turn| turn.azimuth_cdeg.is_some());
    let even = known.map(|turn| turn.gap_cdeg).find(|gap_cdeg| *gap_cdeg <= GAP_MAX_CDEG);
    let mut previous = even;
    let mut skipped_cdeg = 0;
    for (at, turn) in turns.iter_mut().enumerate() {
        if turn.azimuth_cdeg.is_some() && at % step == 0 {
            (turn.skipped_cdeg, skipped_cdeg) = (skipped_cdeg, 0);
        }
        if at >= behind {
            turn.gap_cdeg = previous.unwrap_or(turn.gap_cdeg);
        } else if let Some(even_cdeg) = previous
            && turn.gap_cdeg > GAP_MAX_CDEG
        {
            // Both blocks of a pair stand for the same turn.
            let wider_cdeg = if at % step == 0 { turn.gap_cdeg.saturating_sub(even_cdeg) } else { 0 };
            skipped_cdeg = skipped_cdeg.saturating_add(wider_cdeg);
            turn.gap_cdeg = even_cdeg;
        } else {
            previous = previous.map(|_| turn.gap_cdeg);
        }
    }
}

impl<'a> Block<'a> {
    /// Distance (counts, 0 = no return) and reflectivity of the 32 channels.
    pub fn channels(&self) -> impl ExactSizeIterator<Item = (u16, u8)> + Clone + use<'a> {
        self.cells(0, field::CHANNELS)
            .iter()
            .map(|[low, high, reflectivity]| (u16::from_le_bytes([*low, *high]), *reflectivity))
    }

    /// The cells of some channels: distance, low byte first, and reflectivity.
    pub(super) fn cells(&self, first: usize, count: usize) -> &'a [[u8; 3]] {
        let (cells, _) = self.channels.as_chunks::<3>();
        let end = first.saturating_add(count).min(field::CHANNELS);
        cells.get(first..end).unwrap_or_default()
    }
}
