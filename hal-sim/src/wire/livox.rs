//! Points as a Livox Mid-360 sends them (book, Livox).

use super::lidar_link::crc32;

/// A datagram of points under construction.
#[derive(Clone, Debug)]
pub struct LivoxDatagram {
    bytes: Vec<u8>,
}

impl LivoxDatagram {
    /// Without a point; the sensor's clock at the first one, nanoseconds, and the number of the datagram.
    #[must_use]
    pub fn new(time_ns: u64, number: u16) -> Self {
        let mut bytes = vec![0_u8; 36];
        bytes[7..9].copy_from_slice(&number.to_le_bytes());
        // Three coordinates of 32 bits.
        bytes[10] = 1;
        bytes[28..].copy_from_slice(&time_ns.to_le_bytes());
        Self { bytes }
    }

    /// Appends a point: forward, left, up, millimetres; all 0 where nothing came back.
    pub fn point(&mut self, at_mm: [i32; 3], reflectivity: u8) {
        for coordinate in at_mm {
            self.bytes.extend(coordinate.to_le_bytes());
        }
        self.bytes.extend([reflectivity, 0]);
    }

    /// With lengths and checksum; from the first to the last point it took so long, nanoseconds.
    #[must_use]
    pub fn into_bytes(mut self, duration_ns: u64) -> Vec<u8> {
        let points = ((self.bytes.len() - 36) / 14) as u16;
        let length = self.bytes.len() as u16;
        self.bytes[1..3].copy_from_slice(&length.to_le_bytes());
        self.bytes[3..5].copy_from_slice(&((duration_ns / 100) as u16).to_le_bytes());
        self.bytes[5..7].copy_from_slice(&points.to_le_bytes());
        let checksum = crc32(&self.bytes[28..]);
        self.bytes[24..28].copy_from_slice(&checksum.to_le_bytes());
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the maker's own structures and checksum give (Livox-SDK2 at commit 08f523c), but for the kind of time in byte 11.
    #[test]
    fn datagram_equals_that_of_the_maker() {
        let mut datagram = LivoxDatagram::new(1_700_000_000_123_456_789, 513);
        datagram.point([2_000, -1_000, 70], 9);
        datagram.point([-3_000, 0, -210], 255);
        datagram.point([0, 0, 0], 0);
        let mut bytes = datagram.into_bytes(10_000);
        let made = "004e006400030001020001010000000000000000000000007e81e57615cd853dfe9c9717d007000018fcffff46000000090048f4\
                    ffff000000002effffffff100000000000000000000000000000";
        // The maker's second point has a tag, which is part of the checksum.
        bytes[36 + 27] = 16;
        bytes[11] = 1;
        let checksum = crc32(&bytes[28..]);
        bytes[24..28].copy_from_slice(&checksum.to_le_bytes());
        let hex: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(hex, made);
    }
}
