//! Scans of three datagrams: in any order, incomplete, and damaged at random. Nothing comes out that was not sent.

use std::println;
use std::vec::Vec;

use super::{DecodeError, Decoder, ScanShape};
use crate::link::OrderError;
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

const BEAMS: u16 = 1_440;
const SHAPE: ScanShape = ScanShape {
    beams: BEAMS,
    first_udeg: -180_000_000,
    step_udeg: 250_000,
    period_us: 100_000,
    range_mm: [50, 30_000],
};

/// zlib CRC-32.
pub(super) fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 },
        )
    })
}

/// The datagrams of a scan: each beam is as many millimetres longer than the first as it has beams before it.
pub(super) fn datagrams(sequence: u32, first_mm: u16) -> [Vec<u8>; 3] {
    [0_u8, 1, 2].map(|fragment| {
        let mut bytes = [b'F', b'G', 1, 5].to_vec();
        bytes.extend([7, sequence].map(u32::to_le_bytes).concat());
        bytes.extend((u64::from(sequence) * 100_000).to_le_bytes());
        bytes.extend((-180_000_000_i32).to_le_bytes());
        bytes.extend([250_000_u32, 69_444].map(u32::to_le_bytes).concat());
        bytes.extend(BEAMS.to_le_bytes());
        bytes.extend([fragment, 3]);
        let first = u16::from(fragment) * 700;
        let ranges = (first..(first + 700).min(BEAMS)).flat_map(|beam| (first_mm + beam).to_le_bytes());
        bytes.extend(ranges);
        let checksum = crc32(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    })
}

fn is_sent(scan: &Scan, first_mm: u16) -> bool {
    let beams = (0..BEAMS).map(|beam| BeamReturn::Hit(first_mm + beam));
    scan.beams.iter().copied().eq(beams)
}

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

#[test]
fn fragments_come_in_any_order() {
    let mut decoder = Decoder::new(SHAPE);
    for (sequence, order) in (1..).zip([[0, 1, 2], [2, 1, 0], [1, 2, 0]]) {
        let sent = datagrams(sequence, 3_000);
        let now = at(10_000_000 + u64::from(sequence) * 100_000);
        assert!(sent.iter().all(|bytes| bytes.len() <= 1_472));
        for place in &order[..2] {
            assert!(decoder.decode(&sent[*place], now).unwrap().is_none());
            let again = decoder.decode(&sent[*place], now).map(|_| ());
            assert_eq!(again, Err(DecodeError::Order(OrderError::NotNewer { sequence })));
        }
        let scan = decoder.decode(&sent[order[2]], now.plus_micros(900)).unwrap().unwrap();
        // Its delay is that of the first datagram; the middle of 1,440 beams lies 50 ms before.
        assert!(is_sent(scan, 3_000) && scan.stamp == now.minus_micros(49_964), "{:?}", scan.stamp);
    }
    let counters = decoder.counters();
    assert_eq!((counters.scans, counters.refused, counters.lost), (3, 6, 0));
}

#[test]
fn incomplete_scans_are_lost_and_counted() {
    let mut decoder = Decoder::new(SHAPE);
    let (one, two, five) = (datagrams(1, 3_000), datagrams(2, 4_000), datagrams(5, 5_000));
    for (bytes, now_us) in [(&one[0], 1_000_000), (&one[2], 1_000_100), (&two[0], 1_100_000)] {
        assert!(decoder.decode(bytes, at(now_us)).unwrap().is_none());
    }
    // What comes after a newer scan has begun belongs nowhere.
    let late = decoder.decode(&one[1], at(1_100_100)).map(|_| ());
    assert_eq!(late, Err(DecodeError::Order(OrderError::NotNewer { sequence: 1 })));
    // A datagram that describes the scan in another way is not put into it.
    let mut other = two[1].clone();
    other.truncate(1_436);
    other[12] ^= 1;
    let checksum = crc32(&other);
    other.extend(checksum.to_le_bytes());
    let disagrees = decoder.decode(&other, at(1_100_200)).map(|_| ());
    assert_eq!(disagrees, Err(DecodeError::Disagrees { sequence: 2 }));
    // Scan 2 is given up, 3 and 4 never came.
    assert!(decoder.decode(&five[0], at(1_400_000)).unwrap().is_none());
    assert_eq!(decoder.counters().lost, 4);
    // After a second of silence nothing of it is put together with what comes then.
    assert!(decoder.decode(&five[1], at(2_500_000)).unwrap().is_none());
    assert!(decoder.decode(&five[2], at(2_500_100)).unwrap().is_none());
    let scan = decoder.decode(&five[0], at(2_500_200)).unwrap().unwrap();
    assert!(is_sent(scan, 5_000));
    assert_eq!((decoder.counters().scans, decoder.counters().lost), (1, 5));
}

/// Bits, bytes and lengths of 2,000 datagrams are damaged, others are lost, swapped and repeated.
#[test]
fn nothing_comes_out_that_was_not_sent() {
    let mut decoder = Decoder::new(SHAPE);
    let mut random = Pcg32::new(26, 1);
    let (mut damaged, mut scans, mut sequence, mut now_us) = (0, 0, 0, 1_000_000);
    while damaged < 2_000 {
        sequence += 1;
        now_us += 100_000;
        let first_mm = 1_000 + (sequence % 7_000) as u16;
        let mut sent = datagrams(sequence, first_mm).to_vec();
        match random.below(8) {
            0 => sent.swap(0, 2),
            1 => sent.push(sent[1].clone()),
            2 => drop(sent.remove(1)),
            _ => {}
        }
        for bytes in &mut sent {
            if random.below(3) == 0 {
                damage(bytes, &mut random);
                damaged += 1;
            }
            let now = at(now_us);
            if let Ok(Some(scan)) = decoder.decode(bytes, now) {
                scans += 1;
                assert!(
                    is_sent(scan, first_mm) && scan.sequence == sequence && scan.stamp <= now,
                    "{sequence}"
                );
            }
        }
    }
    let counters = decoder.counters();
    assert_eq!(counters.scans, scans);
    // Those that came whole came out: a third of the datagrams, three a scan, leave some.
    assert!(scans > 100 && counters.lost > 100 && counters.refused >= damaged, "{counters:?}, {damaged}");
    println!("{sequence} scans, {damaged} datagrams damaged, {scans} whole: {counters:?}");
}

fn damage(bytes: &mut Vec<u8>, random: &mut Pcg32) {
    let place = random.below(bytes.len() as u32) as usize;
    match random.below(4) {
        0 => bytes[place] ^= 1 << random.below(8),
        1 => bytes[place] = bytes[place].wrapping_add(1 + random.below(255) as u8),
        2 => bytes.truncate(place),
        _ => bytes.extend((0..=random.below(600)).map(|byte| byte as u8)),
    }
}
