//! The datagram that the reference encoder (`examples/scan_beams.py --vector`) writes, and what is refused.

use std::string::ToString;
use std::vec;
use std::vec::Vec;

use super::damage_tests::{crc32, datagrams};
use super::{BeamsFrame, DecodeError, Decoder, FrameError, ScanShape, ShapePart};
use crate::link::OrderError;
use floorguard_types::sensing::BeamReturn::{Hit, Unknown};
use floorguard_types::time::Stamp;

/// Sender 7, scan 42, 1,000.000123 s, five beams from -20° to 20°, 125 µs apart.
const VECTOR: &str =
    "46470105070000002a0000007bca9a3b0000000000d3cefe8096980048e8010005000001e8030000e9033075ffff45adad4e";
const SHAPE: ScanShape = ScanShape {
    beams: 5,
    first_udeg: -20_000_000,
    step_udeg: 10_000_000,
    period_us: 50_000,
    range_mm: [50, 30_000],
};

fn vector() -> Vec<u8> {
    (0..VECTOR.len()).step_by(2).map(|at| u8::from_str_radix(&VECTOR[at..at + 2], 16).unwrap()).collect()
}

/// The same with a change, and the checksum made good again.
fn changed(change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = vector();
    bytes.truncate(bytes.len() - 4);
    change(&mut bytes);
    let checksum = crc32(&bytes);
    bytes.extend(checksum.to_le_bytes());
    bytes
}

fn number(sequence: u32) -> Vec<u8> {
    changed(|bytes| bytes[8..12].copy_from_slice(&sequence.to_le_bytes()))
}

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

#[test]
fn reference_datagram_gives_its_scan() {
    let mut decoder = Decoder::new(SHAPE);
    let scan = decoder.decode(&vector(), at(5_000_000)).unwrap().unwrap();
    // Nothing measured, no return, and farther than the robot's file allows: unknown, and never free.
    assert_eq!(scan.beams, [Hit(1_000), Unknown, Hit(1_001), Hit(30_000), Unknown]);
    assert!((scan.first_angle_rad + 20.0_f32.to_radians()).abs() < 1.0e-6);
    assert!((scan.step_rad - 10.0_f32.to_radians()).abs() < 1.0e-7);
    // The last beam was measured when it arrived, or before; the middle lies 250 µs before the last.
    assert_eq!((scan.sequence, scan.stamp), (42, at(4_999_750)));
    let bytes = vector();
    let frame = BeamsFrame::new_checked(&bytes).unwrap();
    let head = frame.head();
    assert_eq!((head.sender, head.first_beam_us, head.between_ns), (7, 1_000_000_123, 125_000));
    assert_eq!((frame.fragment(), frame.fragments(), frame.first_beam()), (0, 1, 0));
}

/// A device that turns clockwise measures its first beam last: the middle of its scan is where it is.
#[test]
fn clockwise_scans_have_the_same_middle() {
    let clockwise = changed(|bytes| {
        bytes[12..20].copy_from_slice(&1_000_000_623_u64.to_le_bytes());
        bytes[28..32].copy_from_slice(&(-125_000_i32).to_le_bytes());
    });
    let mut decoder = Decoder::new(SHAPE);
    assert_eq!(decoder.decode(&clockwise, at(5_000_000)).unwrap().unwrap().stamp, at(4_999_750));
}

#[test]
fn lost_and_repeated_scans_are_found() {
    let mut decoder = Decoder::new(SHAPE);
    let mut decode =
        |sequence, micros| decoder.decode(&number(sequence), at(micros)).map(|scan| scan.is_some());
    assert_eq!(decode(u32::MAX, 1_000_000), Ok(true));
    assert_eq!(decode(0, 1_050_000), Ok(true));
    assert_eq!(decode(4, 1_100_000), Ok(true));
    assert_eq!(decode(4, 1_150_000), Err(DecodeError::Order(OrderError::NotNewer { sequence: 4 })));
    assert_eq!(decode(2, 1_200_000), Err(DecodeError::Order(OrderError::NotNewer { sequence: 2 })));
    // After a second of silence a bridge may count from the beginning.
    assert_eq!(decode(2, 2_300_000), Ok(true));
    let counters = decoder.counters();
    assert_eq!((counters.scans, counters.refused, counters.lost), (4, 2, 3));
}

