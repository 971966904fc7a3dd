//! Hesai PandarXT-16 and XT-32 data packets (book, Hesai).

/// Firings of a packet.
pub const FIRINGS: usize = 8;
const HEADER_BYTES: usize = 12;

/// A data packet of the strongest echo under construction: 568 bytes of 16 lasers, 1,080 of 32.
#[derive(Clone, Debug)]
pub struct PandarPacket {
    lasers: usize,
    bytes: Vec<u8>,
}

impl PandarPacket {
    /// An empty packet: every cell "no return". `day_us` is the sensor's time of day when the packet is complete, `sequence` its
    /// running number, at 600 turns a minute.
    #[must_use]
    pub fn new(lasers: usize, day_us: u64, sequence: u32) -> Self {
        let tail_from = HEADER_BYTES + FIRINGS * block_bytes(lasers);
        let mut bytes = vec![0; tail_from + 28];
        bytes[..HEADER_BYTES].copy_from_slice(&[0xEE, 0xFF, 6, 1, 0, 0, lasers as u8, 8, 0, 4, 1, 1]);
        let tail = &mut bytes[tail_from..];
        tail[10] = 0x37;
        tail[11..13].copy_from_slice(&600_u16.to_le_bytes());
        let seconds = day_us / 1_000_000;
        let [hour, minute, second] =
            [seconds / 3_600 % 24, seconds / 60 % 60, seconds % 60].map(|part| part as u8);
        // 2026-01-01, whatever the world's day.
        tail[13..19].copy_from_slice(&[126, 1, 1, hour, minute, second]);
        tail[19..23].copy_from_slice(&((day_us % 1_000_000) as u32).to_le_bytes());
        tail[23] = 0x42;
        tail[24..28].copy_from_slice(&sequence.to_le_bytes());
        Self { lasers, bytes }
    }

    /// Sets the azimuth of a firing, hundredths of a degree; reduced modulo a full turn.
    pub fn set_azimuth(&mut self, firing: usize, azimuth_cdeg: u32) {
        let at = HEADER_BYTES + firing * block_bytes(self.lasers);
        self.bytes[at..at + 2].copy_from_slice(&((azimuth_cdeg % 36_000) as u16).to_le_bytes());
    }

    /// Sets a cell (`channel` 0 uppermost): raw distance of 4 mm units and reflectivity.
    pub fn set_cell(&mut self, firing: usize, channel: usize, (raw, reflectivity): (u16, u8)) {
        assert!(channel < self.lasers, "a firing has a cell a laser");
        let at = HEADER_BYTES + firing * block_bytes(self.lasers) + 2 + 4 * channel;
        let [low, high] = raw.to_le_bytes();
        self.bytes[at..at + 3].copy_from_slice(&[low, high, reflectivity]);
    }

    /// The datagram.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

const fn block_bytes(lasers: usize) -> usize {
    2 + 4 * lasers
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tail of the recorded packet (book, Hesai: Sample) but for mode, date and running number.
    #[test]
    fn tail_has_the_recorded_layout() {
        let day_us = ((4 * 60 + 12) * 60 + 29) * 1_000_000 + 274_789;
        let bytes = PandarPacket::new(16, day_us, 16_209_614).into_bytes();
        assert_eq!(bytes.len(), 568);
        assert_eq!(bytes[551..553], [0x58, 0x02]);
        assert_eq!(bytes[556..], [0x04, 0x0C, 0x1D, 0x65, 0x31, 0x04, 0x00, 0x42, 0xCE, 0x56, 0xF7, 0x00]);
    }

    #[test]
    fn first_block_has_the_recorded_layout() {
        let mut packet = PandarPacket::new(16, 0, 0);
        packet.set_azimuth(0, 26_964 + 36_000);
        packet.set_cell(0, 0, (261, 0x22));
        packet.set_cell(0, 1, (260, 0x2C));
        packet.set_cell(7, 15, (1, 2));
        let bytes = packet.into_bytes();
        assert_eq!(bytes[12..22], [0x54, 0x69, 0x05, 0x01, 0x22, 0x00, 0x04, 0x01, 0x2C, 0x00]);
        assert_eq!(bytes[536..540], [0x01, 0x00, 0x02, 0x00]);
    }
}
