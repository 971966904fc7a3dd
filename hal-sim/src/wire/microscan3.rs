//! Measured data of the microScan3 family: a message of 52 bytes and blocks, cut into datagrams (book, microScan3).

/// Bytes before the piece of a message in a datagram.
pub const DATAGRAM_HEADER: usize = 24;
/// Where the blocks begin: the message header, and the state, configuration and count before the first beam.
pub const BEAMS_FROM: usize = 52 + STATUS_BYTES + CONFIGURATION_BYTES + 4;
/// A beam: distance, strength, status.
pub const BEAM_BYTES: usize = 4;
/// Content of an Ethernet frame, less what IP, UDP and the datagram's own header take.
const PIECE_BYTES: usize = 1_448;
const STATUS_BYTES: usize = 16;
const CONFIGURATION_BYTES: usize = 24;
/// Angles are sent in this part of a degree.
const ANGLE_PER_DEG: f64 = 4_194_304.0;

/// What a device does, byte 0 of its state.
pub const RUNS: u8 = 0x01;
/// The same.
pub const STANDS_BY: u8 = 0x02;
/// Byte 15 of its state.
pub const DEVICE_ERROR: u8 = 0x02;

/// One beam.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeamWords {
    /// Millimetres.
    pub distance_mm: u16,
    /// Strength.
    pub strength: u8,
    /// Bits 0 valid, 1 infinite, 2 glare, 3 reflector, 4 contamination, 5 contamination warning.
    pub status: u8,
}

/// What precedes the beams.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MessageHeader {
    /// Counts messages and scans.
    pub number: u32,
    /// [`RUNS`], [`STANDS_BY`].
    pub state: u8,
    /// 0 or [`DEVICE_ERROR`].
    pub errors: u8,
    /// Angle of the first beam in the device's polar frame, degrees.
    pub first_deg: f64,
    /// Angle between beams, degrees.
    pub step_deg: f64,
    /// A turn of the mirror, milliseconds.
    pub scan_ms: u16,
    /// From beam to beam, microseconds.
    pub beam_us: u32,
}

/// A message with all of its blocks but intrusion and application.
#[must_use]
pub fn encode_scan_message(header: &MessageHeader, beams: &[BeamWords]) -> Vec<u8> {
    let mut bytes = vec![0; 52];
    bytes[..4].copy_from_slice(b"V\x01\x02\x03");
    bytes[16..20].copy_from_slice(&header.number.to_le_bytes());
    bytes[20..24].copy_from_slice(&header.number.to_le_bytes());
    let mut status = [0; STATUS_BYTES];
    status[0] = header.state;
    status[15] = header.errors;
    let mut configuration = Vec::with_capacity(CONFIGURATION_BYTES);
    configuration.extend(1_u16.to_le_bytes());
    configuration.extend((beams.len() as u16).to_le_bytes());
    configuration.extend(header.scan_ms.to_le_bytes());
    configuration.extend([0; 2]);
    for angle_deg in [header.first_deg, header.step_deg] {
        configuration.extend(((angle_deg * ANGLE_PER_DEG).round() as i32).to_le_bytes());
    }
    configuration.extend(header.beam_us.to_le_bytes());
    configuration.extend([0; 4]);
    let mut measured = (beams.len() as u32).to_le_bytes().to_vec();
    for beam in beams {
        measured.extend(beam.distance_mm.to_le_bytes());
        measured.extend([beam.strength, beam.status]);
    }
    for (place, block) in [(32, &status[..]), (36, &configuration), (40, &measured)] {
        let (offset, size) = (bytes.len() as u16, block.len() as u16);
        bytes[place..place + 2].copy_from_slice(&offset.to_le_bytes());
        bytes[place + 2..place + 4].copy_from_slice(&size.to_le_bytes());
        bytes.extend(block);
    }
    bytes
}

/// The datagrams of a message.
#[must_use]
pub fn scan_datagrams(message: &[u8], identification: u32) -> Vec<Vec<u8>> {
    let pieces = message.chunks(PIECE_BYTES).enumerate().map(|(index, piece)| {
        let mut datagram = b"MS3 MD\x01\x00".to_vec();
        let offset = (index * PIECE_BYTES) as u32;
        for number in [message.len() as u32, identification, offset, 0] {
            datagram.extend(number.to_le_bytes());
        }
        datagram.extend(piece);
        datagram
    });
    pieces.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The blocks of the test message (book, microScan3: Test message) that this encoder writes; the vector's message
    /// has others between them.
    #[test]
    fn blocks_equal_the_vector() {
        let header = MessageHeader {
            number: 4_712,
            state: RUNS,
            errors: 0,
            first_deg: -47.5,
            step_deg: 0.1,
            scan_ms: 40,
            beam_us: 37,
        };
        let beam = |distance_mm, strength, status| BeamWords { distance_mm, strength, status };
        let beams =
            [beam(1_000, 50, 1), beam(2_000, 60, 9), beam(0, 0, 2), beam(40_000, 255, 5), beam(300, 7, 0x31)];
        let message = encode_scan_message(&header, &beams);
        let configuration = &message[52 + STATUS_BYTES..][..20];
        // The vector's own step is a part of 4,194,304 less: 0.0999999.
        let expected =
            [1, 0, 5, 0, 40, 0, 0, 0, 0x00, 0x00, 0x20, 0xF4, 0x66, 0x66, 0x06, 0x00, 0x25, 0, 0, 0];
        assert_eq!(configuration, expected);
        let expected =
            [0xE8, 3, 0x32, 1, 0xD0, 7, 0x3C, 9, 0, 0, 0, 2, 0x40, 0x9C, 0xFF, 5, 0x2C, 1, 7, 0x31];
        assert_eq!(message[BEAMS_FROM..], expected);
        assert_eq!(message[BEAMS_FROM - 4..BEAMS_FROM], [5, 0, 0, 0]);
    }

    #[test]
    fn datagrams_cover_the_message_once() {
        let message: Vec<u8> = (0..4_000_u32).map(|index| index as u8).collect();
        let datagrams = scan_datagrams(&message, 9);
        assert_eq!(datagrams.len(), 3);
        assert_eq!(datagrams[1][..24], *b"MS3 MD\x01\x00\xA0\x0F\0\0\x09\0\0\0\xA8\x05\0\0\0\0\0\0");
        let joined: Vec<u8> =
            datagrams.iter().flat_map(|datagram| datagram[DATAGRAM_HEADER..].to_vec()).collect();
        assert_eq!(joined, message);
    }
}
