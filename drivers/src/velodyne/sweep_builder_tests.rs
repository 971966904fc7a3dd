//! Revolutions with missing sectors, slow heads, and heads that jitter.

extern crate std;
use std::boxed::Box;
use std::vec::Vec;

use floorguard_types::sensing::{LidarPacket, Sweep};
use floorguard_types::time::Stamp;

use super::decoder_tests::packet;
use super::*;

const PERIOD_US: u32 = 1_327;

/// Packet `number` of a head that turns 480 cdeg per packet, just under 600 rpm.
fn columns(number: u32) -> LidarPacket {
    let bytes = packet(480 * number, PERIOD_US * number, 500, [0x37, 0x22]);
    let arrival = Stamp::from_micros(u64::from(PERIOD_US * (number + 1)));
    Decoder::new(ModelChoice::Auto).decode(&bytes, arrival).expect("a valid packet").0
}

/// (columns, of which measured, lost packets) of every complete sweep; azimuths must rise and stay neighbours.
fn sweeps(received: impl IntoIterator<Item = (u32, u16)>) -> Vec<(usize, usize, u16)> {
    let mut building = Box::new(Sweep::<16>::EMPTY);
    let mut builder = SweepBuilder::new(18_000);
    let mut all = Vec::new();
    for (number, lost) in received {
        builder.add(&columns(number), lost, &mut building, |sweep| {
            let used = sweep.used_columns();
            for pair in used.windows(2) {
                let turned =
                    (u32::from(pair[1].azimuth_cdeg) + 36_000 - u32::from(pair[0].azimuth_cdeg)) % 36_000;
                assert!((10..=30).contains(&turned), "{turned} cdeg from column to column");
                assert!(pair[0].offset_us < pair[1].offset_us);
                let step_us = pair[1].offset_us - pair[0].offset_us;
                assert!((50..=62).contains(&step_us), "{step_us} us from column to column");
            }
            assert!(used.iter().filter(|column| !column.measured).all(|column| column.range_raw == [0; 16]));
            let measured = used.iter().filter(|column| column.measured).count();
            all.push((sweep.column_count, measured, sweep.lost_packets));
        });
    }
    all
}

#[test]
fn whole_revolutions_have_all_their_columns() {
    let all = sweeps((0..300).map(|number| (number, 0)));
    assert_eq!(all.len(), 4);
    assert!(all[1..].iter().all(|sweep| *sweep == (1_800, 1_800, 0)), "{all:?}");
}

#[test]
fn a_missing_sector_is_there_and_unknown() {
    let received = (0..300).filter(|number| !(100..105).contains(number));
    let all = sweeps(received.map(|number| (number, if number == 105 { 5 } else { 0 })));
    assert_eq!(all.len(), 4);
    assert!(all.contains(&(1_800, 1_680, 5)), "{all:?}");
}

#[test]
fn missing_sector_over_cut_adds_no_sweep() {
    // Packet 112 crosses the cut at 180 degrees (480 cdeg a packet: 37.5 packets).
    for first in 105..113 {
        for lost in 1..12_u16 {
            let end = first + u32::from(lost);
            let received = (0..300).filter(|number| !(first..end).contains(number));
            let all = sweeps(received.map(|number| (number, if number == end { lost } else { 0 })));
            assert_eq!(all.len(), 4, "packets {first} to {end}");
            assert!(all[1..].iter().all(|sweep| (1_799..=1_801).contains(&sweep.0)), "{all:?}");
        }
    }
}

#[test]
fn unreported_missing_sector_is_unknown() {
    let received = (0..200).filter(|number| !(100..105).contains(number));
    let all = sweeps(received.map(|number| (number, 0)));
    assert!(all.contains(&(1_800, 1_680, 0)), "{all:?}");
}

#[test]
fn a_whole_missing_revolution_is_unknown() {
    let received = (0..300).filter(|number| !(100..190).contains(number));
    let all = sweeps(received.map(|number| (number, if number == 190 { 90 } else { 0 })));
    assert_eq!(all.len(), 4);
    let measured: usize = all[1..].iter().map(|sweep| sweep.1).sum();
    assert_eq!(measured, 3 * 1_800 - 90 * 24);
}

#[test]
fn full_sweep_counts_dropped_columns() {
    // A head that swings back by a packet again and again never passes the cut.
    let mut building = Box::new(Sweep::<16>::EMPTY);
    let mut builder = SweepBuilder::new(18_000);
    for number in 0..100_u64 {
        let mut packet = columns(40);
        packet.stamp = Stamp::from_micros(number * 1_327);
        builder.add(&packet, 0, &mut building, |_| panic!("nothing is complete"));
    }
    assert_eq!((building.column_count, building.dropped_columns), (1_824, 2_400 - 1_824));
}

