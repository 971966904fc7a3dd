//! Bytes that a PandarXT-16 sent (book, Hesai: Sample), and packets that go wrong.

use floorguard_types::time::Stamp;
use std::vec::Vec;

use super::{DecodeError, Decoder, Packet, PacketError, ReturnMode};

/// Of a packet from 2019: start of the header and of the first block, and the end.
const HEADER: [u8; 12] = [0xEE, 0xFF, 0x06, 0x01, 0x00, 0x00, 0x10, 0x08, 0x01, 0x04, 0x02, 0x01];
const FIRST_BLOCK: [u8; 14] =
    [0x54, 0x69, 0x05, 0x01, 0x22, 0xFF, 0x04, 0x01, 0x2C, 0xFF, 0xFF, 0x00, 0x30, 0xFF];
const TAIL: [u8; 28] = [
    0x00, 0x00, 0x86, 0xEC, 0x07, 0x83, 0x83, 0x00, 0x01, 0x00, 0x39, 0x58, 0x02, 0x77, 0x07, 0x19, 0x04,
    0x0C, 0x1D, 0x65, 0x31, 0x04, 0x00, 0x42, 0xCE, 0x56, 0xF7, 0x00,
];

/// A packet with two echoes like the recorded one: blocks in pairs, 0.18° apart.
fn recorded() -> Vec<u8> {
    let mut bytes = HEADER.to_vec();
    for pair in 0..4_u16 {
        for _ in 0..2 {
            let mut block = [0; 66];
            block[..14].copy_from_slice(&FIRST_BLOCK);
            block[..2].copy_from_slice(&(26_964 + 18 * pair).to_le_bytes());
            bytes.extend(block);
        }
    }
    bytes.extend(TAIL);
    bytes
}

/// The same with another running number, and later by so many packets.
fn numbered(number: u32) -> Vec<u8> {
    let mut bytes = recorded();
    bytes[564..].copy_from_slice(&number.to_le_bytes());
    let micros = 274_789 + 200 * (number - 16_209_614);
    bytes[559..563].copy_from_slice(&micros.to_le_bytes());
    bytes
}

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

#[test]
fn recorded_packet_is_read() {
    let bytes = recorded();
    let packet = Packet::new_checked(&bytes).unwrap();
    assert_eq!((packet.lasers(), packet.rpm(), packet.return_mode()), (16, 600, ReturnMode::Dual));
    assert_eq!(packet.sequence(), Some(16_209_614));
    // 2019-07-25 04:12:29 and 274,789 us.
    assert_eq!(packet.hour_us(), (12 * 60 + 29) * 1_000_000 + 274_789);
    let block = packet.blocks().next().unwrap();
    assert_eq!(block.azimuth_cdeg, 26_964);
    assert_eq!(block.cells().take(3).collect::<Vec<_>>(), [(261, 0x22), (260, 0x2C), (255, 0x30)]);
}

#[test]
fn columns_go_up_and_are_timed() {
    let mut decoder = Decoder::new();
    let (packet, lost) = decoder.decode(&recorded(), at(1_000_000)).unwrap();
    assert_eq!((lost, packet.rings, packet.range_unit_mm, packet.columns.len()), (0, 16, 4, 4));
    let column = &packet.columns[0];
    assert_eq!(
        (column.range_raw[15], column.range_raw[14], column.range_raw[13], column.range_raw[0]),
        (261, 260, 255, 0)
    );
    assert_eq!(packet.columns.iter().map(|column| column.offset_us).collect::<Vec<_>>(), [0, 50, 100, 150]);
    assert_eq!(packet.columns[3].azimuth_cdeg, 27_018);
    // Four firings of 50 us end when the datagram is sent.
    assert_eq!(packet.stamp, at(999_800));
}

/// Of an XT-32 the guard gets the lasers of an XT-16. The others lie a degree below each, and come behind them afterwards.
#[test]
fn other_lasers_of_32_wait_behind() {
    let mut bytes = HEADER.to_vec();
    (bytes[6], bytes[10]) = (32, 1);
    for block in 0..8_u16 {
        bytes.extend((18 * block).to_le_bytes());
        for laser in 0..32_u16 {
            bytes.extend((1_000 + laser).to_le_bytes());
            bytes.extend([laser as u8, 0]);
        }
    }
    let mut tail = TAIL;
    tail[10] = 0x37;
    bytes.extend(tail);
    let mut decoder = Decoder::new().with_lasers_max(16).every_second_of_32();
    let (mut packet, _) = decoder.decode(&bytes, at(1_000_000)).unwrap();
    let by_laser = |ring: u16| 1_000 + 2 * (15 - ring);
    assert_eq!((packet.rings, packet.columns.len()), (16, 8));
    for column in &packet.columns {
        assert!((0..16).all(|ring| column.range_raw[usize::from(ring)] == by_laser(ring)));
        assert!(column.range_raw[16..].iter().all(|raw| *raw == 0));
    }
    decoder.put_second_rings(&mut packet);
    assert_eq!(packet.rings, 32);
    for column in &packet.columns {
        assert!((0..16).all(|ring| column.range_raw[usize::from(ring)] == by_laser(ring)));
        let others = (0..16).zip(&column.range_raw[16..]).zip(&column.reflectivity[16..]);
        for ((ring, raw), reflectivity) in others {
            assert_eq!((*raw, u16::from(*reflectivity)), (by_laser(ring) + 1, by_laser(ring) - 999));
        }
    }
    // Of an XT-16 there are no others.
    let (mut packet, _) = Decoder::new().decode(&recorded(), at(2_000_000)).unwrap();
    let before = packet.clone();
    Decoder::new().put_second_rings(&mut packet);
    assert_eq!(packet, before);
}

