//! RPLidar as a sensor of the A or S series answers (book, RPLidar).

/// A descriptor: bytes of each answer, whether many follow, and what they are.
#[must_use]
pub fn rplidar_descriptor(bytes: u32, is_stream: bool, kind: u8) -> Vec<u8> {
    let word = bytes | if is_stream { 1 << 30 } else { 0 };
    [&[0xA5, 0x5A][..], &word.to_le_bytes(), &[kind]].concat()
}

/// A capsule of 32 samples: millimetres, and eighths of a degree by which a sample was measured before the even step.
#[must_use]
pub fn rplidar_capsule(angle_q6: u16, is_first: bool, samples: &[(u16, u8)]) -> Vec<u8> {
    let word = |(range_mm, earlier): (u16, u8)| (range_mm.min(0x3FFF) << 2) | u16::from(earlier >> 4 & 3);
    let cabins = samples.chunks(2).flat_map(|pair| {
        let (first, second) = (pair[0], pair.get(1).copied().unwrap_or_default());
        let ([a, b], [c, d]) = (word(first).to_le_bytes(), word(second).to_le_bytes());
        [a, b, c, d, (first.1 & 0x0F) | (second.1 << 4)]
    });
    capsule(angle_q6, is_first, cabins.collect())
}

/// A dense capsule of 40 samples, millimetres.
#[must_use]
pub fn rplidar_dense_capsule(angle_q6: u16, is_first: bool, ranges_mm: &[u16]) -> Vec<u8> {
    capsule(angle_q6, is_first, ranges_mm.iter().flat_map(|range| range.to_le_bytes()).collect())
}

fn capsule(angle_q6: u16, is_first: bool, cells: Vec<u8>) -> Vec<u8> {
    let angle = (angle_q6 | if is_first { 0x8000 } else { 0 }).to_le_bytes();
    let check = angle.iter().chain(&cells).fold(0, |check, byte| check ^ byte);
    [&[0xA0 | (check & 0x0F), 0x50 | (check >> 4)][..], &angle, &cells].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first cells of a capsule that a sensor sent (tests of `pyrplidar` 0.1.2).
    #[test]
    fn cells_equal_recorded_ones() {
        let samples = [(0x096A >> 2, 0x2E), (0x0972 >> 2, 0x2E), (0x0976 >> 2, 0x2D), (0x096A >> 2, 0x2D)];
        let bytes = rplidar_capsule(0x54DB, false, &samples);
        assert_eq!(bytes[2..14], [0xDB, 0x54, 0x6A, 0x09, 0x72, 0x09, 0xEE, 0x76, 0x09, 0x6A, 0x09, 0xDD]);
        assert_eq!(rplidar_descriptor(84, true, 0x82), [0xA5, 0x5A, 0x54, 0, 0, 0x40, 0x82]);
    }
}
