//! One datagram: a piece of a message with its place (book, microScan3: Datagrams).

/// Bytes of the header.
const HEADER: usize = 24;
/// Marker, protocol "MD", major version 1.
const START: [u8; 7] = *b"MS3 MD\x01";

/// Why a datagram is no piece of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FragmentError {
    /// Shorter than its header, or without content.
    Short {
        /// Bytes received.
        length: usize,
    },
    /// Marker, protocol or version is another.
    Foreign,
    /// The message claims to be longer than any can be, or empty.
    Total {
        /// Bytes claimed.
        total: u32,
    },
    /// The piece lies outside of the message that it belongs to.
    Outside {
        /// Where it begins.
        offset: u32,
        /// Bytes of the piece.
        length: usize,
        /// Bytes of the message.
        total: u32,
    },
}

impl core::fmt::Display for FragmentError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Short { length } => {
                write!(f, "scanner datagram of {length} bytes; expected more than {HEADER}")
            }
            Self::Foreign => f.write_str("no scanner datagram: does something else send to this port?"),
            Self::Total { total } => write!(f, "scanner message claims {total} bytes"),
            Self::Outside { offset, length, total } => {
                write!(f, "scanner datagram covers {offset} + {length} of {total} bytes")
            }
        }
    }
}

impl core::error::Error for FragmentError {}

/// A checked piece.
///
/// # Invariants
/// Not empty; `offset` plus its length is at most `total`, and that at most the limit it was checked with.
///
/// ```
/// use floorguard_drivers::microscan3::{Fragment, FragmentError};
///
/// let mut datagram = b"MS3 MD\x01\x00".to_vec();
/// for number in [8_u32, 77, 4, 0] {
///     datagram.extend(number.to_le_bytes());
/// }
/// datagram.extend(b"half");
/// let piece = Fragment::new_checked(&datagram, 1_000).unwrap();
/// assert_eq!((piece.identification, piece.offset, piece.total), (77, 4, 8));
/// assert_eq!(Fragment::new_checked(b"hello", 1_000), Err(FragmentError::Short { length: 5 }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fragment<'a> {
    /// Equal for all pieces of a message.
    pub identification: u32,
    /// Bytes of the whole message.
    pub total: usize,
    /// Where this piece begins.
    pub offset: usize,
    /// The piece.
    pub payload: &'a [u8],
}

impl<'a> Fragment<'a> {
    /// Checks a datagram against messages of at most `total_max` bytes.
    ///
    /// # Errors
    /// [`FragmentError`]; the datagram is of no use.
    pub fn new_checked(datagram: &'a [u8], total_max: usize) -> Result<Self, FragmentError> {
        let short = FragmentError::Short { length: datagram.len() };
        let (header, payload) = datagram.split_first_chunk::<HEADER>().ok_or(short)?;
        if !header.starts_with(&START) {
            return Err(FragmentError::Foreign);
        }
        if payload.is_empty() {
            return Err(short);
        }
        let [_, _, _, _, _, _, _, _, t0, t1, t2, t3, i0, i1, i2, i3, o0, o1, o2, o3, ..] = *header;
        let total = u32::from_le_bytes([t0, t1, t2, t3]);
        let offset = u32::from_le_bytes([o0, o1, o2, o3]);
        let whole = usize::try_from(total).ok().filter(|whole| (1..=total_max).contains(whole));
        let whole = whole.ok_or(FragmentError::Total { total })?;
        let outside = FragmentError::Outside { offset, length: payload.len(), total };
        let begin = usize::try_from(offset).map_err(|_| outside)?;
        if begin.checked_add(payload.len()).is_none_or(|end| end > whole) {
            return Err(outside);
        }
        Ok(Self {
            identification: u32::from_le_bytes([i0, i1, i2, i3]),
            total: whole,
            offset: begin,
            payload,
        })
    }
}
