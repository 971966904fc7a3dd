//! The Common Data Representation that ROS 2 writes: little-endian, aligned to the size of each number.
//!
//! Source: OMG DDS-XTYPES 1.3, 7.4 (plain CDR, version 1). Alignment counts from behind the four-byte header.

/// Builds one serialised message.
pub struct Encoder {
    bytes: Vec<u8>,
}

/// Bytes of the encapsulation header: plain CDR, little-endian, no options.
const HEADER: [u8; 4] = [0, 1, 0, 0];

impl Encoder {
    /// An empty message.
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

    /// A sequence of bytes.
    pub fn octets(&mut self, octets: &[u8]) -> &mut Self {
        self.length(octets.len());
        self.bytes.extend(octets);
        self
    }

    /// The finished message.
    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::Encoder;

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