/// Of two echoes the nearer one counts; one of the robot itself does not.
#[test]
fn nearer_echo_counts_unless_it_is_the_robot() {
    let mut bytes = recorded();
    let second = 12 + 66 + 2;
    bytes[second..second + 2].copy_from_slice(&200_u16.to_le_bytes());
    let (packet, _) = Decoder::new().decode(&bytes, at(1_000_000)).unwrap();
    assert_eq!(packet.columns[0].range_raw[15], 200);
    let mut decoder = Decoder::new().with_blind_range_mm(1_000);
    let (packet, _) = decoder.decode(&bytes, at(1_000_000)).unwrap();
    assert_eq!((packet.columns[0].range_raw[15], decoder.counters().self_returns), (261, 1));
}

#[test]
fn lost_and_repeated_packets_are_counted() {
    let mut decoder = Decoder::new();
    for (number, expected) in [(16_209_614, Ok(0)), (16_209_615, Ok(0)), (16_209_619, Ok(3))] {
        let arrival = at(1_000_000 + 200 * u64::from(number - 16_209_614));
        assert_eq!(decoder.decode(&numbered(number), arrival).map(|(_, lost)| lost), expected);
    }
    for old in [16_209_619, 16_209_616] {
        let error = decoder.decode(&numbered(old), at(1_001_200)).unwrap_err();
        assert!(matches!(error, DecodeError::NotNewer { .. }), "{error}");
    }
    // Without numbers the times tell.
    let mut decoder = Decoder::new();
    for (number, expected) in [(16_209_614, 0), (16_209_618, 3)] {
        let mut bytes = numbered(number);
        bytes[11] = 0;
        let arrival = at(1_000_000 + 200 * u64::from(number - 16_209_614));
        assert_eq!(decoder.decode(&bytes, arrival).unwrap().1, expected);
    }
    assert_eq!(decoder.counters().lost, 3);
}

#[test]
fn each_wrong_value_is_refused_by_name() {
    let with = |place: usize, value: u8| {
        let mut bytes = recorded();
        bytes[place] = value;
        Decoder::new().decode(&bytes, at(1_000_000)).unwrap_err()
    };
    assert_eq!(with(0, 0xFF), DecodeError::Packet(PacketError::Start { found: [0xFF, 0xFF, 6] }));
    assert_eq!(with(2, 4), DecodeError::Packet(PacketError::Start { found: [0xEE, 0xFF, 4] }));
    assert_eq!(with(6, 40), DecodeError::Packet(PacketError::Shape { lasers: 40, blocks: 8, unit_mm: 4 }));
    assert_eq!(with(6, 32), DecodeError::Packet(PacketError::Length { received: 568 }));
    assert_eq!(with(9, 5), DecodeError::Packet(PacketError::Shape { lasers: 16, blocks: 8, unit_mm: 5 }));
    assert_eq!(with(550, 0x3D), DecodeError::Packet(PacketError::ReturnMode { found: 0x3D }));
    assert_eq!(with(557, 60), DecodeError::Packet(PacketError::Time { found: [60, 0x1D], micros: 274_789 }));
    assert_eq!(with(13, 0xFF), DecodeError::Packet(PacketError::Azimuth { block: 0, azimuth_cdeg: 0xFF54 }));
    assert_eq!(with(12 + 66, 0x53), DecodeError::NoPairs { first_cdeg: 26_964, second_cdeg: 26_963 });
    let large = Decoder::new().with_lasers_max(8).decode(&recorded(), at(1_000_000)).unwrap_err();
    assert_eq!(large, DecodeError::TooManyLasers { lasers: 16, lasers_max: 8 });
}

/// The head stands: azimuths say nothing. A closed sector between two firings is no such case, and what follows it is later.
#[test]
fn standing_head_refused_and_closed_sector_timed() {
    let turned = |azimuths: [u16; 4]| {
        let mut bytes = recorded();
        for (pair, azimuth) in azimuths.into_iter().enumerate() {
            for block in [2 * pair, 2 * pair + 1] {
                bytes[12 + 66 * block..][..2].copy_from_slice(&azimuth.to_le_bytes());
            }
        }
        Decoder::new().decode(&bytes, at(1_000_000))
    };
    assert_eq!(turned([100, 100, 118, 136]).unwrap_err(), DecodeError::Rotation { gap_cdeg: 0 });
    assert_eq!(turned([100, 9_000, 18_000, 18_018]).unwrap_err(), DecodeError::Rotation { gap_cdeg: 9_000 });
    // From 350° over the closed sector to 10°: 20° at 600 rpm are 5.56 ms.
    let (packet, _) = turned([34_982, 35_000, 1_000, 1_018]).unwrap();
    assert_eq!(
        packet.columns.iter().map(|column| column.offset_us).collect::<Vec<_>>(),
        [0, 50, 5_655, 5_705]
    );
    assert_eq!(packet.stamp, at(1_000_000 - 200 - 5_555));
    assert_eq!(turned([35_964, 35_982, 36_000, 18]).unwrap().0.columns[2].azimuth_cdeg, 0);
}

proptest::proptest! {
    /// Any bytes: an answer, no panic, and no azimuth beyond the turn.
    #[test]
    fn any_bytes_give_columns_or_an_error(changes in proptest::collection::vec((0..568_usize, 0..=255_u8), 0..40)) {
        let mut bytes = recorded();
        changes.iter().for_each(|(place, value)| bytes[*place] = *value);
        if let Ok((packet, _)) = Decoder::new().decode(&bytes, at(1_000_000)) {
            proptest::prop_assert!(packet.columns.iter().all(|column| column.azimuth_cdeg < 36_000));
            proptest::prop_assert!(packet.columns.len() <= 8);
        }
    }
}
