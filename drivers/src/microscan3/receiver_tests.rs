//! Reassembly against a model that keeps sets of bytes: order, duplicates, gaps, interleaving, lies.

use std::collections::BTreeSet;
use std::vec::Vec;

use floorguard_types::time::Stamp;
use proptest::prelude::*;

use super::vector_tests::message;
use super::*;

/// The piece `from..to` of a message, as a datagram.
fn piece(bytes: &[u8], identification: u32, (from, to): (usize, usize)) -> Vec<u8> {
    let mut datagram = b"MS3 MD\x01\x00".to_vec();
    datagram.extend((bytes.len() as u32).to_le_bytes());
    datagram.extend(identification.to_le_bytes());
    datagram.extend((from as u32).to_le_bytes());
    datagram.extend([0; 4]);
    datagram.extend(&bytes[from..to]);
    datagram
}

/// A message of a scan number, in pieces of 50 bytes.
fn pieces(scan: u32, identification: u32) -> Vec<Vec<u8>> {
    let mut bytes = message();
    bytes[20..24].copy_from_slice(&scan.to_le_bytes());
    (0..bytes.len())
        .step_by(50)
        .map(|from| piece(&bytes, identification, (from, (from + 50).min(bytes.len()))))
        .collect()
}

struct Rig {
    receiver: Receiver,
    scans: Vec<u32>,
    refused: Vec<ScanError>,
}

impl Rig {
    fn new() -> Self {
        Self { receiver: Receiver::new(Configuration::default()), scans: Vec::new(), refused: Vec::new() }
    }

    fn push(&mut self, datagram: &[u8], ms: u64) {
        let (scans, refused) = (&mut self.scans, &mut self.refused);
        self.receiver.push(datagram, Stamp::from_micros(ms * 1_000), |event| match event {
            Event::Scan(scan) => scans.push(scan.sequence),
            Event::Refused(error) => refused.push(error),
            Event::StandBy { .. } => {}
        });
    }
}

#[test]
fn scans_may_interleave_out_of_order() {
    let (first, second) = (pieces(10, 1), pieces(11, 2));
    let mut rig = Rig::new();
    for (a, b) in first.iter().rev().zip(&second) {
        rig.push(a, 0);
        rig.push(b, 0);
    }
    assert_eq!(rig.scans, [10, 11]);
    let counters = rig.receiver.counters();
    assert_eq!((counters.assembly.messages, counters.assembly.incomplete, counters.lost_scans), (2, 0, 0));
}

/// The manufacturer's driver sums up lengths: two copies of one piece would complete this message.
#[test]
fn duplicate_fragment_does_not_replace_missing_one() {
    let bytes = message();
    let mut rig = Rig::new();
    for _ in 0..3 {
        rig.push(&piece(&bytes, 7, (0, 58)), 0);
    }
    assert_eq!((rig.scans.len(), rig.receiver.counters().assembly.duplicates), (0, 2));
    rig.push(&piece(&bytes, 7, (58, 116)), 1);
    assert_eq!(rig.scans.len(), 1);
}

#[test]
fn overlapping_pieces_fit_if_they_agree() {
    let bytes = message();
    let mut rig = Rig::new();
    rig.push(&piece(&bytes, 7, (0, 70)), 0);
    rig.push(&piece(&bytes, 7, (40, 116)), 0);
    assert_eq!(rig.scans.len(), 1);
    let mut other = bytes.clone();
    other[45] ^= 1;
    rig.push(&piece(&bytes, 8, (0, 70)), 40);
    rig.push(&piece(&other, 8, (40, 116)), 40);
    assert_eq!((rig.scans.len(), rig.receiver.counters().assembly.contradictions), (1, 1));
    // The message is gone for good: its last piece alone completes nothing.
    rig.push(&piece(&bytes, 8, (40, 116)), 40);
    assert_eq!(rig.scans.len(), 1);
}

