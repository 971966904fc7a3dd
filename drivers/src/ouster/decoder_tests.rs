//! What is lost, repeated or not measured is unknown; times and azimuths are those of the columns.

use std::vec::Vec;

use super::{Beams, DataFormat, DecodeError, Decoder, Packet, PacketError};
use floorguard_types::sensing::LidarPacket;
use floorguard_types::time::Stamp;

const COLUMN_NS: u64 = 97_656;

/// Sixteen beams, in turn 3.164° before, at, and behind their column; 1,024 columns.
fn beams() -> Beams {
    let mut beams = Beams { format: DataFormat::Single, ..Beams::even(16, (15_000, -15_000)) };
    for (channel, azimuth) in beams.azimuth_mdeg.iter_mut().enumerate() {
        *azimuth = [3_164, 0, -3_164][channel % 3];
    }
    beams
}

/// A packet in which every beam of column c measures 1 m + 4 mm · c; `valid` says which columns are measured.
fn packet(frame: u16, first: u16, valid: impl Fn(u16) -> bool) -> Vec<u8> {
    let mut bytes = std::vec![0; 32];
    bytes[..4].copy_from_slice(&[1, 0, frame as u8, (frame >> 8) as u8]);
    for column in first..first + 16 {
        let sensor_ns = (u64::from(frame) * 1_024 + u64::from(column)) * COLUMN_NS;
        let sensor_ns = if valid(column) { sensor_ns } else { 0 };
        bytes.extend(sensor_ns.to_le_bytes());
        bytes.extend(column.to_le_bytes());
        bytes.extend([u8::from(valid(column)), 0]);
        for _ in 0..16 {
            bytes.extend((1_000 + 4 * u32::from(column)).to_le_bytes());
            bytes.extend([7, 0, 0, 0, 0, 0, 0, 0]);
        }
    }
    bytes.resize(bytes.len() + 32, 0);
    bytes
}

/// Arrives as its last column is measured.
fn arrival(frame: u16, first: u16) -> Stamp {
    let last = u64::from(frame) * 1_024 + u64::from(first) + 15;
    Stamp::from_micros(1_000_000 + last * COLUMN_NS / 1_000)
}

fn decode(decoder: &mut Decoder, frame: u16, first: u16) -> Result<(LidarPacket, u16), DecodeError> {
    decoder.decode(&packet(frame, first, |_| true), arrival(frame, first))
}

#[test]
fn beams_of_one_azimuth_share_a_column() {
    let mut decoder = Decoder::new(&beams());
    decode(&mut decoder, 5, 0).unwrap();
    decode(&mut decoder, 5, 16).unwrap();
    let (packet, lost) = decode(&mut decoder, 5, 32).unwrap();
    assert_eq!((packet.columns.len(), packet.rings, packet.range_unit_mm, lost), (16, 16, 4, 0));
    for (number, column) in packet.columns.iter().enumerate() {
        // The columns that are complete are those nine before.
        let complete = 32 + number - 9;
        assert_eq!(usize::from(column.azimuth_cdeg), 18_000 + complete * 36_000 / 1_024);
        for ring in 0..16 {
            let shift = [9, 0, -9][(15 - ring) % 3];
            let measured = complete as i32 - shift;
            assert_eq!(i32::from(column.range_raw[ring]), 250 + measured, "ring {ring}");
            assert_eq!(column.reflectivity[ring], 7);
        }
        let stamp_us = packet.stamp.as_micros() + u64::from(column.offset_us);
        let measured_us = 1_000_000 + (5 * 1_024 + complete as u64) * COLUMN_NS / 1_000;
        assert!(stamp_us.abs_diff(measured_us) <= 2, "{stamp_us} for {measured_us}");
    }
}

#[test]
fn turns_go_on_without_a_seam() {
    let mut decoder = Decoder::new(&beams());
    let mut before = None;
    for number in 0..200_u16 {
        let (frame, first) = (65_534_u16.wrapping_add(number / 64), number % 64 * 16);
        let bytes = packet(frame, first, |_| true);
        let arrival = Stamp::from_micros(1_000_000 + u64::from(number) * 16 * COLUMN_NS / 1_000);
        let outcome = decoder.decode(&bytes, arrival).unwrap();
        assert_eq!(outcome.1, 0, "packet {number}");
        for column in &outcome.0.columns {
            let turned =
                before.map_or(35, |before| (36_000 + u32::from(column.azimuth_cdeg) - before) % 36_000);
            assert!((35..=36).contains(&turned), "packet {number}: {turned} cdeg");
            before = Some(u32::from(column.azimuth_cdeg));
        }
    }
}

#[test]
fn lost_packets_are_counted_and_unknown() {
    let mut decoder = Decoder::new(&beams());
    decode(&mut decoder, 5, 0).unwrap();
    decode(&mut decoder, 5, 16).unwrap();
    // Two packets are missing.
    let (packet, lost) = decode(&mut decoder, 5, 64).unwrap();
    assert_eq!((lost, decoder.counters().lost), (2, 2));
    for column in &packet.columns {
        let complete = (u32::from(column.azimuth_cdeg) - 18_000 + 35) * 1_024 / 36_000;
        // Nothing of the missing columns 32 to 63.
        for (ring, raw) in column.range_raw.iter().take(16).enumerate().filter(|(_, raw)| **raw > 0) {
            let measured = u32::from(*raw) - 250;
            assert!(!(32..64).contains(&measured), "ring {ring} of column {complete} has {measured}");
        }
        assert!(column.range_raw.contains(&0), "beams that looked there from a missing column are unknown");
    }
    assert_eq!(decode(&mut decoder, 6, 0).unwrap().1, 59, "the rest of the turn");
}

