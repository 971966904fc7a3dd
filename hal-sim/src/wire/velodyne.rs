//! Velodyne VLP-16 data and position packets (book, Velodyne).

/// Blocks of a packet.
const BLOCKS: usize = 12;
/// Cells of a block: two firings of sixteen lasers.
const CELLS: usize = 32;
/// Bytes of a block.
const BLOCK_BYTES: usize = 100;

/// Which return the sensor reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReturnMode {
    /// The strongest echo.
    Strongest,
    /// The last and the strongest echo, in pairs of blocks.
    Dual,
}

impl ReturnMode {
    const fn byte(self) -> u8 {
        match self {
            Self::Strongest => 0x37,
            Self::Dual => 0x39,
        }
    }
}

/// A data packet under construction: 1,206 bytes.
#[derive(Clone, Debug)]
pub struct DataPacket {
    bytes: Vec<u8>,
}

impl DataPacket {
    /// An empty VLP-16 packet: every cell "no return".
    #[must_use]
    pub fn new(mode: ReturnMode, hour_us: u32) -> Self {
        let mut bytes = vec![0; BLOCKS * BLOCK_BYTES + 6];
        for block in 0..BLOCKS {
            bytes[block * BLOCK_BYTES] = 0xFF;
            bytes[block * BLOCK_BYTES + 1] = 0xEE;
        }
        bytes[1200..1204].copy_from_slice(&hour_us.to_le_bytes());
        bytes[1204] = mode.byte();
        bytes[1205] = 0x22;
        Self { bytes }
    }

    /// Sets the azimuth of a block, hundredths of a degree; reduced modulo a full turn.
    pub fn set_azimuth(&mut self, block: usize, azimuth_cdeg: u32) {
        let at = block * BLOCK_BYTES + 2;
        self.bytes[at..at + 2].copy_from_slice(&((azimuth_cdeg % 36_000) as u16).to_le_bytes());
    }

    /// Sets a cell of a block (`channel` 0..32): raw distance of 2 mm units and reflectivity.
    pub fn set_cell(&mut self, block: usize, channel: usize, raw: u16, reflectivity: u8) {
        assert!(channel < CELLS, "a block has 32 cells");
        let at = block * BLOCK_BYTES + 4 + 3 * channel;
        let [low, high] = raw.to_le_bytes();
        self.bytes[at..at + 3].copy_from_slice(&[low, high, reflectivity]);
    }

    /// The datagram.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// A position packet: microseconds of the hour, PPS state (0 absent … 3 error) and an NMEA sentence without line end.
#[must_use]
pub fn encode_position(hour_us: u32, pps: u8, sentence: &str) -> Vec<u8> {
    let mut bytes = vec![0; 512];
    bytes[198..202].copy_from_slice(&hour_us.to_le_bytes());
    bytes[202] = pps;
    let text = sentence.bytes().chain(*b"\r\n").take(128);
    for (cell, byte) in bytes.iter_mut().skip(206).zip(text) {
        *cell = byte;
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    const CRC32: fn(&[u8]) -> u32 = crate::wire::tests_crc32;

    /// A synthetic packet of the book, Velodyne: Test packets.
    #[test]
    fn single_return_vector() {
        let mut packet = DataPacket::new(ReturnMode::Strongest, 3_599_999_000);
        for block in 0..12 {
            packet.set_azimuth(block, 35_900 + 40 * block as u32);
        }
        let cells = [
            (0, 0, 500, 10),
            (0, 1, 1000, 20),
            (0, 16, 1500, 30),
            (2, 31, 2500, 255),
            (3, 15, 65535, 1),
            (5, 7, 1, 0),
            (11, 16, 5000, 100),
            (11, 31, 6000, 101),
        ];
        for (block, channel, raw, reflectivity) in cells {
            packet.set_cell(block, channel, raw, reflectivity);
        }
        let bytes = packet.into_bytes();
        assert_eq!(bytes[1200..], [0x18, 0xA0, 0x93, 0xD6, 0x37, 0x22]);
        assert_eq!(CRC32(&bytes), 0x333C_A698);
    }

    /// A synthetic packet of the book, Velodyne: Test packets.
    #[test]
    fn dual_return_vector() {
        let mut packet = DataPacket::new(ReturnMode::Dual, 0);
        for block in 0..12 {
            packet.set_azimuth(block, 9_000 + 20 * (block as u32 / 2));
        }
        let cells = [
            (0, 4, 1500, 40),
            (1, 4, 1200, 90),
            (0, 5, 800, 50),
            (1, 5, 800, 50),
            (3, 20, 700, 70),
            (10, 31, 3000, 9),
            (11, 31, 3000, 9),
        ];
        for (block, channel, raw, reflectivity) in cells {
            packet.set_cell(block, channel, raw, reflectivity);
        }
        assert_eq!(CRC32(&packet.into_bytes()), 0x960D_7C0D);
    }

    /// A position packet of the book, Velodyne: Test packets.
    #[test]
    fn position_vector() {
        let sentence = "$GPRMC,225446,A,4916.45,N,12311.12,W,000.5,054.7,191194,020.3,E*68";
        assert_eq!(CRC32(&encode_position(3_286_000_123, 2, sentence)), 0x337F_ABA2);
    }
}
