//! What all frames share: the first four bytes, the checksum at the end, and fields written one after another.

use core::fmt;

use crate::link::{CHECKSUM, CHECKSUM_BYTES, Damage, damage};

/// The first two bytes of each frame, "FG".
pub(super) const MAGIC: [u8; 2] = *b"FG";
/// The only version there is.
pub(super) const VERSION: u8 = 1;
/// Third byte of the start: what the frame is.
pub(super) const REQUEST: u8 = 1;
pub(super) const PERMIT: u8 = 2;
pub(super) const MOTION: u8 = 3;
/// Bytes before the first field: magic, version, kind.
pub(super) const START_BYTES: usize = 4;

/// The longest frame, bytes: a permit.
pub const FRAME_BYTES_MAX: usize = super::permit::PERMIT_BYTES;

/// Why bytes are no frame of the kind that was expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameError {
    /// Another number of bytes: found, needed. The sender writes another format.
    Length {
        /// Bytes that came.
        found: usize,
        /// Bytes of this kind of frame.
        needed: usize,
    },
    /// The first four bytes are others: another format, version or kind.
    Start([u8; 4]),
    /// The checksum is another: damaged on the way.
    Checksum {
        /// What stands in the frame.
        found: u32,
        /// What its bytes come to.
        computed: u32,
    },
    /// A velocity that is infinite or not a number.
    NonFinite,
    /// A field outside of its range: its offset, and what stands there.
    Field {
        /// Offset in the frame, bytes.
        offset: usize,
        /// The value.
        found: u32,
    },
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { found, needed } => write!(f, "frame of {found} bytes, this kind has {needed}"),
            Self::Start(found) => {
                write!(f, "frame begins with {found:02x?}: another format, version or kind")
            }
            Self::Checksum { found, computed } => {
                write!(f, "checksum {found:08x}, the bytes come to {computed:08x}: damaged on the way")
            }
            Self::NonFinite => f.write_str("velocity is infinite or not a number"),
            Self::Field { offset, found } => {
                write!(f, "field at byte {offset} is {found}, outside of its range")
            }
        }
    }
}

impl core::error::Error for FrameError {}

/// Bytes of a whole frame of this kind; none for an unknown kind.
pub(super) const fn length_of(kind: u8) -> Option<usize> {
    match kind {
        REQUEST => Some(super::request::REQUEST_BYTES),
        PERMIT => Some(super::permit::PERMIT_BYTES),
        MOTION => Some(super::motion::MOTION_BYTES),
        _ => None,
    }
}

/// The fields of a frame, after length, start and checksum were checked.
///
/// # Errors
/// The first that is wrong.
pub(super) fn checked(bytes: &[u8], kind: u8) -> Result<Fields<'_>, FrameError> {
    let needed = length_of(kind).unwrap_or(0);
    let wrong_length = FrameError::Length { found: bytes.len(), needed };
    let start = bytes.first_chunk::<START_BYTES>().ok_or(wrong_length)?;
    let [first, second] = MAGIC;
    if *start != [first, second, VERSION, kind] {
        return Err(FrameError::Start(*start));
    }
    if bytes.len() != needed {
        return Err(wrong_length);
    }
    if let Some(Damage { found, computed }) = damage(bytes) {
        return Err(FrameError::Checksum { found, computed });
    }
    let (body, _) = bytes.split_last_chunk::<CHECKSUM_BYTES>().ok_or(wrong_length)?;
    Ok(Fields { rest: body.get(START_BYTES..).unwrap_or_default() })
}

/// Reads fields one after another; all little-endian.
pub(super) struct Fields<'a> {
    rest: &'a [u8],
}

impl<'a> Fields<'a> {
    /// The next bytes. Zeros beyond the end, which a frame of the right length does not have.
    pub fn take<const N: usize>(&mut self) -> [u8; N] {
        match self.rest.split_first_chunk::<N>() {
            Some((field, rest)) => {
                self.rest = rest;
                *field
            }
            None => [0; N],
        }
    }

    pub fn byte(&mut self) -> u8 {
        let [byte] = self.take();
        byte
    }

    pub fn short(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    pub fn word(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    pub fn long(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    pub fn number(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    /// The bytes that are left.
    pub const fn rest(&self) -> &'a [u8] {
        self.rest
    }
}

/// Writes a frame field after field.
pub(super) struct FrameWriter<const N: usize> {
    bytes: [u8; N],
    at: usize,
}

impl<const N: usize> FrameWriter<N> {
    /// A frame that begins as this kind does.
    pub fn new(kind: u8) -> Self {
        let writer = Self { bytes: [0; N], at: 0 };
        let [first, second] = MAGIC;
        writer.put([first, second, VERSION, kind])
    }

    /// The next bytes. What does not fit is left out; a frame's length is the sum of its fields.
    pub fn put<const M: usize>(mut self, field: [u8; M]) -> Self {
        let end = self.at.saturating_add(M);
        debug_assert!(end <= N, "the fields are longer than the frame");
        if let Some(place) = self.bytes.get_mut(self.at..end) {
            for (slot, byte) in place.iter_mut().zip(field) {
                *slot = byte;
            }
            self.at = end;
        }
        self
    }

    /// The frame with its checksum.
    pub fn finish(self) -> [u8; N] {
        debug_assert_eq!(self.at.saturating_add(CHECKSUM_BYTES), N, "the fields do not fill the frame");
        let sum = CHECKSUM.checksum(self.bytes.get(..self.at).unwrap_or_default());
        self.put(sum.to_le_bytes()).bytes
    }
}
