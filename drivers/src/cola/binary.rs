//! A binary telegram of scan data as a checked view: fields of fixed sizes, the high byte first.

use super::telegram::{ScanTelegram, TelegramError, Values, encoders_checked, unit_of};

/// Before the fields; the kind of message stands before it.
const HEAD: &[u8] = b" LMDscandata ";
const CONTENT: &[u8] = b"DIST1";

/// The fields of a telegram, one after another.
struct Fields<'a> {
    rest: &'a [u8],
    taken: u16,
}

impl<'a> Fields<'a> {
    fn bytes(&mut self, count: usize) -> Result<&'a [u8], TelegramError> {
        self.taken = self.taken.saturating_add(1);
        let (field, rest) = self.rest.split_at_checked(count).ok_or(TelegramError::Field(self.taken))?;
        self.rest = rest;
        Ok(field)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], TelegramError> {
        <[u8; N]>::try_from(self.bytes(N)?).map_err(|_| TelegramError::Field(self.taken))
    }

    fn short(&mut self) -> Result<u16, TelegramError> {
        self.array().map(u16::from_be_bytes)
    }

    fn number(&mut self) -> Result<u32, TelegramError> {
        self.array().map(u32::from_be_bytes)
    }
}

impl<'a> ScanTelegram<'a> {
    /// Checks what stands between length and checksum.
    ///
    /// # Errors
    /// [`TelegramError`].
    pub fn new_binary(bytes: &'a [u8]) -> Result<Self, TelegramError> {
        let mut fields = Fields { rest: bytes, taken: 0 };
        let kind = fields.bytes(3)?;
        if !matches!(kind, b"sSN" | b"sRA") || fields.bytes(HEAD.len())? != HEAD {
            return Err(TelegramError::Form);
        }
        // Version, device, serial number.
        fields.bytes(8)?;
        let [high, low] = fields.array()?;
        let status = u16::from_be_bytes([high, low]);
        let _telegram = fields.short()?;
        let scan = fields.short()?;
        let begun_us = fields.number()?;
        // Time of transmission, inputs, outputs, a reserved word, frequencies of scans and measurements.
        fields.bytes(18)?;
        let encoders = encoders_checked(u32::from(fields.short()?))?;
        // Position and speed.
        fields.bytes(encoders.saturating_mul(6))?;
        let channels = fields.short()?;
        let content = fields.bytes(CONTENT.len())?;
        let factor = fields.number()?;
        let offset = fields.number()?;
        let unit_mm = unit_of(factor).filter(|_| channels > 0 && content == CONTENT && offset == 0);
        let unit_mm = unit_mm.ok_or(TelegramError::Channel)?;
        let first_angle = fields.array().map(i32::from_be_bytes)?;
        let (step, count) = (fields.short()?, fields.short()?);
        let (words, _) = fields.rest.as_chunks::<2>();
        let values = words.get(..usize::from(count));
        let found = u16::try_from(words.len()).unwrap_or(u16::MAX);
        let values = values.ok_or(TelegramError::Values { found, announced: count })?;
        Ok(Self { status, scan, begun_us, first_angle, step, count, unit_mm, values: Values::Words(values) })
    }
}
