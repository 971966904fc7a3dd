//! One telegram as a checked view, and the three ways in which its size is written.

use crc::{CRC_16_IBM_3740, Crc, Table};

/// Positions in the telegram; book, SICK S300: Telegram.
pub(super) mod field {
    /// Header and data block number: all zero in continuous mode.
    pub const ZEROS: usize = 6;
    /// Up to and including the protocol version.
    pub const VERSION_END: usize = 12;
    /// The measured words begin here.
    pub const VALUES: usize = 24;
    /// Longest telegram: 600 words by the longest rule.
    pub const LONGEST: usize = 14 + 2 * 600;
    /// Shortest: no measured word.
    pub const SHORTEST: usize = 26;
    /// Words that a plausible size field may claim.
    pub const WORDS: core::ops::RangeInclusive<u16> = 11..=600;
}

/// CRC-16/CCITT-FALSE, which the catalogue calls IBM 3740.
static CHECKSUM: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_3740);

/// Everything behind the first four bytes, up to the checksum, is covered by it.
pub(super) const UNCOVERED: usize = 4;

/// A checksum that grows with the bytes that arrive, so that little is left to do for the last of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct RunningSum {
    /// Bytes of the telegram that were examined.
    length: usize,
    sum: u16,
}

impl RunningSum {
    pub(super) const START: Self = Self { length: UNCOVERED, sum: CRC_16_IBM_3740.init };

    /// Takes in the telegram up to `length` bytes, as far as it is there.
    pub(super) fn extend(&mut self, telegram: &[u8], length: usize) {
        let length = length.min(telegram.len());
        if length < self.length {
            *self = Self::START;
        }
        if let Some(fresh) = telegram.get(self.length..length) {
            (self.sum, self.length) = (continued(self.sum, fresh), length);
        }
    }

    /// The checksum of a whole telegram is right.
    pub(super) fn confirms(&mut self, telegram: &[u8]) -> bool {
        let Some((body, wanted)) = telegram.split_last_chunk::<2>() else { return false };
        self.extend(telegram, body.len());
        self.length == body.len() && self.sum == u16::from_le_bytes(*wanted)
    }
}

/// A checksum, gone on with more bytes: neither reflected nor inverted at its end, what it gives can be its beginning.
/// Byte by byte, so that the loop is this one and its bound the length of the telegram.
fn continued(sum: u16, fresh: &[u8]) -> u16 {
    let mut digest = CHECKSUM.digest_with_initial(sum);
    for byte in fresh {
        digest.update(core::slice::from_ref(byte));
    }
    digest.finalize()
}

/// A telegram whose checksum is right but whose content is of no use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TelegramError {
    /// Not measured values: I/O data or reflectors.
    Block {
        /// Block identifier.
        found: u16,
    },
    /// Another number of values than configured.
    Values {
        /// Words received, with the markers between fields.
        found: usize,
        /// Words expected.
        expected: usize,
    },
    /// The scanner is locked out: its data are not usable.
    LockOut {
        /// Status word.
        status: u16,
    },
}

impl core::fmt::Display for TelegramError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Block { found } => {
                write!(f, "scanner sends block {found:04X}; configure measured values (BBBB) only")
            }
            Self::Values { found, expected } => {
                write!(f, "scanner sends {found} words, {expected} are configured; check its fields")
            }
            Self::LockOut { status } => {
                write!(f, "scanner is locked out (status {status}); it needs a reset")
            }
        }
    }
}

impl core::error::Error for TelegramError {}

/// A telegram with a right checksum.
///
/// # Invariants
/// At least 26 bytes, an even number of them.
///
/// ```
/// use floorguard_drivers::s300::Telegram;
///
/// // The wrong length, the wrong marks or the wrong checksum: no telegram.
/// assert!(Telegram::new_checked(&[0; 90]).is_none());
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Telegram<'a> {
    bytes: &'a [u8],
}

/// Bytes from the header to the checksum for each reading of a size field of `words`, shortest first; book, SICK S300:
/// Size field.
pub(super) fn candidate_lengths(version: u16, words: u16) -> [Option<usize>; 3] {
    let doubled = 2 * usize::from(words);
    let newer = version == 0x0103;
    [4, 8, 14].map(|extra| {
        let length = doubled + extra;
        let fits = (field::SHORTEST..=field::LONGEST).contains(&length);
        (fits && (newer || extra == 4)).then_some(length)
    })
}

