//! Lidars that are set to a field of view: nothing is spread over the closed sector, nothing of it is lost, and packets
//! with its edges are taken.

extern crate std;
use std::boxed::Box;
use std::vec::Vec;

use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use super::*;

/// Nanoseconds of a block, and hundredths of a degree that the head turns in it at 600 rpm.
const BLOCK_NS: u64 = 110_592;
const TURN_NS: u64 = 100_000_000;

/// The blocks of some turns that begin within a field of view: azimuth and time. Firing goes on outside it; only what is
/// sent is left out.
fn blocks(view: (u64, u64), turns: u64) -> Vec<(u16, u64)> {
    let all = (0..turns * TURN_NS / BLOCK_NS).map(|number| number * BLOCK_NS);
    let azimuth = |time_ns: u64| (time_ns % TURN_NS) * 36_000 / TURN_NS;
    let (from, until) = view;
    let is_open =
        |cdeg: u64| if from < until { (from..until).contains(&cdeg) } else { cdeg >= from || cdeg < until };
    all.filter(|time_ns| is_open(azimuth(*time_ns)))
        .map(|time_ns| (azimuth(time_ns) as u16, time_ns))
        .collect()
}

/// Twelve blocks a packet, each at 1 m in all channels, with the stamp of the first and the time of arrival.
fn packets(view: (u64, u64), turns: u64) -> Vec<(Vec<u8>, Stamp)> {
    let whole = blocks(view, turns);
    let (twelve, _) = whole.as_chunks::<12>();
    let packet = |blocks: &[(u16, u64); 12]| {
        let mut bytes = Vec::new();
        for (azimuth_cdeg, _) in blocks {
            bytes.extend([0xff, 0xee]);
            bytes.extend(azimuth_cdeg.to_le_bytes());
            (0..32).for_each(|_| bytes.extend([0xf4, 0x01, 50]));
        }
        bytes.extend(((blocks[0].1 / 1_000) as u32).to_le_bytes());
        bytes.extend([0x37, 0x22]);
        (bytes, Stamp::from_micros(7_000_000 + (blocks[11].1 + BLOCK_NS) / 1_000))
    };
    twelve.iter().map(packet).collect()
}

/// 320° to 41°, half a turn, and all but 20°.
const VIEWS: [(u64, u64); 3] = [(32_000, 4_100), (9_000, 27_000), (1_000, 35_000)];

#[test]
fn packets_of_a_closed_sector_are_not_lost() {
    for view in VIEWS {
        let mut decoder = Decoder::new(ModelChoice::Auto);
        for (bytes, arrival) in packets(view, 20) {
            decoder.decode(&bytes, arrival).expect("the packet is taken");
        }
        let counters = decoder.counters();
        assert_eq!((counters.refused, counters.lost), (0, 0), "{view:?}");
        let closed = decoder.closed_sector().expect("it has shown");
        let (from, until) = (i64::from(closed.from_cdeg), i64::from(closed.until_cdeg));
        assert!((from - view.1 as i64).abs() <= 40 && (until - view.0 as i64).abs() <= 40, "{closed}");
    }
}

#[test]
fn lost_packets_beside_a_closed_sector_count() {
    for view in VIEWS {
        let mut decoder = Decoder::new(ModelChoice::Auto);
        let all = packets(view, 20);
        let missing =
            |number: usize| (100..103).contains(&number) || number == 150 || (180..184).contains(&number);
        for (_, (bytes, arrival)) in all.iter().enumerate().filter(|(number, _)| !missing(*number)) {
            decoder.decode(bytes, *arrival).expect("the packet is taken");
        }
        assert_eq!(decoder.counters().lost, 8, "{view:?}");
    }
}

/// Every return lies where the head was open, and every column is stamped when it was fired.
#[test]
fn nothing_is_spread_over_a_closed_sector() {
    for view in VIEWS {
        let (from, until) = (view.0 as i64, view.1 as i64);
        let is_open = |cdeg: u16| {
            let cdeg = i64::from(cdeg);
            if from < until { (from..until + 40).contains(&cdeg) } else { cdeg >= from || cdeg < until + 40 }
        };
        let mut decoder = Decoder::new(ModelChoice::Auto);
        for (bytes, arrival) in packets(view, 10) {
            let checked = Packet::new_checked(&bytes).expect("a packet");
            Returns::new(Model::Vlp16).for_each(&checked, ReturnsOf::AllCells, |each| {
                assert!(is_open(each.azimuth_cdeg), "{each:?}");
                let time_ns = u64::from(checked.stamp_us()) * 1_000 + u64::from(each.offset_ns);
                let head_cdeg = time_ns % TURN_NS * 36_000 / TURN_NS;
                let off = (head_cdeg + 36_000 - u64::from(each.azimuth_cdeg)) % 36_000;
                assert!(!(150..=35_850).contains(&off), "{each:?} while the head was at {head_cdeg}");
            });
            let (columns, _) = decoder.decode(&bytes, arrival).expect("taken");
            for column in &columns.columns {
                assert!(is_open(column.azimuth_cdeg), "{}", column.azimuth_cdeg);
                let time_us = columns.stamp.as_micros() + u64::from(column.offset_us) - 7_000_000;
                let head_cdeg = time_us * 1_000 % TURN_NS * 36_000 / TURN_NS;
                let off = (head_cdeg + 36_000 - u64::from(column.azimuth_cdeg)) % 36_000;
                assert!(!(150..=35_850).contains(&off), "{} at {head_cdeg}", column.azimuth_cdeg);
            }
        }
    }
}

