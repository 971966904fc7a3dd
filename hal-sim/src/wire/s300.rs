//! SICK S300 continuous data telegrams (book, SICK S300).

/// Words of a full scan: 270° in steps of 0.5°.
pub const BEAMS: usize = 541;

/// One measured scan: 13 bits of centimetres and three flags a beam.
pub type ScanWords = [u16; BEAMS];

/// What precedes the measured words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TelegramHeader {
    /// 0x0102 sizes by rule A, 0x0103 by rule B (book, SICK S300: Size field).
    pub version: u16,
    /// 0 normal, 1 lock-out.
    pub status: u16,
    /// Counts scans.
    pub scan: u32,
    /// Counts telegrams.
    pub telegram: u16,
}

/// CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, nothing reflected.
fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc, byte| {
        (0..8).fold(crc ^ (u16::from(*byte) << 8), |crc, _| {
            if crc & 0x8000 != 0 { (crc << 1) ^ 0x1021 } else { crc << 1 }
        })
    })
}

/// A telegram with one field of measured values.
#[must_use]
pub fn encode_telegram(header: TelegramHeader, words: &[u16]) -> Vec<u8> {
    let total = 24 + 2 * words.len() + 2;
    let excluded = if header.version == 0x0103 { 8 } else { 4 };
    let size = ((total - excluded) / 2) as u16;
    let mut bytes = vec![0; 6];
    bytes.extend(size.to_be_bytes());
    bytes.extend([0xFF, 0x07]);
    bytes.extend(header.version.to_be_bytes().iter().rev());
    bytes.extend(header.status.to_le_bytes());
    bytes.extend(header.scan.to_le_bytes());
    bytes.extend(header.telegram.to_le_bytes());
    bytes.extend([0xBB, 0xBB, 0x11, 0x11]);
    bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    let crc = crc16(&bytes[4..]);
    bytes.extend(crc.to_le_bytes());
    bytes
}

/// Makes the checksum of a telegram right again after a change.
pub fn reseal_telegram(bytes: &mut [u8]) {
    let Some(end) = bytes.len().checked_sub(2).filter(|end| *end > 4) else { return };
    let crc = crc16(&bytes[4..end]);
    bytes[end..].copy_from_slice(&crc.to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::tests_crc32;

    /// Telegrams S1, S2 and S4 of the book, SICK S300: Test telegrams.
    #[test]
    fn whole_telegrams_equal_the_vectors() {
        let rising: Vec<u16> = (0..541).collect();
        let s1 = TelegramHeader { version: 0x0102, status: 0, scan: 0x1234_5678, telegram: 0x9ABC };
        assert_eq!(tests_crc32(&encode_telegram(s1, &rising)), 0x0980_A368);
        let high: Vec<u16> = (1000..1541).collect();
        let s2 = TelegramHeader { version: 0x0103, status: 0, scan: 0x100, telegram: 7 };
        assert_eq!(tests_crc32(&encode_telegram(s2, &high)), 0x55E2_CA09);
        let s4 = TelegramHeader { version: 0x0103, status: 0, scan: 5, telegram: 5 };
        assert_eq!(tests_crc32(&encode_telegram(s4, &[0x4004; 541])), 0xF9FF_9006);
    }

    /// Telegram S6 of the book, SICK S300: Test telegrams: lock-out.
    #[test]
    fn short_lock_out_telegram_equals_the_vector() {
        let header = TelegramHeader { version: 0x0102, status: 1, scan: 42, telegram: 43 };
        let bytes = encode_telegram(header, &[100, 0x20C8, 0x412C, 0x8190, 0x1FFF]);
        assert_eq!(bytes[34..], [0xA1, 0xBE]);
        assert_eq!(bytes[..12], [0, 0, 0, 0, 0, 0, 0, 0x10, 0xFF, 7, 2, 1]);
    }
}
