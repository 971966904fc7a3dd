//! Columns of any lidar as a bridge sends them (book, Lidar link).

/// A datagram under construction.
#[derive(Clone, Debug)]
pub struct ColumnsDatagram {
    bytes: Vec<u8>,
}

impl ColumnsDatagram {
    /// Without a column; the sender's clock at its first one, microseconds. 4 mm a count.
    #[must_use]
    pub fn new((sender, sequence): (u32, u32), sent_us: u64, rings: u8) -> Self {
        let mut bytes = vec![b'F', b'G', 1, 4];
        bytes.extend(sender.to_le_bytes());
        bytes.extend(sequence.to_le_bytes());
        bytes.extend(sent_us.to_le_bytes());
        bytes.extend([rings, 0, 4, 0]);
        Self { bytes }
    }

    /// Appends a column: azimuth in hundredths of a degree, microseconds after the first, and each ring's counts and reflectivity.
    pub fn column(&mut self, azimuth_cdeg: u16, offset_us: u16, cells: &[(u16, u8)]) {
        self.bytes[21] += 1;
        self.bytes.extend(azimuth_cdeg.to_le_bytes());
        self.bytes.extend(offset_us.to_le_bytes());
        for (counts, reflectivity) in cells {
            self.bytes.extend(counts.to_le_bytes());
            self.bytes.push(*reflectivity);
        }
    }

    /// With its checksum.
    #[must_use]
    pub fn into_bytes(mut self) -> Vec<u8> {
        let checksum = crc32(&self.bytes);
        self.bytes.extend(checksum.to_le_bytes());
        self.bytes
    }
}

/// zlib CRC-32, bit by bit.
pub(super) fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 },
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the reference encoder in Python prints.
    #[test]
    fn datagram_equals_that_of_the_reference() {
        let mut datagram = ColumnsDatagram::new((7, 42), 1_000_000_123, 2);
        datagram.column(35_980, 0, &[(250, 10), (0, 0)]);
        datagram.column(0, 98, &[(251, 11), (65_535, 255)]);
        let hex: String = datagram.into_bytes().iter().map(|byte| format!("{byte:02x}")).collect();
        let printed = "46470104070000002a0000007bca9a3b00000000020204008c8c0000fa000a00000000006200fb000bffffffbc3ca287";
        assert_eq!(hex, printed);
    }
}
