//! The checksum at the end of every frame.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// CRC-32 of Ethernet and zlib.
pub(crate) static CHECKSUM: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);
/// Bytes of the checksum.
pub(crate) const CHECKSUM_BYTES: usize = 4;

/// A checksum that does not fit its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Damage {
    /// What stands in the frame.
    pub(crate) found: u32,
    /// What its bytes come to.
    pub(crate) computed: u32,
}

/// Compares the last four bytes of a frame, little-endian, with the checksum of those before.
pub(crate) fn damage(frame: &[u8]) -> Option<Damage> {
    let (body, found) = frame.split_last_chunk::<CHECKSUM_BYTES>().unwrap_or((&[], &[0; CHECKSUM_BYTES]));
    let (found, computed) = (u32::from_le_bytes(*found), CHECKSUM.checksum(body));
    // Fewer bytes than a checksum has are damaged, whatever they are.
    (found != computed || frame.len() < CHECKSUM_BYTES).then_some(Damage { found, computed })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CRC-32 of "123456789", as the catalogue of checksums gives it.
    #[test]
    fn checksum_is_the_catalogues() {
        let mut frame = *b"123456789\0\0\0\0";
        frame[9..].copy_from_slice(&0xcbf4_3926_u32.to_le_bytes());
        assert_eq!(damage(&frame), None);
        frame[3] ^= 1;
        assert_eq!(damage(&frame).map(|damage| damage.found), Some(0xcbf4_3926));
        for length in 0..CHECKSUM_BYTES {
            assert!(damage(&[0; CHECKSUM_BYTES][..length]).is_some(), "{length} bytes");
        }
    }
}
