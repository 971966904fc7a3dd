//! Scans of any scanner as a bridge sends them (book, Scan link).

use super::lidar_link::crc32;

/// Beams of each datagram but the last.
const BEAMS_A_DATAGRAM: usize = 700;
/// With what each begins.
pub const SCAN_START: &[u8] = b"FG\x01\x05";
/// Bytes before the ranges.
pub const SCAN_HEAD_BYTES: usize = 36;
/// Bytes of the checksum.
pub const LINK_CRC_BYTES: usize = 4;

/// What describes a scan beside its ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScanNote {
    /// Who sends.
    pub sender: u32,
    /// One more with each scan.
    pub sequence: u32,
    /// The sender's clock at the first beam, microseconds.
    pub first_beam_us: u64,
    /// Angle of the first beam and from beam to beam, counter-clockwise, millionths of a degree.
    pub angles_udeg: (i32, u32),
    /// From beam to beam, nanoseconds.
    pub between_ns: i32,
}

/// The datagrams of a scan; millimetres, 0 where nothing came back.
#[must_use]
pub fn scan_link_datagrams(note: &ScanNote, ranges_mm: &[u16]) -> Vec<Vec<u8>> {
    let parts: Vec<&[u16]> = ranges_mm.chunks(BEAMS_A_DATAGRAM).collect();
    let (first_udeg, step_udeg) = note.angles_udeg;
    let datagram = |(number, part): (usize, &&[u16])| {
        let mut bytes = SCAN_START.to_vec();
        bytes.extend(note.sender.to_le_bytes());
        bytes.extend(note.sequence.to_le_bytes());
        bytes.extend(note.first_beam_us.to_le_bytes());
        bytes.extend(first_udeg.to_le_bytes());
        bytes.extend(step_udeg.to_le_bytes());
        bytes.extend(note.between_ns.to_le_bytes());
        bytes.extend((ranges_mm.len() as u16).to_le_bytes());
        bytes.extend([number as u8, parts.len() as u8]);
        bytes.extend(part.iter().flat_map(|range_mm| range_mm.to_le_bytes()));
        let checksum = crc32(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    };
    parts.iter().enumerate().map(datagram).collect()
}

/// Makes the checksum of a link's datagram good again.
pub fn reseal_link(bytes: &mut [u8]) {
    let end = bytes.len() - LINK_CRC_BYTES;
    let checksum = crc32(&bytes[..end]);
    bytes[end..].copy_from_slice(&checksum.to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the reference encoder in Python prints.
    #[test]
    fn datagram_equals_that_of_the_reference() {
        let note = ScanNote {
            sender: 7,
            sequence: 42,
            first_beam_us: 1_000_000_123,
            angles_udeg: (-20_000_000, 10_000_000),
            between_ns: 125_000,
        };
        let datagrams = scan_link_datagrams(&note, &[1_000, 0, 1_001, 30_000, 65_535]);
        let hex: String = datagrams.concat().iter().map(|byte| format!("{byte:02x}")).collect();
        let printed = "46470105070000002a0000007bca9a3b0000000000d3cefe8096980048e8010005000001e8030000e9033075ffff45adad4e";
        assert_eq!(hex, printed);
    }
}
