//! CAN frames as text: the Lawicel protocol (book, CAN frames: SLCAN).

use super::CanFrame;
use std::fmt::Write;

/// The longest line that the protocol knows.
const LINE_MAX: usize = 32;

/// A frame as a line, with its carriage return.
#[must_use]
pub fn encode_slcan(frame: &CanFrame) -> String {
    let mut line = if frame.extended {
        format!("T{:08X}{}", frame.id, frame.len)
    } else {
        format!("t{:03X}{}", frame.id, frame.len)
    };
    for byte in frame.payload() {
        // Writing to a string cannot fail.
        let _ = write!(line, "{byte:02X}");
    }
    line.push('\r');
    line
}

/// Takes the host's frames out of a byte stream and says what an adapter answers.
#[derive(Clone, Debug, Default)]
pub struct SlcanDecoder {
    line: Vec<u8>,
}

impl SlcanDecoder {
    /// Complete frames and the adapter's replies.
    pub fn push(&mut self, bytes: &[u8]) -> (Vec<CanFrame>, Vec<u8>) {
        let (mut frames, mut replies) = (Vec::new(), Vec::new());
        for byte in bytes {
            if *byte != b'\r' {
                self.line.push(*byte);
                continue;
            }
            let line = core::mem::take(&mut self.line);
            match (line.first(), parse(&line)) {
                (Some(b't'), Some(frame)) => {
                    frames.push(frame);
                    replies.extend(b"z\r");
                }
                (Some(b'T'), Some(frame)) => {
                    frames.push(frame);
                    replies.extend(b"Z\r");
                }
                (Some(b'V'), None) => replies.extend(b"V1013\r"),
                (Some(b't' | b'T'), None) => replies.push(7),
                _ => replies.push(b'\r'),
            }
        }
        (frames, replies)
    }
}

fn parse(line: &[u8]) -> Option<CanFrame> {
    let text = core::str::from_utf8(line).ok().filter(|text| text.len() <= LINE_MAX)?;
    let (extended, digits) = match text.get(..1)? {
        "t" => (false, 3),
        "T" => (true, 8),
        _ => return None,
    };
    let id = u32::from_str_radix(text.get(1..1 + digits)?, 16).ok()?;
    let len: u8 = text.get(1 + digits..2 + digits)?.parse().ok()?;
    let limit = if extended { 0x1FFF_FFFF } else { 0x7FF };
    let hex = text.get(2 + digits..)?;
    if len > 8 || id > limit || hex.len() != 2 * usize::from(len) {
        return None;
    }
    let payload: Option<Vec<u8>> =
        (0..usize::from(len)).map(|i| u8::from_str_radix(hex.get(2 * i..2 * i + 2)?, 16).ok()).collect();
    Some(CanFrame { extended, ..CanFrame::new(id, &payload?) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of the book, CAN frames: SLCAN.
    #[test]
    fn lines_equal_the_vectors() {
        assert_eq!(encode_slcan(&CanFrame::new(0x080, &[])), "t0800\r");
        assert_eq!(encode_slcan(&CanFrame::new(0x201, &[0x0F, 0, 0x10, 0x27, 0, 0])), "t20160F0010270000\r");
        let extended = CanFrame { extended: true, ..CanFrame::new(0x01AB_CDEF, &[1, 2, 3]) };
        assert_eq!(encode_slcan(&extended), "T01ABCDEF3010203\r");
    }

    #[test]
    fn split_lines_are_read_wrong_ones_refused() {
        let mut decoder = SlcanDecoder::default();
        assert!(decoder.push(b"T12ABCDEF").0.is_empty());
        let (frames, replies) = decoder.push(b"2AA55\rt7011\rt1239\rS6\rO\r");
        assert_eq!(frames, [CanFrame { extended: true, ..CanFrame::new(0x12AB_CDEF, &[0xAA, 0x55]) }]);
        assert_eq!(replies, b"Z\r\x07\x07\r\r");
    }
}