#[test]
fn strangers_and_other_scans_are_refused() {
    let mut decoder = Decoder::new(SHAPE);
    decoder.decode(&vector(), at(1_000_000)).unwrap();
    let stranger = changed(|bytes| (bytes[4], bytes[8]) = (9, 50));
    let refused = decoder.decode(&stranger, at(1_010_000)).map(|_| ());
    assert_eq!(refused, Err(DecodeError::Order(OrderError::Sender { found: 9, expected: 7 })));
    assert!(decoder.decode(&stranger, at(2_100_000)).unwrap().is_some());
    for (shape, part, words) in [
        (ScanShape { beams: 6, ..SHAPE }, ShapePart::Beams, "5 beams; this robot's file has 6"),
        (
            ScanShape { first_udeg: -20_060_000, ..SHAPE },
            ShapePart::FirstAngle,
            "-20.0000°; this robot's file has -20.0600°: correct `first_deg`",
        ),
        (ScanShape { step_udeg: 9_999_000, ..SHAPE }, ShapePart::Step, "10.0000°"),
    ] {
        let refused = Decoder::new(shape).decode(&vector(), at(1_000_000)).map(|_| ()).unwrap_err();
        assert!(matches!(refused, DecodeError::Shape { part: found, .. } if found == part), "{refused:?}");
        assert!(refused.to_string().contains(words), "{refused}");
    }
    // Angles of a driver that computes in radians of 32 bits are the same.
    let rounded = ScanShape { first_udeg: -20_000_300, step_udeg: 10_000_100, ..SHAPE };
    assert!(Decoder::new(rounded).decode(&vector(), at(1_000_000)).unwrap().is_some());
}

/// Steps that differ by little add up over many beams.
#[test]
fn last_angle_must_fit_too() {
    let shape = ScanShape { beams: 1_440, first_udeg: -180_000_000, step_udeg: 250_000, ..SHAPE };
    let other = ScanShape { step_udeg: 250_100, ..shape };
    let refused = Decoder::new(other).decode(&datagrams(1, 3_000)[0], at(1_000_000)).map(|_| ());
    let expected =
        DecodeError::Shape { part: ShapePart::LastAngle, found: 179_750_000, expected: 179_893_900 };
    assert_eq!(refused, Err(expected));
}

#[test]
fn damaged_datagrams_are_refused() {
    let refused = |bytes: &[u8]| BeamsFrame::new_checked(bytes).map(|_| ()).unwrap_err();
    for bit in 0..vector().len() * 8 {
        let mut bytes = vector();
        bytes[bit / 8] ^= 1 << (bit % 8);
        assert!(BeamsFrame::new_checked(&bytes).is_err(), "bit {bit}");
    }
    assert!(matches!(refused(&[]), FrameError::Start(_)));
    assert!(matches!(refused(&vector()[..4]), FrameError::Field { .. }));
    assert!(matches!(refused(&vector()[..40]), FrameError::Length { found: 40, needed: 50 }));
    let long = [vector(), vec![0]].concat();
    assert_eq!(refused(&long), FrameError::Length { found: 51, needed: 50 });
    let field = |at: usize, value: &[u8]| changed(|bytes| bytes[at..at + value.len()].copy_from_slice(value));
    for (offset, value) in [
        (4, &0_u32.to_le_bytes()[..]),
        (20, &360_000_001_i32.to_le_bytes()),
        (20, &i32::MIN.to_le_bytes()),
        (24, &0_u32.to_le_bytes()),
        (24, &10_000_001_u32.to_le_bytes()),
        (32, &1_u16.to_le_bytes()),
        (32, &2_752_u16.to_le_bytes()),
        (34, &[1]),
        (35, &[0]),
        (35, &[2]),
    ] {
        let error = refused(&field(offset, value));
        assert!(
            matches!(error, FrameError::Field { offset: found, .. } if usize::from(found) == offset)
                // Other beams ask for other fragments, too.
                || offset == 32 && matches!(error, FrameError::Field { offset: 32 | 35, .. }),
            "{offset}: {error}"
        );
    }
    let slow = refused(&field(28, &250_000_001_i32.to_le_bytes()));
    assert_eq!(slow, FrameError::Duration { beams: 5, between_ns: 250_000_001 });
}