/// A packet of a slow head: firings 10 cdeg apart, one of every two at `near`, the other at `far`.
fn slow(number: u32, near: u16, far: u16) -> LidarPacket {
    apart(10, number, (near, far))
}

/// The same with firings any distance apart.
fn apart(step_cdeg: u32, number: u32, (near, far): (u16, u16)) -> LidarPacket {
    let mut packet = columns(number);
    for (index, column) in packet.columns.iter_mut().enumerate() {
        column.azimuth_cdeg = (step_cdeg * (24 * number + index as u32)) as u16 % 36_000;
        column.range_raw.fill(if index % 2 == 0 { near } else { far });
        column.reflectivity.fill(if index % 2 == 0 { 1 } else { 2 });
    }
    packet
}

/// At 300 rpm two firings share a column: the nearer return of both stays, and silence hides nothing.
#[test]
fn firings_of_a_slow_head_share_columns() {
    for (first, second, kept, bright) in
        [(500, 400, 400, 2), (400, 500, 400, 1), (0, 500, 500, 2), (500, 0, 500, 1), (300, 300, 300, 1)]
    {
        let mut building = Box::new(Sweep::<16>::EMPTY);
        let mut builder = SweepBuilder::new(18_000);
        for number in 0..3 {
            builder.add(&slow(number, first, second), 0, &mut building, |_| panic!("nothing is complete"));
        }
        assert_eq!(building.column_count, 3 * 12, "24 firings of each packet");
        for column in building.used_columns() {
            assert_eq!(column.azimuth_cdeg % 20, 0);
            assert_eq!(
                (column.range_raw, column.reflectivity),
                ([kept; 16], [bright; 16]),
                "{first} {second}"
            );
        }
    }
}

/// Firings share a column below 20 cdeg: those that are nearer than the room is fine, in the same 20 cdeg of the turn.
#[test]
fn firings_below_20_cdeg_share_columns() {
    for (step_cdeg, count) in [(17, 12), (18, 21), (19, 22), (20, 24)] {
        let mut building = Box::new(Sweep::<16>::EMPTY);
        let packet = apart(step_cdeg, 0, (500, 400));
        SweepBuilder::new(18_000).add(&packet, 0, &mut building, |_| panic!("nothing is complete"));
        assert_eq!(building.column_count, count, "{step_cdeg}");
    }
}

/// What was not measured stays unknown, however near the next firing is; the azimuth wraps.
#[test]
fn firing_merges_over_zero_not_unknown() {
    let mut building = Box::new(Sweep::<16>::EMPTY);
    let mut builder = SweepBuilder::new(18_000);
    let mut packet = slow(0, 500, 400);
    for (index, column) in packet.columns.iter_mut().enumerate() {
        column.azimuth_cdeg = ((35_990 + 10 * index as u32) % 36_000) as u16;
    }
    builder.add(&packet, 0, &mut building, |_| panic!("nothing is complete"));
    assert_eq!((building.column_count, building.used_columns()[0].range_raw), (12, [400; 16]));
    building.columns[11].measured = false;
    let mut next = slow(1, 500, 400);
    next.columns
        .iter_mut()
        .for_each(|column| column.azimuth_cdeg = (column.azimuth_cdeg + 36_000 - 20) % 36_000);
    builder.add(&next, 0, &mut building, |_| panic!("nothing is complete"));
    assert_eq!((building.column_count, building.columns[11].measured), (24, false));
}

/// Where a turn is cut is chosen: what one cut gives, every other gives too.
#[test]
fn a_turn_is_cut_where_it_is_wanted() {
    for cut_cdeg in [0, 9_000, 27_000] {
        let mut building = Box::new(Sweep::<16>::EMPTY);
        let mut builder = SweepBuilder::new(cut_cdeg);
        let mut whole = 0;
        for number in 0..300 {
            builder.add(&columns(number), 0, &mut building, |sweep| {
                let first = u32::from(sweep.used_columns()[0].azimuth_cdeg);
                let behind = (first + 36_000 - u32::from(cut_cdeg)) % 36_000;
                // The first one begins where the stream does.
                assert!(whole == 0 || (behind < 40 && sweep.column_count == 1_800), "{cut_cdeg}: {first}");
                whole += 1;
            });
        }
        assert!(whole >= 3, "{cut_cdeg}: {whole}");
    }
}
