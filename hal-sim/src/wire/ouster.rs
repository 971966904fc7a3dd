//! Ouster lidar packets (book, Ouster: Lidar packet).

const AROUND_BYTES: usize = 32;

/// How an Ouster packs its pixels (book, Ouster: Lidar packet).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OusterFormat {
    /// `LEGACY`.
    Legacy,
    /// `RNG19_RFL8_SIG16_NIR16`.
    Single,
    /// `RNG19_RFL8_SIG16_NIR16_DUAL`.
    Dual,
    /// `RNG15_RFL8_NIR8`.
    LowRate,
}

/// A lidar packet under construction: every column measured, without a return.
#[derive(Clone, Debug)]
pub struct OusterPacket {
    format: OusterFormat,
    channels: usize,
    frame: u16,
    bytes: Vec<u8>,
}

impl OusterPacket {
    /// A packet of so many columns of so many beams, of a turn with that number.
    #[must_use]
    pub fn new(format: OusterFormat, (columns, channels): (usize, usize), frame: u16) -> Self {
        let around = if format == OusterFormat::Legacy { 0 } else { AROUND_BYTES };
        let mut packet = Self { format, channels, frame, bytes: Vec::new() };
        packet.bytes = vec![0; 2 * around + columns * packet.column_bytes()];
        if format != OusterFormat::Legacy {
            packet.bytes[..2].copy_from_slice(&1_u16.to_le_bytes());
            packet.bytes[2..4].copy_from_slice(&frame.to_le_bytes());
        }
        packet
    }

    fn pixel_bytes(&self) -> usize {
        match self.format {
            OusterFormat::Legacy | OusterFormat::Single => 12,
            OusterFormat::Dual => 16,
            OusterFormat::LowRate => 4,
        }
    }

    fn column_bytes(&self) -> usize {
        let around = if self.format == OusterFormat::Legacy { 16 + 4 } else { 12 };
        around + self.channels * self.pixel_bytes()
    }

    fn column_at(&mut self, index: usize) -> &mut [u8] {
        let before = if self.format == OusterFormat::Legacy { 0 } else { AROUND_BYTES };
        let size = self.column_bytes();
        &mut self.bytes[before + index * size..][..size]
    }

    /// Sets the head of a column: the sensor's clock and the column's number within the turn.
    pub fn set_column(&mut self, index: usize, sensor_ns: u64, measurement: u16) {
        let (format, frame) = (self.format, self.frame);
        let column = self.column_at(index);
        column[..8].copy_from_slice(&sensor_ns.to_le_bytes());
        column[8..10].copy_from_slice(&measurement.to_le_bytes());
        if format == OusterFormat::Legacy {
            column[10..12].copy_from_slice(&frame.to_le_bytes());
            let end = column.len();
            column[end - 4..].copy_from_slice(&[0xFF; 4]);
        } else {
            column[10] = 1;
        }
    }

    /// Sets a pixel: millimetres and reflectivity; of two echoes the only one.
    pub fn set_pixel(&mut self, (index, channel): (usize, usize), range_mm: u32, reflectivity: u8) {
        let (format, size) = (self.format, self.pixel_bytes());
        let before = if format == OusterFormat::Legacy { 16 } else { 12 };
        let pixel = &mut self.column_at(index)[before + channel * size..][..size];
        match format {
            OusterFormat::Legacy | OusterFormat::Single => {
                pixel[..4].copy_from_slice(&range_mm.min(0x7_FFFF).to_le_bytes());
                pixel[4] = reflectivity;
            }
            OusterFormat::Dual => {
                pixel[..4].copy_from_slice(&range_mm.min(0x7_FFFF).to_le_bytes());
                pixel[3] = reflectivity;
            }
            OusterFormat::LowRate => {
                pixel[..2].copy_from_slice(&((range_mm / 8).min(0x7FFF) as u16).to_le_bytes());
                pixel[2] = reflectivity;
            }
        }
    }

    /// The datagram. The checksum at the end of the newer formats stays 0: no receiver here asks for it.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first bytes of a packet that the maker's library wrote, and its length.
    #[test]
    fn packets_begin_as_those_of_the_library() {
        let bytes = |format| {
            let mut packet = OusterPacket::new(format, (16, 16), 77);
            packet.set_column(0, 1_003_124_992, 16);
            packet.set_pixel((0, 0), 9_408, 16);
            packet.into_bytes()
        };
        let legacy = bytes(OusterFormat::Legacy);
        let head =
            [0x00, 0x79, 0xCA, 0x3B, 0, 0, 0, 0, 0x10, 0, 0x4D, 0, 0, 0, 0, 0, 0xC0, 0x24, 0, 0, 0x10, 0];
        assert_eq!((legacy.len(), &legacy[..22]), (3_392, &head[..]));
        let head = [0x00, 0x79, 0xCA, 0x3B, 0, 0, 0, 0, 0x10, 0, 1, 0, 0xC0, 0x24, 0];
        for (format, length, behind) in
            [(OusterFormat::Single, 3_328, [0, 0x10]), (OusterFormat::Dual, 4_352, [0x10, 0])]
        {
            let bytes = bytes(format);
            assert_eq!((bytes.len(), &bytes[..4], &bytes[32..47]), (length, &[1, 0, 0x4D, 0][..], &head[..]));
            assert_eq!(bytes[47..49], behind);
        }
        let low = bytes(OusterFormat::LowRate);
        assert_eq!((low.len(), &low[44..47]), (1_280, &[0x98, 0x04, 0x10][..]));
    }
}