#[test]
fn changed_total_invalidates_the_message() {
    let bytes = message();
    let mut rig = Rig::new();
    rig.push(&piece(&bytes, 7, (0, 60)), 0);
    let mut longer = piece(&bytes, 7, (60, 116));
    longer[8] += 1;
    rig.push(&longer, 0);
    rig.push(&piece(&bytes, 7, (60, 116)), 0);
    assert_eq!((rig.scans.len(), rig.receiver.counters().assembly.contradictions), (0, 1));
}

#[test]
fn lengths_that_lie_are_refused() {
    let bytes = message();
    let mut rig = Rig::new();
    let mut with = |at: usize, value: u32| {
        let mut datagram = piece(&bytes, 7, (58, 116));
        datagram[at..at + 4].copy_from_slice(&value.to_le_bytes());
        rig.push(&datagram, 0);
    };
    for total in [0, 115, 16_385, u32::MAX] {
        with(8, total);
    }
    for offset in [59, 116, u32::MAX, u32::MAX - 57] {
        with(16, offset);
    }
    let outside = |error: &ScanError| {
        matches!(error, ScanError::Fragment(FragmentError::Outside { .. } | FragmentError::Total { .. }))
    };
    assert_eq!(rig.refused.iter().filter(|error| outside(error)).count(), 8);
    rig.push(&piece(&bytes, 7, (0, 0)), 0);
    rig.push(&[], 0);
    rig.push(&[0x4D; 30], 0);
    assert_eq!((rig.refused.len(), rig.receiver.counters().assembly.refused, rig.scans.len()), (11, 11, 0));
}

/// However far behind the complete message an unfinished one is, nobody waits for it; one that is ahead may still come.
#[test]
fn a_complete_message_gives_up_all_older_ones() {
    for (behind, incomplete) in [(1_u32, 1), (2, 1), (3, 1), (1 << 20, 1), (u32::MAX, 0), (u32::MAX - 1, 0)] {
        let mut rig = Rig::new();
        rig.push(&pieces(10, 100_u32.wrapping_sub(behind))[0], 0);
        pieces(11, 100).iter().for_each(|datagram| rig.push(datagram, 0));
        assert_eq!(
            (rig.scans.as_slice(), rig.receiver.counters().assembly.incomplete),
            (&[11][..], incomplete),
            "{behind}"
        );
    }
}

/// A piece of one of the fifteen messages before the complete one has been overtaken; an older number has started over.
#[test]
fn what_is_sixteen_messages_old_is_not_late() {
    for (behind, late) in [(1_u32, 1), (15, 1), (16, 0), (17, 0)] {
        let mut rig = Rig::new();
        pieces(11, 100).iter().for_each(|datagram| rig.push(datagram, 0));
        rig.push(&pieces(10, 100 - behind)[0], 50);
        assert_eq!(rig.receiver.counters().assembly.late, late, "{behind}");
    }
}

/// Given up after 100 ms, or when a newer message is complete; both are counted.
#[test]
fn incomplete_messages_are_given_up() {
    let (first, second) = (pieces(10, 1), pieces(11, 2));
    let mut rig = Rig::new();
    rig.push(&first[0], 0);
    for datagram in &second {
        rig.push(datagram, 40);
    }
    assert_eq!((rig.scans.as_slice(), rig.receiver.counters().assembly.incomplete), (&[11][..], 1));
    // What was overtaken does not come back.
    for datagram in &first {
        rig.push(datagram, 41);
    }
    assert_eq!((rig.scans.len(), rig.receiver.counters().assembly.late), (1, 3));
    let third = pieces(12, 3);
    rig.push(&third[0], 200);
    rig.push(&third[1], 200);
    rig.push(&third[2], 301);
    assert_eq!((rig.scans.len(), rig.receiver.counters().assembly.incomplete), (1, 2));
    for datagram in &third[..2] {
        rig.push(datagram, 302);
    }
    assert_eq!((rig.scans.len(), rig.receiver.counters().lost_scans), (2, 0));
}

/// Three unfinished messages at once: the oldest gives way, the others are finished.
#[test]
fn buffer_is_bounded() {
    let messages: Vec<_> = (0..3).map(|number| pieces(10 + number, number)).collect();
    let mut rig = Rig::new();
    messages.iter().for_each(|pieces| rig.push(&pieces[0], 0));
    for pieces in &messages[1..] {
        pieces[1..].iter().for_each(|datagram| rig.push(datagram, 5));
    }
    assert_eq!((rig.scans.as_slice(), rig.receiver.counters().assembly.incomplete), (&[11, 12][..], 1));
}