#[test]
fn a_closed_sector_is_unknown_in_the_sweep() {
    for view in VIEWS {
        let (mut decoder, mut builder) = (Decoder::new(ModelChoice::Auto), SweepBuilder::new(18_000));
        let mut building = Box::new(Sweep::<16>::EMPTY);
        let mut whole = Vec::new();
        for (bytes, arrival) in packets(view, 10) {
            let (columns, lost) = decoder.decode(&bytes, arrival).expect("taken");
            builder.add(&columns, lost, &mut building, |sweep| {
                let used = sweep.used_columns();
                for pair in used.windows(2) {
                    let turned =
                        (u32::from(pair[1].azimuth_cdeg) + 36_000 - u32::from(pair[0].azimuth_cdeg)) % 36_000;
                    assert!((10..=30).contains(&turned), "{turned} cdeg from column to column");
                    // In the first turns nobody knows yet how fast the head turns to 0.2 ms.
                    assert!(whole.len() < 2 || pair[0].offset_us <= pair[1].offset_us);
                }
                let measured = used.iter().filter(|column| column.measured).count();
                whole.push((sweep.column_count, measured, sweep.lost_packets, sweep.dropped_columns));
            });
        }
        let open = if view.0 < view.1 { view.1 - view.0 } else { view.1 + 36_000 - view.0 };
        let firings = (open * 1_808 / 36_000) as usize;
        for (columns, measured, lost, dropped) in &whole[1..] {
            assert!((1_800..=1_812).contains(columns), "{columns} columns");
            assert!(measured.abs_diff(firings) <= 4, "{measured} measured of {firings}");
            assert_eq!((*lost, *dropped), (0, 0));
        }
    }
}

/// One block with a wrong azimuth is no closed sector: it is left out, or its packet is refused.
#[test]
fn a_wrong_azimuth_is_no_closed_sector() {
    for wrong in 0..12 {
        let mut bytes = packets((0, 36_000), 1).remove(3).0;
        bytes[wrong * 100 + 2..wrong * 100 + 4].copy_from_slice(&30_000_u16.to_le_bytes());
        let mut decoder = Decoder::new(ModelChoice::Auto);
        match decoder.decode(&bytes, Stamp::from_micros(9_000_000)) {
            Ok((packet, _)) => assert!(packet.columns.iter().all(|column| column.azimuth_cdeg < 29_000)),
            Err(error) => assert!(matches!(error, DecodeError::Rotation { .. }), "{error}"),
        }
        assert_eq!(decoder.closed_sector(), None);
    }
}

/// What had been closed and is open again is no closed sector any more.
#[test]
fn a_sector_that_is_opened_is_seen() {
    let mut decoder = Decoder::new(ModelChoice::Auto);
    for (bytes, arrival) in packets((9_000, 27_000), 4) {
        decoder.decode(&bytes, arrival).expect("taken");
    }
    assert!(decoder.closed_sector().is_some());
    for (bytes, arrival) in packets((0, 36_000), 8).into_iter().skip(4 * 76) {
        decoder.decode(&bytes, arrival).expect("taken");
    }
    assert_eq!(decoder.closed_sector(), None);
}

/// A view whose edge falls between two packets in the first turn: what was taken for lost is taken back.
#[test]
fn an_edge_between_packets_shows_later() {
    let view = (9_000, 27_000);
    let whole = packets(view, 30);
    for first in 0..60 {
        let mut decoder = Decoder::new(ModelChoice::Auto);
        for (bytes, arrival) in &whole[first..] {
            decoder.decode(bytes, *arrival).expect("taken");
        }
        assert_eq!((decoder.counters().lost, decoder.closed_sector().is_some()), (0, true), "from {first}");
    }
}