#[test]
fn repeated_and_overtaken_packets_are_refused() {
    let mut decoder = Decoder::new(&beams());
    decode(&mut decoder, 5, 64).unwrap();
    for (frame, first) in [(5, 64), (5, 0), (4, 1_008), (4, 624)] {
        let refused = decode(&mut decoder, frame, first);
        assert_eq!(refused.map(|_| ()), Err(DecodeError::NotNewer { frame, column: first }));
    }
    assert_eq!(decoder.counters().not_newer, 4);
    decode(&mut decoder, 5, 80).unwrap();
    // A sensor that was started anew counts its turns from the beginning.
    assert_eq!(decode(&mut decoder, 0, 0).unwrap().1, 0);
    assert_eq!(decode(&mut decoder, 0, 16).unwrap().1, 0);
}

#[test]
fn unmeasured_columns_are_left_out() {
    let mut decoder = Decoder::new(&Beams { azimuth_mdeg: [0; 128], ..beams() });
    let bytes = packet(5, 0, |column| column % 4 != 0);
    let (packet_out, _) = decoder.decode(&bytes, arrival(5, 0)).unwrap();
    assert_eq!((packet_out.columns.len(), decoder.counters().invalid_columns), (12, 4));
    assert!(packet_out.columns.iter().all(|column| column.range_raw[0] % 4 != 250 % 4));
    let nothing = packet(5, 16, |_| false);
    assert_eq!(decoder.decode(&nothing, arrival(5, 16)).map(|_| ()), Err(DecodeError::NothingMeasured));
}

#[test]
fn sensors_of_another_kind_are_refused() {
    let mut decoder = Decoder::new(&beams());
    let expected = Packet::length(&beams());
    let short = decoder.decode(&[0; 100], Stamp::ZERO).map(|_| ());
    assert_eq!(short, Err(DecodeError::Packet(PacketError::Length { received: 100, expected })));
    let mut other = packet(5, 0, |_| true);
    other[0] = 2;
    let refused = decoder.decode(&other, Stamp::ZERO).map(|_| ());
    assert_eq!(refused, Err(DecodeError::Packet(PacketError::Type { found: 2 })));
    // A sensor of 2,048 columns a turn: beyond those of its metadata.
    let refused = decoder.decode(&packet(5, 1_024, |_| true), Stamp::ZERO).map(|_| ());
    assert_eq!(refused, Err(DecodeError::Packet(PacketError::Columns { found: 1_024, expected: 1_023 })));
    let mut torn = packet(5, 0, |_| true);
    torn[32 + 204 + 8] = 9;
    let refused = decoder.decode(&torn, Stamp::ZERO).map(|_| ());
    assert_eq!(refused, Err(DecodeError::Packet(PacketError::Columns { found: 9, expected: 1 })));
    let mut slow = packet(5, 0, |_| true);
    slow[32 + 15 * 204..][..8].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(matches!(decoder.decode(&slow, Stamp::ZERO), Err(DecodeError::Times { .. })));
    assert_eq!(decoder.counters().refused, 5);
}

/// A packet of 64 beams of which every one measures 100 counts and its number.
fn of_64_beams() -> (Beams, Vec<u8>) {
    let many = Beams { format: DataFormat::LowRate, ..Beams::even(64, (22_500, -22_500)) };
    let mut bytes = std::vec![0; Packet::length(&many)];
    bytes[0] = 1;
    for (number, column) in (0_u16..).zip(bytes[32..32 + 16 * 268].chunks_exact_mut(268)) {
        column[..8].copy_from_slice(&(u64::from(number) * COLUMN_NS).to_le_bytes());
        column[8..12].copy_from_slice(&[number as u8, 0, 1, 0]);
        for (channel, pixel) in (0_u16..).zip(column[12..].chunks_exact_mut(4)) {
            pixel[..2].copy_from_slice(&(100 + channel).to_le_bytes());
        }
    }
    (many, bytes)
}

/// The guard gets what it gets without a second look; the rings of that one come behind them afterwards.
#[test]
fn second_rings_wait_behind_the_first() {
    let (many, bytes) = of_64_beams();
    let (mut one, mut two) = (Decoder::new(&many), Decoder::new(&many));
    one.set_rings_max(16);
    two.set_second_look();
    let [one, mut packet] = [&mut one, &mut two].map(|decoder| {
        let (packet, _) = decoder.decode(&bytes, Stamp::from_micros(9_000_000)).unwrap();
        packet
    });
    assert_eq!(packet, one);
    two.put_second_rings(&mut packet);
    assert_eq!(packet.rings, 32);
    for (column, alone) in packet.columns.iter().zip(&one.columns) {
        assert_eq!(column.range_raw[..16], alone.range_raw[..16]);
        for (raw, channel) in column.range_raw[16..].iter().zip(many.second_rings()) {
            assert_eq!(*raw, 2 * (100 + u16::from(channel)));
        }
    }
}

#[test]
fn fewer_rings_are_chosen_where_asked() {
    let (many, bytes) = of_64_beams();
    let mut decoder = Decoder::new(&many);
    decoder.set_rings_max(16);
    let (packet, _) = decoder.decode(&bytes, Stamp::from_micros(9_000_000)).unwrap();
    assert_eq!((packet.rings, packet.columns.len()), (16, 16));
    let chosen = many.rings(16);
    for (ring, channel) in chosen.iter().enumerate() {
        // 8 mm a count of the sensor, 4 mm of ours.
        assert_eq!(packet.columns[3].range_raw[ring], 2 * (100 + u16::from(*channel)));
    }
    assert!(packet.columns[3].range_raw[16..].iter().all(|raw| *raw == 0));
}
