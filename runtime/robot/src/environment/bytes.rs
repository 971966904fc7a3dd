//! Little-endian numbers and strings, written and read with every length checked.

use anyhow::{Context, ensure};

/// Longest string.
const STRING_MAX: usize = 4_096;

/// Writes.
#[derive(Default)]
pub struct Writer(pub Vec<u8>);

impl Writer {
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    pub fn u8(&mut self, value: u8) {
        self.0.push(value);
    }

    pub fn u16(&mut self, value: u16) {
        self.bytes(&value.to_le_bytes());
    }

    pub fn u32(&mut self, value: u32) {
        self.bytes(&value.to_le_bytes());
    }

    pub fn i64(&mut self, value: i64) {
        self.bytes(&value.to_le_bytes());
    }

    pub fn f32(&mut self, value: f32) {
        self.bytes(&value.to_le_bytes());
    }

    /// A length and the text, cut where it is too long.
    pub fn text(&mut self, text: &str) {
        let bytes = text.as_bytes();
        let bytes = &bytes[..bytes.len().min(STRING_MAX)];
        self.u16(bytes.len() as u16);
        self.bytes(bytes);
    }
}

/// Reads.
pub struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    pub fn bytes(&mut self, count: usize) -> anyhow::Result<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count).context("it ends too early")?;
        self.0 = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> anyhow::Result<[u8; N]> {
        Ok(self.bytes(N)?.try_into()?)
    }

    pub fn u8(&mut self) -> anyhow::Result<u8> {
        Ok(u8::from_le_bytes(self.array()?))
    }

    pub fn u16(&mut self) -> anyhow::Result<u16> {
        Ok(u16::from_le_bytes(self.array()?))
    }

    pub fn u32(&mut self) -> anyhow::Result<u32> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub fn i64(&mut self) -> anyhow::Result<i64> {
        Ok(i64::from_le_bytes(self.array()?))
    }

    /// A number; infinities and not-a-number are refused.
    pub fn f32(&mut self) -> anyhow::Result<f32> {
        let value = f32::from_le_bytes(self.array()?);
        ensure!(value.is_finite(), "a number is not finite");
        Ok(value)
    }

    pub fn text(&mut self) -> anyhow::Result<String> {
        let count = usize::from(self.u16()?);
        ensure!(count <= STRING_MAX, "a text is too long");
        Ok(std::str::from_utf8(self.bytes(count)?)?.to_owned())
    }
}
