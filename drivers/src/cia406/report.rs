//! The process data object that an encoder is configured to send: position, then speed.

/// What [`EncoderReport::MAPPING`] carries.
///
/// ```
/// use floorguard_drivers::cia406::EncoderReport;
///
/// let report = EncoderReport::decode(&[0x78, 0x56, 0x34, 0x12, 0x9C, 0xFF]).unwrap();
/// assert_eq!((report.position, report.speed), (305_419_896, -100));
/// assert_eq!(EncoderReport::decode(&[0x78, 0x56]), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderReport {
    /// 6004h: 0 … measuring range − 1, counts.
    pub position: u32,
    /// 6030h.1, in the unit that is set in the encoder.
    pub speed: i16,
}

impl EncoderReport {
    /// The objects, as written to 1A00h.
    pub const MAPPING: [u32; 2] = [0x6004_0020, 0x6030_0110];

    /// From the payload; `None` when it is shorter than the mapping. A longer one is accepted (book, CANopen: Process
    /// data).
    #[must_use]
    pub const fn decode(payload: &[u8]) -> Option<Self> {
        let &[a, b, c, d, low, high, ..] = payload else { return None };
        Some(Self { position: u32::from_le_bytes([a, b, c, d]), speed: i16::from_le_bytes([low, high]) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Node 20h of the book, CANopen: CiA 406 encoders.
    #[test]
    fn published_vector() {
        let payload = [0x78, 0x56, 0x34, 0x12, 0x9C, 0xFF, 0xAA];
        let report = EncoderReport { position: 305_419_896, speed: -100 };
        assert_eq!(EncoderReport::decode(&payload), Some(report));
        assert_eq!(EncoderReport::decode(&payload[..6]), Some(report));
        for short in 0..6 {
            assert_eq!(EncoderReport::decode(&payload[..short]), None);
        }
    }
}
