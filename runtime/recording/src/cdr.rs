//! The Common Data Representation that ROS 2 writes: little-endian, aligned to the size of each number.
//!
//! Source: OMG DDS-XTYPES 1.3, 7.4 (plain CDR, version 1). Alignment counts from behind the four-byte header.

use floorguard_types::time::Stamp;

/// Builds one serialised message.
pub struct Encoder {
    bytes: Vec<u8>,
}

/// Bytes of the encapsulation header: plain CDR, little-endian, no options.
const HEADER: [u8; 4] = [0, 1, 0, 0];

impl Default for Encoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Encoder {
    /// An empty message.
    #[must_use]
    pub fn new() -> Self {
        Self { bytes: HEADER.to_vec() }
    }

    fn align(&mut self, size: usize) {
        let used = self.bytes.len() - HEADER.len();
        self.bytes.resize(HEADER.len() + used.next_multiple_of(size), 0);
    }

    /// One byte or truth value.
    pub fn u8(&mut self, value: u8) -> &mut Self {
        self.bytes.push(value);
        self
    }

    /// Unsigned, 32 bits.
    pub fn u32(&mut self, value: u32) -> &mut Self {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
        self
    }

    /// Signed, 32 bits.
    pub fn i32(&mut self, value: i32) -> &mut Self {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
        self
    }

    /// Single precision.
    pub fn f32(&mut self, value: f32) -> &mut Self {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
        self
    }

    /// Double precision.
    pub fn f64(&mut self, value: f64) -> &mut Self {
        self.align(8);
        self.bytes.extend(value.to_le_bytes());
        self
    }

    /// Several doubles without a length: a fixed-size array.
    pub fn f64s(&mut self, values: &[f64]) -> &mut Self {
        values.iter().for_each(|value| _ = self.f64(*value));
        self
    }

    /// The length of a sequence; its elements follow.
    pub fn length(&mut self, elements: usize) -> &mut Self {
        self.u32(u32::try_from(elements).unwrap_or(u32::MAX))
    }

    /// Text, with its length and a closing zero.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.length(text.len() + 1);
        self.bytes.extend(text.as_bytes());
        self.u8(0)
    }

    /// `builtin_interfaces/Time`: seconds and nanoseconds.
    pub fn time(&mut self, stamp: Stamp) -> &mut Self {
        let micros = stamp.as_micros();
        self.i32(i32::try_from(micros / 1_000_000).unwrap_or(i32::MAX))
            .u32((micros % 1_000_000) as u32 * 1_000)
    }

    /// A sequence of bytes.
    pub fn octets(&mut self, octets: &[u8]) -> &mut Self {
        self.length(octets.len());
        self.bytes.extend(octets);
        self
    }

    /// The finished message.
    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reads one serialised message, of either byte order. Every answer is `None` once the bytes have run out.
#[derive(Clone, Copy, Debug)]
pub struct Decoder<'a> {
    bytes: &'a [u8],
    at: usize,
    little: bool,
}

impl<'a> Decoder<'a> {
    /// `None` for anything but plain CDR.
    #[must_use]
    pub fn new(message: &'a [u8]) -> Option<Self> {
        match message.split_first_chunk::<4>()? {
            ([0, 0, ..], bytes) => Some(Self { bytes, at: 0, little: false }),
            ([0, 1, ..], bytes) => Some(Self { bytes, at: 0, little: true }),
            _ => None,
        }
    }

    /// So many bytes.
    pub fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(count)?;
        let bytes = self.bytes.get(self.at..end)?;
        self.at = end;
        Some(bytes)
    }

    fn number<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.at = self.at.checked_next_multiple_of(N)?;
        let mut bytes: [u8; N] = self.bytes(N)?.try_into().ok()?;
        if !self.little {
            bytes.reverse();
        }
        Some(bytes)
    }

    /// One byte or truth value.
    pub fn u8(&mut self) -> Option<u8> {
        self.number().map(u8::from_le_bytes)
    }

    /// Unsigned, 32 bits.
    pub fn u32(&mut self) -> Option<u32> {
        self.number().map(u32::from_le_bytes)
    }

    /// Signed, 32 bits.
    pub fn i32(&mut self) -> Option<i32> {
        self.number().map(i32::from_le_bytes)
    }

    /// Single precision.
    pub fn f32(&mut self) -> Option<f32> {
        self.number().map(f32::from_le_bytes)
    }

    /// Double precision.
    pub fn f64(&mut self) -> Option<f64> {
        self.number().map(f64::from_le_bytes)
    }

    /// A fixed-size array of doubles.
    pub fn f64s<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.f64()?;
        }
        Some(values)
    }

    /// The length of a sequence.
    pub fn length(&mut self) -> Option<usize> {
        usize::try_from(self.u32()?).ok()
    }

    /// Text; bytes that are no text are replaced.
    pub fn text(&mut self) -> Option<String> {
        let length = self.length()?;
        let bytes = self.bytes(length)?;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        Some(String::from_utf8_lossy(bytes).into_owned())
    }

    /// A sequence of bytes.
    pub fn octets(&mut self) -> Option<&'a [u8]> {
        let length = self.length()?;
        self.bytes(length)
    }

    /// A sequence of singles. Its length is believed only as far as there are bytes.
    pub fn singles(&mut self) -> Option<Vec<f32>> {
        let length = self.length()?;
        (0..length).map(|_| self.f32()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Decoder, Encoder};

    #[test]
    fn what_is_written_is_read_and_never_more() {
        let mut encoder = Encoder::new();
        encoder.u8(7).u32(1).text("ab").f64(1.5).octets(&[1, 2, 3]).f32(2.5);
        let bytes = encoder.finish();
        let read = |bytes: &[u8]| {
            let mut decoder = Decoder::new(bytes)?;
            let head = (decoder.u8()?, decoder.u32()?, decoder.text()?);
            Some((head, decoder.f64()?, decoder.octets()?.to_vec(), decoder.f32()?))
        };
        assert_eq!(read(&bytes), Some(((7, 1, "ab".to_owned()), 1.5, vec![1, 2, 3], 2.5)));
        for cut in 0..bytes.len() {
            assert_eq!(read(&bytes[..cut]), None, "cut at {cut}");
        }
    }

    #[test]
    fn big_endian_numbers_are_turned() {
        let mut decoder = Decoder::new(&[0, 0, 0, 0, 0, 0, 1, 2]).unwrap();
        assert_eq!(decoder.u32(), Some(258));
    }

    #[test]
    fn aligns_each_number_to_its_size() {
        let mut encoder = Encoder::new();
        encoder.u8(7).u32(1).text("ab").f64(1.0);
        let bytes = encoder.finish();
        assert_eq!(bytes[..12], [0, 1, 0, 0, 7, 0, 0, 0, 1, 0, 0, 0]);
        assert_eq!(bytes[12..19], [3, 0, 0, 0, b'a', b'b', 0]);
        assert_eq!(bytes[20..28], 1.0f64.to_le_bytes());
    }
}
