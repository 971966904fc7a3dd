//! Xbus frames of the Xsens MTi (book, Xsens MTi: Frames).

/// A frame around the data of a message, at most 254 bytes.
#[must_use]
pub fn encode_message(id: u8, data: &[u8]) -> Vec<u8> {
    debug_assert!(data.len() < 255, "extended frames are not emitted");
    let mut bytes = vec![0xFA, 0xFF, id, data.len() as u8];
    bytes.extend(data);
    let sum = bytes[1..].iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    bytes.push(sum.wrapping_neg());
    bytes
}

/// Makes the checksum of a frame right again after a change.
pub fn reseal_message(bytes: &mut [u8]) {
    if let Some((last, rest)) = bytes.split_last_mut() {
        *last = rest.iter().skip(1).fold(0_u8, |sum, byte| sum.wrapping_add(*byte)).wrapping_neg();
    }
}

/// Takes the host's messages out of a byte stream.
#[derive(Clone, Debug, Default)]
pub struct XbusParser {
    buffer: Vec<u8>,
}

impl XbusParser {
    /// The messages that are complete with these bytes: id and data. Frames with a wrong sum are skipped.
    pub fn push(&mut self, bytes: &[u8]) -> Vec<(u8, Vec<u8>)> {
        self.buffer.extend(bytes);
        let mut messages = Vec::new();
        let mut at = 0;
        while let Some(frame) = self.buffer.get(at..).filter(|rest| rest.len() >= 5) {
            let length = 5 + usize::from(frame[3]);
            if frame[0] != 0xFA {
                at += 1;
                continue;
            }
            let Some(frame) = frame.get(..length) else { break };
            if frame[1..].iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte)) == 0 {
                messages.push((frame[2], frame[4..length - 1].to_vec()));
                at += length;
            } else {
                at += 1;
            }
        }
        self.buffer.drain(..at);
        messages
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Commands and replies of the book, Xsens MTi: Test frames.
    #[test]
    fn frames_equal_the_vectors() {
        assert_eq!(encode_message(0x30, &[]), [0xFA, 0xFF, 0x30, 0x00, 0xD1]);
        assert_eq!(encode_message(0x42, &[0x04]), [0xFA, 0xFF, 0x42, 0x01, 0x04, 0xBA]);
        assert_eq!(encode_message(0x3E, &[]), [0xFA, 0xFF, 0x3E, 0x00, 0xC3]);
    }

    #[test]
    fn the_host_is_understood_across_splits_and_noise() {
        let mut parser = XbusParser::default();
        assert!(parser.push(&[0x55, 0xFA, 0xFF, 0x30]).is_empty());
        assert_eq!(
            parser.push(&[0x00, 0xD1, 0xFA, 0xFF, 0x10, 0x00, 0xF1]),
            [(0x30, vec![]), (0x10, vec![])]
        );
    }
}