#[test]
fn a_restarted_or_frozen_scanner_is_seen() {
    let mut rig = Rig::new();
    for (identification, scan, ms) in
        [(900, 500, 0), (901, 501, 40), (902, 504, 160), (0, 1, 5_000), (1, 1, 5_040)]
    {
        pieces(scan, identification).iter().for_each(|datagram| rig.push(datagram, ms));
    }
    assert_eq!(rig.scans, [500, 501, 504, 1, 1]);
    let counters = rig.receiver.counters();
    assert_eq!((counters.lost_scans, counters.repeated_scans), (2, 2));
}

/// The largest message of the family, in pieces of 1,460 bytes.
#[test]
fn oversized_scan_is_refused_whole() {
    let mut bytes = message()[..92].to_vec();
    let beams = 2_751_u16;
    bytes[70..72].copy_from_slice(&beams.to_le_bytes());
    let size = 4 + 4 * beams;
    bytes[42..44].copy_from_slice(&size.to_le_bytes());
    bytes.extend(u32::from(beams).to_le_bytes());
    (0..beams).for_each(|index| bytes.extend([(index % 250) as u8, 4, 9, 1]));
    let mut rig = Rig::new();
    for from in (0..bytes.len()).step_by(1_460) {
        rig.push(&piece(&bytes, 7, (from, (from + 1_460).min(bytes.len()))), 0);
    }
    let capacity = floorguard_types::capacities::SCAN_BEAMS_MAX;
    if capacity >= usize::from(beams) {
        assert_eq!(rig.scans.len(), 1);
    } else {
        let error = ScanError::Beams { found: usize::from(beams), announced: beams };
        assert_eq!((rig.refused.as_slice(), rig.scans.len()), (&[error][..], 0));
    }
}

proptest! {
    /// Any cuts, any order, any duplicates: the scan comes exactly when the last byte does.
    #[test]
    fn message_completes_with_its_last_byte(
        spans in proptest::collection::vec((0_usize..116, 1_usize..80), 1..40),
    ) {
        let bytes = message();
        let mut rig = Rig::new();
        let mut covered = BTreeSet::new();
        for (from, length) in spans {
            let to = (from + length).min(bytes.len());
            covered.extend(from..to);
            rig.push(&piece(&bytes, 7, (from, to)), 0);
            prop_assert_eq!(rig.scans.len(), usize::from(covered.len() == bytes.len()));
        }
        prop_assert!(rig.refused.is_empty());
    }

    /// Any bytes behind a right beginning, any times: no panic, and nothing is invented.
    #[test]
    fn any_datagrams_do_no_harm(
        datagrams in proptest::collection::vec(
            (proptest::collection::vec(any::<u8>(), 0..80), any::<bool>(), 0_u64..300), 0..60),
    ) {
        let mut rig = Rig::new();
        let mut ms = 0;
        for (bytes, right_start, wait_ms) in datagrams {
            ms += wait_ms;
            let mut datagram = if right_start { b"MS3 MD\x01\x00".to_vec() } else { Vec::new() };
            datagram.extend(bytes);
            rig.push(&datagram, ms);
        }
        prop_assert!(rig.scans.is_empty());
    }

    /// Any bytes in place of the message's: an event or nothing, never a panic.
    #[test]
    fn any_message_is_a_scan_or_an_error(
        changes in proptest::collection::vec((0_usize..116, any::<u8>()), 0..12),
        cut in 0_usize..=116,
    ) {
        let mut bytes = message();
        for (at, byte) in changes {
            bytes[at] = byte;
        }
        bytes.truncate(cut.max(1));
        let mut rig = Rig::new();
        rig.push(&piece(&bytes, 7, (0, bytes.len())), 0);
        prop_assert!(rig.scans.len() + rig.refused.len() <= 1);
    }
}
