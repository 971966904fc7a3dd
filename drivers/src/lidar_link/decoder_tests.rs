//! The datagram that the reference encoder (`examples/lidar_columns.py --vector`) writes, and what is refused.

use std::vec::Vec;

use super::{ColumnsFrame, DecodeError, Decoder, FrameError};
use crate::link::OrderError;
use floorguard_types::time::Stamp;

/// Sender 7, number 42, 1,000.000123 s, two rings, two columns 98 µs apart on either side of 0°.
const VECTOR: &str =
    "46470104070000002a0000007bca9a3b00000000020204008c8c0000fa000a00000000006200fb000bffffffbc3ca287";

fn vector() -> Vec<u8> {
    (0..VECTOR.len()).step_by(2).map(|at| u8::from_str_radix(&VECTOR[at..at + 2], 16).unwrap()).collect()
}

/// zlib CRC-32.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 },
        )
    })
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
fn reference_datagram_gives_its_columns() {
    let mut decoder = Decoder::new(2);
    let (packet, lost) = decoder.decode(&vector(), at(5_000_098)).unwrap();
    assert_eq!((packet.rings, packet.range_unit_mm, packet.columns.len(), lost), (2, 4, 2, 0));
    assert_eq!(packet.stamp, at(5_000_000));
    let [first, second] = &packet.columns[..] else { panic!("two columns") };
    assert_eq!((first.azimuth_cdeg, first.offset_us), (35_980, 0));
    assert_eq!((second.azimuth_cdeg, second.offset_us), (0, 98));
    assert_eq!((&first.range_raw[..3], &second.range_raw[..3]), (&[250, 0, 0][..], &[251, 65_535, 0][..]));
    assert_eq!((&first.reflectivity[..2], &second.reflectivity[..2]), (&[10, 0][..], &[11, 255][..]));
    let frame = vector();
    let frame = ColumnsFrame::new_checked(&frame).unwrap();
    assert_eq!((frame.sender(), frame.sequence(), frame.sent_us()), (7, 42, 1_000_000_123));
}

#[test]
fn lost_and_repeated_datagrams_are_found() {
    let mut decoder = Decoder::new(2);
    let mut decode = |sequence, micros| decoder.decode(&number(sequence), at(micros)).map(|(_, lost)| lost);
    assert_eq!(decode(u32::MAX, 1_000_000), Ok(0));
    assert_eq!(decode(0, 1_001_000), Ok(0));
    assert_eq!(decode(4, 1_002_000), Ok(3));
    assert_eq!(decode(4, 1_003_000), Err(DecodeError::Order(OrderError::NotNewer { sequence: 4 })));
    assert_eq!(decode(2, 1_004_000), Err(DecodeError::Order(OrderError::NotNewer { sequence: 2 })));
    // After a second of silence a bridge may count from the beginning.
    assert_eq!(decode(2, 2_100_000), Ok(0));
    assert_eq!((decoder.counters().accepted, decoder.counters().refused, decoder.counters().lost), (4, 2, 3));
}

#[test]
fn strangers_and_other_rings_are_refused() {
    let mut decoder = Decoder::new(2);
    decoder.decode(&vector(), at(1_000_000)).unwrap();
    let stranger = changed(|bytes| (bytes[4], bytes[8]) = (9, 50));
    let refused = decoder.decode(&stranger, at(1_010_000)).map(|_| ());
    assert_eq!(refused, Err(DecodeError::Order(OrderError::Sender { found: 9, expected: 7 })));
    let refused = Decoder::new(16).decode(&vector(), at(1_000_000)).map(|_| ());
    assert_eq!(refused, Err(DecodeError::Rings { found: 2, expected: 16 }));
}

#[test]
fn damaged_datagrams_are_refused() {
    let refused = |bytes: &[u8]| ColumnsFrame::new_checked(bytes).map(|_| ()).unwrap_err();
    for bit in 0..vector().len() * 8 {
        let mut bytes = vector();
        bytes[bit / 8] ^= 1 << (bit % 8);
        assert!(ColumnsFrame::new_checked(&bytes).is_err(), "bit {bit}");
    }
    assert!(matches!(refused(&[]), FrameError::Start(_)));
    assert!(matches!(refused(&vector()[..40]), FrameError::Length { found: 40, .. }));
    for (offset, found) in [(20, 0), (20, 33), (21, 0), (21, 25), (22, 0), (22, 11)] {
        let bytes = changed(|bytes| bytes[usize::from(offset)] = found);
        assert_eq!(refused(&bytes), FrameError::Field { offset, found });
    }
    assert_eq!(refused(&changed(|bytes| bytes[4] = 0)), FrameError::Field { offset: 4, found: 0 });
    // Counter-clockwise, twice at one azimuth, beyond a turn, back in time.
    for azimuth_cdeg in [35_900_u16, 35_980, 36_000] {
        let bytes = changed(|bytes| bytes[34..36].copy_from_slice(&azimuth_cdeg.to_le_bytes()));
        assert_eq!(refused(&bytes), FrameError::Order { column: 1, azimuth_cdeg });
    }
    assert!(matches!(refused(&changed(|bytes| bytes[26] = 200)), FrameError::Order { column: 1, .. }));
}
