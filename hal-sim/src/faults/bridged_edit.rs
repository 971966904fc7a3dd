//! Changes inside what bridges send (book, Scan link, IMU link); its checksum is made good again.

use super::edit::Edit;
use crate::wire::{IMU_HEAD_BYTES, LINK_CRC_BYTES, SCAN_HEAD_BYTES, reseal_link};

/// Where the sender and its clock stand, and of beams the first angle; then the step, four bytes on.
const SENDER: usize = 4;
const CLOCK: usize = 12;
const FIRST_ANGLE: usize = 20;
/// Which datagram of its scan it is.
const FRAGMENT: usize = 34;
const BEAMS_A_DATAGRAM: i64 = 700;
/// An inertial sample, and the numbers in it.
const SAMPLE_BYTES: usize = 28;
const SAMPLE_NUMBERS_BYTES: usize = 24;

/// Changes a datagram of beams.
pub(super) fn scan_datagram(edit: Edit, bytes: &mut [u8]) {
    let end = bytes.len() - LINK_CRC_BYTES;
    match edit {
        Edit::Extreme(which) => {
            let value = [[0xFF, 0xFF], [0x01, 0x00], [0x00, 0x00]][which as usize % 3];
            bytes[SCAN_HEAD_BYTES..end].chunks_exact_mut(2).for_each(|range| range.copy_from_slice(&value));
        }
        Edit::Clock(forward_us) => move_clock(bytes, forward_us),
        // Another bridge.
        Edit::Stranger => bytes[SENDER] ^= 0x40,
        Edit::Blind(degrees) => {
            let number =
                |at: usize| i32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
            let (first, step) = (i64::from(number(FIRST_ANGLE)), i64::from(number(FIRST_ANGLE + 4)));
            let first = first + step * BEAMS_A_DATAGRAM * i64::from(bytes[FRAGMENT]);
            let half = (f64::from(degrees) * 0.5e6) as i64;
            for (beam, range) in (0..).zip(bytes[SCAN_HEAD_BYTES..end].chunks_exact_mut(2)) {
                if (first + step * beam).abs() <= half {
                    range.fill(0);
                }
            }
        }
    }
    reseal_link(bytes);
}

/// Changes a frame of inertial samples.
pub(super) fn imu_frame(edit: Edit, bytes: &mut [u8]) {
    let end = bytes.len() - LINK_CRC_BYTES;
    match edit {
        Edit::Extreme(which) => {
            let value = [f32::NAN, f32::INFINITY, 3.0e38, -0.0][which as usize % 4];
            for sample in bytes[IMU_HEAD_BYTES..end].chunks_exact_mut(SAMPLE_BYTES) {
                let numbers = sample[..SAMPLE_NUMBERS_BYTES].chunks_exact_mut(4);
                numbers.for_each(|number| number.copy_from_slice(&value.to_le_bytes()));
            }
        }
        Edit::Clock(forward_us) => move_clock(bytes, forward_us),
        Edit::Stranger => bytes[SENDER] ^= 0x40,
        Edit::Blind(_) => {}
    }
    reseal_link(bytes);
}

fn move_clock(bytes: &mut [u8], forward_us: i64) {
    let clock = &mut bytes[CLOCK..CLOCK + 8];
    let shown = clock.iter().rev().fold(0_u64, |value, byte| value << 8 | u64::from(*byte));
    clock.copy_from_slice(&shown.wrapping_add_signed(forward_us).to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::{ScanNote, imu_link_frame, scan_link_datagrams};

    #[test]
    fn beams_in_front_become_silent() {
        let note = ScanNote {
            sender: 7,
            sequence: 1,
            first_beam_us: 1_000,
            angles_udeg: (-180_000_000, 250_000),
            between_ns: 69_444,
        };
        let mut sent = scan_link_datagrams(&note, &[2_000; 1_440]);
        let whole = sent.clone();
        sent.iter_mut().for_each(|bytes| scan_datagram(Edit::Blind(60.0), bytes));
        let silent = |bytes: &Vec<u8>| {
            let end = bytes.len() - LINK_CRC_BYTES;
            bytes[SCAN_HEAD_BYTES..end].chunks_exact(2).filter(|range| **range == [0, 0]).count()
        };
        // 241 beams around the front: 180° ± 30° of the first beam lie at 600 to 840.
        assert_eq!(sent.iter().map(silent).collect::<Vec<_>>(), [100, 141, 0]);
        assert_eq!(sent[2], whole[2]);
        let mut shifted = whole[0].clone();
        scan_datagram(Edit::Clock(-500), &mut shifted);
        let other = ScanNote { first_beam_us: 500, ..note };
        assert_eq!(shifted, scan_link_datagrams(&other, &[2_000; 1_440])[0]);
    }

    #[test]
    fn inertial_frames_stay_frames() {
        let frame = |from, clock_us, rate: f32| {
            imu_link_frame((from, 3), (clock_us, 10_000), &[([rate, 0.5, rate], [rate, 0.5, 9.75], 0); 2])
        };
        let edited = |edit| {
            let mut bytes = frame(7, 5_000, 0.25);
            imu_frame(edit, &mut bytes);
            bytes
        };
        assert_eq!(edited(Edit::Clock(-500)), frame(7, 4_500, 0.25));
        assert_eq!(edited(Edit::Stranger), frame(7 ^ 0x40, 5_000, 0.25));
        assert_eq!(edited(Edit::Blind(60.0)), frame(7, 5_000, 0.25));
        let huge = [3.0e38; 3];
        assert_eq!(edited(Edit::Extreme(2)), imu_link_frame((7, 3), (5_000, 10_000), &[(huge, huge, 0); 2]));
    }
}