impl<'a> Telegram<'a> {
    /// Checks the sum over everything behind the first four bytes.
    #[must_use]
    pub fn new_checked(bytes: &'a [u8]) -> Option<Self> {
        let (body, sum) = bytes.split_last_chunk::<2>()?;
        let covered = body.get(UNCOVERED..)?;
        let whole = bytes.len() >= field::SHORTEST && bytes.len().is_multiple_of(2);
        (whole && CHECKSUM.checksum(covered) == u16::from_le_bytes(*sum)).then_some(Self { bytes })
    }

    /// A telegram whose checksum was found right and whose length is one of [`candidate_lengths`].
    pub(super) const fn confirmed(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    fn word(&self, at: usize) -> u16 {
        let pair = self.bytes.get(at..).and_then(|rest| rest.first_chunk::<2>()).copied();
        u16::from_le_bytes(pair.unwrap_or_default())
    }

    /// 0x0102, 0x0103, or 0x0100 from an old S3000.
    #[must_use]
    pub fn version(&self) -> u16 {
        self.word(10)
    }

    /// 0 normal, 1 lock-out.
    #[must_use]
    pub fn status(&self) -> u16 {
        self.word(12)
    }

    /// Rises by one with each scan.
    #[must_use]
    pub fn scan_number(&self) -> u32 {
        u32::from(self.word(14)) | u32::from(self.word(16)) << 16
    }

    /// Rises by one with each telegram.
    #[must_use]
    pub fn telegram_number(&self) -> u16 {
        self.word(18)
    }

    /// 0xBBBB for measured values.
    #[must_use]
    pub fn block(&self) -> u16 {
        self.word(20)
    }

    /// The measured words as they stand on the wire, low byte first, with the markers between fields.
    pub(super) fn values(&self) -> &'a [[u8; 2]] {
        let end = self.bytes.len().saturating_sub(2);
        let (values, _) = self.bytes.get(field::VALUES..end).unwrap_or_default().as_chunks::<2>();
        values
    }

    /// The measured words, with the markers between fields.
    pub fn words(&self) -> impl ExactSizeIterator<Item = u16> + Clone + use<'a> {
        self.values().iter().map(|pair| u16::from_le_bytes(*pair))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_fit_in_both_protocol_versions() {
        assert_eq!(candidate_lengths(0x0103, 541), [Some(1_086), Some(1_090), Some(1_096)]);
        assert_eq!(candidate_lengths(0x0102, 541), [Some(1_086), None, None]);
        assert_eq!(candidate_lengths(0x0103, 0), [None; 3]);
        assert_eq!(candidate_lengths(0x0102, 0), [None; 3]);
        assert_eq!(candidate_lengths(0x0103, 600), [Some(1_204), Some(1_208), Some(1_214)]);
        assert_eq!(candidate_lengths(0x0103, 605), [Some(1_214), None, None]);
    }

    /// Bytes with a right checksum behind them.
    fn summed<const N: usize>(seed: u8) -> [u8; N] {
        let mut bytes = [0; N];
        bytes.iter_mut().enumerate().for_each(|(index, byte)| *byte = seed.wrapping_mul(index as u8 ^ 0x5A));
        let sum = CHECKSUM.checksum(&bytes[UNCOVERED..N - 2]).to_le_bytes();
        bytes[N - 2..].copy_from_slice(&sum);
        bytes
    }

    #[test]
    fn short_or_odd_bytes_are_no_telegram() {
        assert!(Telegram::new_checked(&summed::<26>(3)).is_some());
        assert!(Telegram::new_checked(&summed::<24>(3)).is_none());
        assert!(Telegram::new_checked(&summed::<27>(3)).is_none());
    }

    /// A buffer whose beginning was dropped holds another telegram, and a shorter one.
    #[test]
    fn running_checksum_restarts_for_shorter_telegram() {
        let (long, short) = (summed::<60>(3), summed::<30>(7));
        let mut sum = RunningSum::START;
        sum.extend(&long, 20);
        assert!(sum.confirms(&long));
        assert!(sum.confirms(&short));
        assert!(!sum.confirms(&summed::<30>(9).map(|byte| byte ^ 1)));
    }
}
