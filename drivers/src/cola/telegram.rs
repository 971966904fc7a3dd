//! A telegram of scan data as a checked view; of CoLa A, whose fields are words of text, numbers in hexadecimal.

/// Bytes of the longest telegram: 1,081 distances and as many strengths.
pub const TELEGRAM_BYTES: usize = 12_288;
/// Words that are passed over in one go, at most.
const SKIPPED_MAX: u16 = 8;
/// Encoders that a sensor can report.
const ENCODERS_MAX: u32 = 3;
/// The second word of a telegram of scan data.
const HEAD: &[u8] = b"LMDscandata";
/// A factor of 1, as IEEE 754.
const FACTOR_ONE: u32 = 0x3F80_0000;
/// A factor of 2: some sensors of larger range.
const FACTOR_TWO: u32 = 0x4000_0000;

/// Why a telegram gives no scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TelegramError {
    /// Another telegram, or one of another layout.
    Form,
    /// The field with this number is no number in hexadecimal, or is missing.
    Field(u16),
    /// The first channel holds no distances, or in other units than 1 or 2 mm.
    Channel,
    /// Fewer distances than it announces.
    Values {
        /// Found.
        found: u16,
        /// Announced.
        announced: u16,
    },
}

/// A checked telegram.
///
/// # Invariants
/// As many distances as announced, all of them numbers.
#[derive(Clone, Copy, Debug)]
pub struct ScanTelegram<'a> {
    /// What the sensor says of itself: bit 0 in trouble, bit 2 a window so dirty that it cannot see.
    pub status: u16,
    /// Counts scans; wraps.
    pub scan: u16,
    /// Microseconds since it was switched on, at the beginning of the turn; wraps.
    pub begun_us: u32,
    /// Angle of the first distance, ten-thousandths of a degree; 90° is straight ahead.
    pub first_angle: i32,
    /// From distance to distance, ten-thousandths of a degree.
    pub step: u16,
    /// Distances.
    pub count: u16,
    /// Millimetres a count: 1 or 2.
    pub unit_mm: u32,
    pub(super) values: Values<'a>,
}

/// Distances as they stand in the telegram.
#[derive(Clone, Copy, Debug)]
pub(super) enum Values<'a> {
    /// Words in hexadecimal.
    Text(&'a [u8]),
    /// Two bytes each, the high one first.
    Words(&'a [[u8; 2]]),
}

/// So many encoders a sensor can report.
pub(super) fn encoders_checked(encoders: u32) -> Result<usize, TelegramError> {
    usize::try_from(encoders).ok().filter(|_| encoders <= ENCODERS_MAX).ok_or(TelegramError::Form)
}

/// Millimetres a count, of a factor as IEEE 754.
pub(super) const fn unit_of(factor: u32) -> Option<u32> {
    match factor {
        FACTOR_ONE => Some(1),
        FACTOR_TWO => Some(2),
        _ => None,
    }
}

/// The words of a telegram, one after another.
struct Words<'a> {
    /// What follows the last space; `None` behind the last word.
    rest: Option<&'a [u8]>,
    taken: u16,
}

impl<'a> Words<'a> {
    const fn of(text: &'a [u8]) -> Self {
        Self { rest: Some(text), taken: 0 }
    }

    fn word(&mut self) -> Result<&'a [u8], TelegramError> {
        self.taken = self.taken.saturating_add(1);
        let rest = self.rest.ok_or(TelegramError::Field(self.taken))?;
        let space = rest.iter().take(TELEGRAM_BYTES).position(|byte| *byte == b' ');
        self.rest = space.and_then(|at| rest.get(at.saturating_add(1)..));
        Ok(space.and_then(|at| rest.get(..at)).unwrap_or(rest))
    }

    fn number(&mut self) -> Result<u32, TelegramError> {
        let word = self.word()?;
        hexadecimal(word).ok_or(TelegramError::Field(self.taken))
    }

    fn short(&mut self) -> Result<u16, TelegramError> {
        u16::try_from(self.number()?).map_err(|_| TelegramError::Field(self.taken))
    }

    fn skip(&mut self, words: u16) -> Result<(), TelegramError> {
        for _ in (0..SKIPPED_MAX).take(usize::from(words)) {
            self.word()?;
        }
        Ok(())
    }
}

/// A number of up to eight digits.
fn hexadecimal(word: &[u8]) -> Option<u32> {
    if word.is_empty() || word.len() > 8 {
        return None;
    }
    word.iter().try_fold(0_u32, |number, digit| {
        let value = match digit {
            b'0'..=b'9' => digit.checked_sub(b'0')?,
            b'A'..=b'F' => digit.checked_sub(b'A')?.checked_add(10)?,
            b'a'..=b'f' => digit.checked_sub(b'a')?.checked_add(10)?,
            _ => return None,
        };
        Some(number << 4 | u32::from(value))
    })
}

impl<'a> ScanTelegram<'a> {
    /// Checks what stands between the start and the end byte.
    ///
    /// # Errors
    /// [`TelegramError`].
    pub fn new_checked(text: &'a [u8]) -> Result<Self, TelegramError> {
        let mut words = Words::of(text);
        let kind = words.word()?;
        if !matches!(kind, b"sSN" | b"sRA") || words.word()? != HEAD {
            return Err(TelegramError::Form);
        }
        // Version, device, serial number.
        words.skip(3)?;
        let (high, low) = (words.short()?, words.short()?);
        let status = (high << 8) | (low & 0xFF);
        let _telegram = words.short()?;
        let scan = words.short()?;
        let begun_us = words.number()?;
        // Time of transmission, inputs, outputs, a reserved word, frequencies of scans and measurements.
        words.skip(8)?;
        for _ in (0..ENCODERS_MAX).take(encoders_checked(words.number()?)?) {
            words.skip(2)?;
        }
        let channels = words.number()?;
        let content = words.word()?;
        let factor = words.number()?;
        let offset = words.number()?;
        let unit_mm = unit_of(factor).filter(|_| channels > 0 && content == b"DIST1" && offset == 0);
        let unit_mm = unit_mm.ok_or(TelegramError::Channel)?;
        // Sign and magnitude are those of 32 bits.
        let first_angle = i32::from_le_bytes(words.number()?.to_le_bytes());
        let (step, count) = (words.short()?, words.short()?);
        let values = words.rest.unwrap_or_default();
        let found = values_of(values).take(usize::from(count)).take_while(Option::is_some).count();
        let found = u16::try_from(found).unwrap_or(u16::MAX);
        if found < count {
            return Err(TelegramError::Values { found, announced: count });
        }
        let values = Values::Text(values);
        Ok(Self { status, scan, begun_us, first_angle, step, count, unit_mm, values })
    }

    /// Its distances in counts, as many as announced.
    pub fn distances(&self) -> impl Iterator<Item = u32> + use<'a> {
        let (text, words) = match self.values {
            Values::Text(text) => (text, &[][..]),
            Values::Words(words) => (&[][..], words),
        };
        let of_text = values_of(text).map(|value| value.unwrap_or(0)).take(match self.values {
            Values::Text(_) => usize::from(self.count),
            Values::Words(_) => 0,
        });
        of_text.chain(words.iter().map(|word| u32::from(u16::from_be_bytes(*word))))
    }
}

fn values_of(text: &[u8]) -> impl Iterator<Item = Option<u32>> + use<'_> {
    text.split(|byte| *byte == b' ').map(hexadecimal)
}
