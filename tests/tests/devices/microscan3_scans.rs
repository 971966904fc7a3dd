//! Full scans of 2,751 beams over a network that loses, doubles, delays and mixes datagrams.
//!
//! The encoder below is written from the format (book, microScan3) and shares nothing with the driver.

use floorguard_drivers::microscan3::{Configuration, Event, Receiver};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

const BEAMS: u16 = 2_751;
/// Content of a datagram in an Ethernet frame.
const PIECE: usize = 1_460;

/// Distance of a beam in a scan, mm; 0 stands for "infinite".
fn distance_mm(scan: u32, beam: u16) -> u16 {
    ((scan.wrapping_mul(7_919).wrapping_add(u32::from(beam) * 31)) % 30_000) as u16
}

fn message(scan: u32) -> Vec<u8> {
    let mut bytes = vec![0; 52];
    bytes[..4].copy_from_slice(b"V\x01\x02\x03");
    bytes[16..20].copy_from_slice(&scan.to_le_bytes());
    bytes[20..24].copy_from_slice(&scan.to_le_bytes());
    let block = |place: usize, content: Vec<u8>, bytes: &mut Vec<u8>| {
        let (offset, size) = (bytes.len() as u16, content.len() as u16);
        bytes[place..place + 2].copy_from_slice(&offset.to_le_bytes());
        bytes[place + 2..place + 4].copy_from_slice(&size.to_le_bytes());
        bytes.extend(content);
    };
    let mut status = vec![0; 16];
    status[0] = 1;
    block(32, status, &mut bytes);
    let mut derived = Vec::new();
    derived.extend(1_u16.to_le_bytes());
    derived.extend(BEAMS.to_le_bytes());
    derived.extend(40_u16.to_le_bytes());
    derived.extend([0; 2]);
    derived.extend(((-47.5 * 4_194_304.0) as i32).to_le_bytes());
    derived.extend(((0.1 * 4_194_304.0) as i32).to_le_bytes());
    derived.extend(11_u32.to_le_bytes());
    derived.extend([0; 4]);
    block(36, derived, &mut bytes);
    let mut measured = u32::from(BEAMS).to_le_bytes().to_vec();
    for beam in 0..BEAMS {
        let mm = distance_mm(scan, beam);
        measured.extend(mm.to_le_bytes());
        measured.extend([99, if mm == 0 { 2 } else { 1 }]);
    }
    block(40, measured, &mut bytes);
    bytes
}

fn datagrams(scan: u32) -> Vec<Vec<u8>> {
    let bytes = message(scan);
    let pieces = bytes.chunks(PIECE).enumerate().map(|(index, piece)| {
        let mut datagram = b"MS3 MD\x01\x00".to_vec();
        for number in [bytes.len() as u32, 1_000 + scan, (index * PIECE) as u32, 0] {
            datagram.extend(number.to_le_bytes());
        }
        datagram.extend(piece);
        datagram
    });
    pieces.collect()
}

/// What a bad network makes of a stream: (arrival in µs, datagram).
fn network(scans: u32, seed: u64, (lost, doubled, late): (f32, f32, f32)) -> (Vec<(u64, Vec<u8>)>, u32) {
    let mut random = Pcg32::new(seed, 1);
    let (mut arrivals, mut corrupted) = (Vec::new(), 0);
    for scan in 0..scans {
        let sent_us = 1_000_000 + u64::from(scan) * 40_000;
        let mut whole = true;
        for datagram in datagrams(scan) {
            if random.bernoulli(lost) {
                whole = false;
                continue;
            }
            // Up to 50 ms: into the next scan, within the time that an incomplete message may wait.
            let delay_us = if random.bernoulli(late) { u64::from(random.below(50_000)) } else { 300 };
            if random.bernoulli(doubled) {
                arrivals.push((sent_us + delay_us + 200, datagram.clone()));
            }
            arrivals.push((sent_us + delay_us, datagram));
        }
        corrupted += u32::from(!whole);
    }
    arrivals.sort_by_key(|(at_us, _)| *at_us);
    (arrivals, corrupted)
}

