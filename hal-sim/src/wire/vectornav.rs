//! VectorNav frames and sentences (book, VectorNav), as a device writes and reads them. Checksums are computed bit by bit.

/// What of the groups the simulated device can send, in the order of the bits: group 1 time since start-up, angular rate, acceleration;
/// group 3 saturation. Any other field is refused.
pub const COMMON_FIELDS: [u16; 3] = [0x0001, 0x0020, 0x0100];
/// The field of group 3.
pub const SATURATION_FIELD: u16 = 0x0800;

/// What a frame can hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VectorNavSample {
    /// Since the device started, nanoseconds.
    pub since_start_ns: u64,
    /// rad/s; x forward, y right, z down.
    pub rate_radps: [f32; 3],
    /// m/s², the same axes, including gravity.
    pub acceleration_mps2: [f32; 3],
    /// Saturated axes.
    pub saturation: u16,
}

/// A frame of the groups' fields: of group 1 `common`, of group 3 `imu`; zero: the group is left out.
#[must_use]
pub fn vectornav_frame(sample: &VectorNavSample, common: u16, imu: u16) -> Vec<u8> {
    let groups = u8::from(common != 0) | if imu == 0 { 0 } else { 4 };
    let mut frame = vec![0xFA, groups];
    for fields in [common, imu].into_iter().filter(|fields| *fields != 0) {
        frame.extend(fields.to_le_bytes());
    }
    let floats = |values: [f32; 3]| values.into_iter().flat_map(f32::to_le_bytes).collect::<Vec<u8>>();
    if common & COMMON_FIELDS[0] != 0 {
        frame.extend(sample.since_start_ns.to_le_bytes());
    }
    if common & COMMON_FIELDS[1] != 0 {
        frame.extend(floats(sample.rate_radps));
    }
    if common & COMMON_FIELDS[2] != 0 {
        frame.extend(floats(sample.acceleration_mps2));
    }
    if imu & SATURATION_FIELD != 0 {
        frame.extend(sample.saturation.to_le_bytes());
    }
    let sum = cyclic_sum(&frame[1..]);
    frame.extend(sum.to_be_bytes());
    frame
}

/// A sentence around words.
#[must_use]
pub fn vectornav_sentence(words: &str) -> Vec<u8> {
    format!("${words}*{:02X}\r\n", exclusive_or(words.as_bytes())).into_bytes()
}

/// CRC-16 of the polynomial 0x1021, from zero.
fn cyclic_sum(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |sum, byte| {
        (0..8).fold(sum ^ (u16::from(*byte) << 8), |sum, _| {
            if sum & 0x8000 == 0 { sum << 1 } else { (sum << 1) ^ 0x1021 }
        })
    })
}

fn exclusive_or(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum ^ byte)
}

/// Changes a frame and makes it right again.
pub fn reseal_vectornav(frame: &mut [u8]) {
    if frame.first() == Some(&0xFA) && frame.len() > 4 {
        let end = frame.len() - 2;
        let sum = cyclic_sum(&frame[1..end]);
        frame[end..].copy_from_slice(&sum.to_be_bytes());
    }
}

/// Finds the sentences that a host writes.
#[derive(Clone, Debug, Default)]
pub struct VectorNavReader {
    line: Vec<u8>,
}

impl VectorNavReader {
    /// Takes bytes; the words of the sentences that end in them, `Err`: one whose checksum is wrong.
    pub fn push(&mut self, bytes: &[u8]) -> Vec<Result<String, ()>> {
        let mut found = Vec::new();
        for byte in bytes {
            match byte {
                b'$' => self.line = vec![b'$'],
                b'\n' => found.extend(heard(&std::mem::take(&mut self.line))),
                b'\r' => {}
                byte if self.line.first() == Some(&b'$') => self.line.push(*byte),
                _ => {}
            }
        }
        found
    }
}

/// The words of a line, if it is a sentence.
fn heard(line: &[u8]) -> Option<Result<String, ()>> {
    let text = std::str::from_utf8(line).ok()?.strip_prefix('$')?;
    let (words, digits) = text.rsplit_once('*')?;
    let is_right = u8::from_str_radix(digits, 16) == Ok(exclusive_or(words.as_bytes()));
    Some(if is_right { Ok(words.to_owned()) } else { Err(()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The checksum of the maker's programming library 1.2 over the same numbers.
    #[test]
    fn frame_agrees_with_the_makers_library() {
        let sample = VectorNavSample {
            since_start_ns: 123_456_789_012_345,
            rate_radps: [0.25, -0.5, 0.031_25],
            acceleration_mps2: [1.5, -0.125, -9.812_5],
            saturation: 0x40,
        };
        let frame = vectornav_frame(&sample, 0x0121, 0x0800);
        assert_eq!(frame[..6], [0xFA, 0x05, 0x21, 0x01, 0x00, 0x08]);
        assert_eq!(frame[6..14], [0x79, 0xDF, 0x0D, 0x86, 0x48, 0x70, 0x00, 0x00]);
        assert_eq!((frame.len(), &frame[40..]), (42, &[0x49, 0xCC][..]));
        let mut resealed = frame.clone();
        resealed[40] = 0;
        reseal_vectornav(&mut resealed);
        assert_eq!(resealed, frame);
        assert_eq!(vectornav_frame(&sample, 0x0001, 0).len(), 14);
    }

    #[test]
    fn sentences_of_the_makers_library_are_heard() {
        let mut reader = VectorNavReader::default();
        let found = reader.push(b"\xFA$VN$VNRRG,01*72\r\n$VNWRG,06,0*6C\r\n$VNWRG,06,0*6D\r\n");
        assert_eq!(found, [Ok("VNRRG,01".to_owned()), Ok("VNWRG,06,0".to_owned()), Err(())]);
        assert_eq!(vectornav_sentence("VNASY,0"), b"$VNASY,0*4F\r\n");
    }
}
