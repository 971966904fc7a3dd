//! Points of a made-up sensor: where they come out, when, and what is refused.

use std::vec::Vec;

use super::*;
use floorguard_types::sensing::LidarPacket;
use floorguard_types::time::Stamp;

/// Points of a datagram, and from one to the next, nanoseconds.
const POINTS: u64 = 96;
const POINT_NS: u64 = 5_000;
const DATAGRAM_NS: u64 = POINTS * POINT_NS;
/// The sensor's clock when the robot's shows 1 s.
const BEGIN_NS: u64 = 7_000_000_000;

/// zlib CRC-32.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 },
        )
    })
}

/// A datagram of points in millimetres, by the table of the book.
fn datagram(time_ns: u64, points: &[[i32; 3]]) -> Vec<u8> {
    let mut bytes = std::vec![0_u8; 36];
    let length = (36 + points.len() * 14) as u16;
    bytes[1..3].copy_from_slice(&length.to_le_bytes());
    bytes[3..5].copy_from_slice(&((points.len() as u64 - 1) * POINT_NS / 100).to_le_bytes()[..2]);
    bytes[5..7].copy_from_slice(&(points.len() as u16).to_le_bytes());
    bytes[10] = 1;
    bytes[28..36].copy_from_slice(&time_ns.to_le_bytes());
    for [x, y, z] in points {
        for number in [x, y, z] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([30, 0]);
    }
    let checksum = crc32(&bytes[28..]);
    bytes[24..28].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

/// A sensor whose beams jump about at random within its field of view, in the middle of a cylinder.
struct Sensor {
    random: floorguard_types::random::Pcg32,
    /// The next datagram.
    number: u64,
}

impl Sensor {
    fn new() -> Self {
        Self { random: floorguard_types::random::Pcg32::new(1, 1), number: 0 }
    }

    fn arrival(number: u64) -> Stamp {
        Stamp::from_micros(1_000_000 + (number + 1) * DATAGRAM_NS / 1_000)
    }

    /// The next datagram, and when it arrives; everything in a direction (azimuth clockwise, degrees) is so far away, metres.
    fn next(&mut self, distance_m: impl Fn(f32) -> f32) -> (Vec<u8>, Stamp) {
        let points: Vec<[i32; 3]> = (0..POINTS)
            .map(|_| {
                let (azimuth, up) =
                    (self.random.below(36_000) as f32 / 100.0, self.random.below(5_900) as f32 / 100.0 - 7.0);
                let (plane_mm, turned) = (distance_m(azimuth) * 1_000.0, azimuth.to_radians());
                [
                    (plane_mm * turned.cos()) as i32,
                    (-plane_mm * turned.sin()) as i32,
                    (plane_mm * up.to_radians().tan()) as i32,
                ]
            })
            .collect();
        let made = (datagram(BEGIN_NS + self.number * DATAGRAM_NS, &points), Self::arrival(self.number));
        self.number += 1;
        made
    }
}

fn decoder() -> Decoder {
    Decoder::new(&DEFAULT_ELEVATIONS_MDEG)
}

/// All that comes out of so many datagrams.
fn packets(
    decoder: &mut Decoder,
    sensor: &mut Sensor,
    datagrams: u64,
    distance_m: impl Fn(f32) -> f32,
) -> Vec<(LidarPacket, Stamp)> {
    let made = (0..datagrams).map(|_| sensor.next(&distance_m));
    made.filter_map(|(bytes, arrival)| Some((decoder.decode(&bytes, arrival).ok()?.0, arrival))).collect()
}

#[test]
fn columns_come_clockwise_and_in_time() {
    let (mut decoder, mut sensor) = (decoder(), Sensor::new());
    let packets = packets(&mut decoder, &mut sensor, 1_000, |_| 4.0);
    let columns: Vec<(u16, u64)> = packets
        .iter()
        .flat_map(|(packet, _)| {
            let at = |offset_us: u32| packet.stamp.as_micros() + u64::from(offset_us);
            packet.columns.iter().map(move |column| (column.azimuth_cdeg, at(column.offset_us)))
        })
        .collect();
    // A second less the first turn, but for its last column.
    assert!((1_515..=1_520).contains(&columns.len()), "{}", columns.len());
    for pair in columns.windows(2) {
        assert_eq!((pair[0].0 + 90) % 36_000, pair[1].0);
        assert!((248..=252).contains(&(pair[1].1 - pair[0].1)), "{pair:?}");
    }
    for (packet, arrival) in &packets {
        let newest_us =
            packet.stamp.as_micros() + packet.columns.last().map_or(0, |column| u64::from(column.offset_us));
        let age_us = arrival.as_micros() - newest_us;
        assert!((50_000..51_000).contains(&age_us), "half a turn old: {age_us}");
        assert_eq!((packet.rings, packet.range_unit_mm), (16, 4));
    }
}

#[test]
fn distance_in_the_plane_is_kept() {
    let (mut decoder, mut sensor) = (decoder(), Sensor::new());
    let packets = packets(&mut decoder, &mut sensor, 1_000, |_| 4.0);
    let (mut cells, mut seen) = (0, 0);
    for column in packets.iter().flat_map(|(packet, _)| &packet.columns) {
        for (raw, mdeg) in column.range_raw.iter().zip(&DEFAULT_ELEVATIONS_MDEG) {
            cells += 1;
            if *raw != 0 {
                seen += 1;
                let plane_m = f32::from(*raw) * 0.004 * (*mdeg as f32 * 1.0e-3).to_radians().cos();
                assert!((plane_m - 4.0).abs() < 0.004, "{plane_m} m at {mdeg}");
            }
        }
    }
    // Points at random: 20,000 on 59° by 360°, of cells of 2° by 0.9° as many as 1 − e^(−1.69) have one.
    let share = f64::from(seen) / f64::from(cells);
    assert!((share - 0.816).abs() < 0.01, "{share}");
}

/// A post to the right: at 90° clockwise, and nowhere else.
#[test]
fn post_stands_at_its_azimuth() {
    let (mut decoder, mut sensor) = (decoder(), Sensor::new());
    let post = |azimuth: f32| if (azimuth - 90.0).abs() < 5.0 { 2.0 } else { 6.0 };
    let packets = packets(&mut decoder, &mut sensor, 1_000, post);
    for column in packets.iter().flat_map(|(packet, _)| &packet.columns) {
        let off_deg = (f32::from(column.azimuth_cdeg) / 100.0 - 90.0).abs();
        // The ring at 0° measures in the plane.
        let plane_m = f32::from(column.range_raw[3]) * 0.004;
        if plane_m > 0.0 && (off_deg - 5.0).abs() > 0.5 {
            let expected_m = if off_deg < 5.0 { 2.0 } else { 6.0 };
            assert!((plane_m - expected_m).abs() < 0.01, "{plane_m} m at {off_deg}° from the post");
        }
    }
}

/// What has gone is gone from the columns a turn later, and what comes is there within a turn.
#[test]
fn columns_forget_what_they_gave() {
    let (mut decoder, mut sensor) = (decoder(), Sensor::new());
    let _ = packets(&mut decoder, &mut sensor, 400, |_| 4.0);
    let turn = TURN_US * 1_000 / DATAGRAM_NS + 1;
    let _ = packets(&mut decoder, &mut sensor, turn, |_| 2.0);
    for (packet, _) in packets(&mut decoder, &mut sensor, turn, |_| 2.0) {
        assert!(packet.columns.iter().all(|column| column.range_raw[3] <= 501));
    }
    let _ = packets(&mut decoder, &mut sensor, turn, |_| 3.0);
    for (packet, _) in packets(&mut decoder, &mut sensor, turn, |_| 3.0) {
        assert!(packet.columns.iter().all(|column| column.range_raw[3] == 0 || column.range_raw[3] >= 749));
    }
}

/// Of several points in a cell the nearest is given, in whatever order they come.
#[test]
fn nearest_point_of_a_cell_counts() {
    let mut decoder = decoder();
    let nothing = [[0, 0, 0]; POINTS as usize];
    let mut given = Vec::new();
    for number in 0..420 {
        let mut points = nothing;
        if number == 209 {
            // Straight to the left, behind what was given out last.
            (points[3], points[4], points[5]) = ([0, 4_000, 0], [0, 2_000, 0], [0, 3_000, 0]);
        }
        let bytes = datagram(BEGIN_NS + number * DATAGRAM_NS, &points);
        let Ok((packet, _)) = decoder.decode(&bytes, Sensor::arrival(number)) else { continue };
        let met = packet.columns.iter().filter(|column| column.range_raw.iter().any(|raw| *raw != 0));
        given.extend(met.map(|column| (column.azimuth_cdeg, column.range_raw[3])));
    }
    assert_eq!(given, [(27_045, 500)]);
}

#[test]
fn lost_datagrams_are_counted_and_unknown() {
    let (mut decoder, mut sensor) = (decoder(), Sensor::new());
    let _ = packets(&mut decoder, &mut sensor, 400, |_| 4.0);
    // 30 datagrams are 57 columns: of those the newest 24 come.
    (0..30).for_each(|_| drop(sensor.next(|_| 4.0)));
    let (bytes, arrival) = sensor.next(|_| 4.0);
    let (packet, lost) = decoder.decode(&bytes, arrival).unwrap();
    assert_eq!((lost, packet.columns.len()), (30, 24));
    // A turn later the columns that were left out show nothing of what was in them then.
    let first_cdeg = packet.columns[0].azimuth_cdeg;
    let mut seen = 0;
    for (packet, _) in packets(&mut decoder, &mut sensor, 205, |_| 5.0) {
        for column in &packet.columns {
            let before_cdeg = (first_cdeg + 36_000 - column.azimuth_cdeg) % 36_000;
            if (90..=33 * 90).contains(&before_cdeg) {
                seen += column.range_raw.iter().filter(|raw| **raw != 0).count();
                assert!(column.range_raw[3] == 0 || column.range_raw[3] > 1_200, "{}", column.range_raw[3]);
            }
        }
    }
    assert!(seen > 300, "{seen} cells of 33 columns");
    assert_eq!(decoder.counters().lost, 30);
    // Half a turn without one: everything is gathered anew.
    (0..120).for_each(|_| drop(sensor.next(|_| 4.0)));
    let (bytes, arrival) = sensor.next(|_| 4.0);
    assert_eq!(decoder.decode(&bytes, arrival).unwrap_err(), DecodeError::Gathering);
}

#[test]
fn repeated_and_damaged_datagrams_change_nothing() {
    let (mut decoder, mut sensor) = (decoder(), Sensor::new());
    let _ = packets(&mut decoder, &mut sensor, 300, |_| 4.0);
    let (bytes, arrival) = sensor.next(|_| 4.0);
    decoder.decode(&bytes, arrival).unwrap();
    assert_eq!(decoder.decode(&bytes, arrival).unwrap_err(), DecodeError::NotNewer { older_us: 475 });
    let (bytes, arrival) = sensor.next(|_| 4.0);
    let change = |at: usize, value: u8| {
        let mut changed = bytes.clone();
        changed[at] = value;
        changed
    };
    let refused = |decoder: &mut Decoder, bytes: &[u8]| match decoder.decode(bytes, arrival) {
        Err(DecodeError::Packet(error)) => error,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&mut decoder, &change(0, 1)), PacketError::Version(1));
    assert_eq!(refused(&mut decoder, &change(10, 0)), PacketError::Kind(0));
    assert_eq!(refused(&mut decoder, &change(5, 97)), PacketError::Points(97));
    assert_eq!(refused(&mut decoder, &change(10, 3)), PacketError::Length { found: 1_380, needed: 996 });
    assert_eq!(refused(&mut decoder, &bytes[..35]), PacketError::Length { found: 35, needed: 36 });
    assert!(matches!(refused(&mut decoder, &change(40, 1)), PacketError::Checksum { .. }));
    // None of them has moved the clock or the columns.
    let (packet, lost) = decoder.decode(&bytes, arrival).unwrap();
    assert_eq!((lost, packet.columns.len()), (0, 2));
    // A sensor that writes no checksum is believed.
    let (mut bytes, arrival) = sensor.next(|_| 4.0);
    bytes[24..28].fill(0);
    decoder.decode(&bytes, arrival).unwrap();
}

proptest::proptest! {
    #[test]
    fn any_bytes_are_survived(bytes in proptest::collection::vec(proptest::num::u8::ANY, 0..1_500), kind in 0_u8..4, time: u64) {
        let mut decoder = decoder();
        let _ = decoder.decode(&bytes, Stamp::from_micros(1));
        // With a right head: points anywhere, at any time.
        let points = (bytes.len() / 14).clamp(1, 96);
        let corner = |at: usize| i32::from_le_bytes([0, 1, 2, 3].map(|next| bytes.get(at + next).copied().unwrap_or(0)));
        let list: Vec<[i32; 3]> = (0..points).map(|point| [0, 4, 8].map(|at| corner(point * 14 + at))).collect();
        let mut packet = datagram(time, &list);
        packet[10] = kind;
        let _ = decoder.decode(&packet, Stamp::from_micros(2));
        packet[10] = 1;
        let _ = decoder.decode(&packet, Stamp::from_micros(3));
        let _ = decoder.decode(&packet, Stamp::from_micros(u64::MAX));
    }
}