fn receive(arrivals: &[(u64, Vec<u8>)]) -> (Vec<Scan>, Receiver) {
    let mut receiver = Receiver::new(Configuration::default());
    let mut scans = Vec::new();
    for (at_us, datagram) in arrivals {
        receiver.push(datagram, Stamp::from_micros(*at_us), |event| match event {
            Event::Scan(scan) => scans.push(scan.clone()),
            other => panic!("{other:?}"),
        });
    }
    (scans, receiver)
}

fn check(scan: &Scan) {
    assert_eq!(scan.beams.len(), usize::from(BEAMS));
    assert!((scan.first_angle_rad - (-137.5_f32).to_radians()).abs() < 1e-6);
    assert!((scan.step_rad - 0.1_f32.to_radians()).abs() < 1e-8);
    for (beam, seen) in (0..BEAMS).zip(&scan.beams) {
        let wanted = match distance_mm(scan.sequence, beam) {
            0 => BeamReturn::Free(5_500),
            mm => BeamReturn::Hit(mm),
        };
        assert_eq!(*seen, wanted);
    }
}

#[test]
fn good_network_delivers_every_stamped_scan() {
    let (arrivals, _) = network(100, 1, (0.0, 0.0, 0.0));
    let (scans, receiver) = receive(&arrivals);
    assert_eq!(scans.len(), 100);
    for scan in &scans {
        check(scan);
        // Half of 2,751 beams of 11 µs, 10 ms of latency, 0.3 ms of network.
        let arrival_us = 1_000_300 + u64::from(scan.sequence) * 40_000;
        assert_eq!(scan.stamp.as_micros(), arrival_us - 10_000 - 15_130);
    }
    assert_eq!((receiver.counters().lost_scans, receiver.counters().assembly.incomplete), (0, 0));
}

#[test]
fn doubled_and_reordered_datagrams_change_nothing() {
    // Late enough to interleave two scans, never so late that the newer one is complete before.
    let mut arrivals = Vec::new();
    let mut random = Pcg32::new(2, 1);
    for scan in 0..100_u32 {
        let mut pieces = datagrams(scan);
        for index in (1..pieces.len()).rev() {
            pieces.swap(index, random.below(index as u32 + 1) as usize);
        }
        let sent_us = 1_000_000 + u64::from(scan) * 40_000;
        let middle = pieces.len() / 2;
        for (index, datagram) in pieces.into_iter().enumerate() {
            // The second half comes together with the first half of the next scan.
            let at_us = sent_us + if index < middle { 0 } else { 40_000 + 10 * index as u64 };
            arrivals.push((at_us, datagram.clone()));
            if index != 0 {
                arrivals.push((at_us + 5, datagram));
            }
        }
    }
    arrivals.sort_by_key(|(at_us, _)| *at_us);
    let (scans, receiver) = receive(&arrivals);
    assert_eq!(scans.len(), 100);
    scans.iter().for_each(check);
    assert!(scans.windows(2).all(|pair| pair[1].sequence == pair[0].sequence + 1));
    let counters = receiver.counters();
    assert_eq!((counters.lost_scans, counters.repeated_scans, counters.assembly.contradictions), (0, 0, 0));
    assert!(counters.assembly.duplicates + counters.assembly.late > 500);
}

#[test]
fn lost_datagrams_cost_their_scan_and_no_other() {
    for seed in 0..5 {
        let (arrivals, corrupted) = network(300, seed, (0.02, 0.05, 0.0));
        let (scans, receiver) = receive(&arrivals);
        assert!(corrupted > 20);
        assert_eq!(scans.len() as u32, 300 - corrupted);
        scans.iter().for_each(check);
        let behind_last = 299 - scans.last().unwrap().sequence;
        let before_first = scans[0].sequence;
        assert_eq!(receiver.counters().lost_scans, corrupted - behind_last - before_first);
    }
}

#[test]
fn delivered_scans_are_right_on_any_network() {
    for seed in 0..10 {
        let (arrivals, _) = network(200, 100 + seed, (0.01, 0.1, 0.2));
        let (scans, receiver) = receive(&arrivals);
        scans.iter().for_each(check);
        assert!(scans.windows(2).all(|pair| pair[1].sequence > pair[0].sequence), "seed {seed}");
        assert_eq!(receiver.counters().assembly.contradictions, 0);
        assert!(scans.len() > 100, "seed {seed}: {}", scans.len());
    }
}
