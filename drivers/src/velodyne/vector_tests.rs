//! The synthetic packets of the book, Velodyne: Test packets, built from their rules.

extern crate std;
use std::vec::Vec;

use floorguard_types::time::Stamp;

use super::*;

/// T1: the even blocks of the captured packet without their flag; the odd ones are the same.
const T1_BLOCKS: [&str; 6] = [
    "4200000004dd0164000004c90215000006d602150000036401380000046301300000035b012100001264010d0000096b0119000004d90164000004ce021b000006dc02140000035d013b0000046401290000035d011c00000c6601130000096c0119",
    "6900000004db0164000004cd0223000006d703640000035b01350000046a013500000356011d00000c66011300000465011a000004e10164000004cb02270000063b04640000035901310000045f01310a01035c012600001259010d0000096f0119",
    "9100000004e10164000004cf02260000063d04640000036001390000045f01310000035d012600000662010d000004710118000004df0164000004a2036400000633046400000365013300000460013100000361012500000c6201130000096b0119",
    "b900000004db01640000043d046400000634046400000361013400000466012800000359012200001260010d00000972011e000004df016400000437046400000639046400000358013700000469012e0000035d01210000125c01140000096f0119",
    "e100000004e101640000043404640000063a04640000035c013000000461012a00000360011b0000125d010d0000046d0119000004e4016400000434046400000635046400000360012f0000045d012a0000035a012200001262010d0000046f0119",
    "0901000004da016400000438046400000632046400000366012e0000046401290000035e011c00001262010d000004700119000004db01640000043a04640000063404640000035b01350000046d012700000358011d00001267010c0000096b0119",
];

fn t1() -> Vec<u8> {
    let mut bytes = Vec::new();
    for block in T1_BLOCKS {
        for _ in 0..2 {
            bytes.extend([0xff, 0xee]);
            let digits = (0..block.len()).step_by(2);
            bytes.extend(digits.map(|at| u8::from_str_radix(&block[at..at + 2], 16).expect("hexadecimal")));
        }
    }
    bytes.extend([0x4c, 0xb1, 0x60, 0x08, 0x39, 0x22]);
    bytes
}

/// Zeros with flags, azimuths, the listed cells and the tail.
fn packet(
    azimuth: impl Fn(u32) -> u32,
    cells: &[(usize, usize, u16, u8)],
    stamp: u32,
    tail: [u8; 2],
) -> Vec<u8> {
    let mut bytes = std::vec![0; 1_206];
    for block in 0..12 {
        let start = block * 100;
        bytes[start..start + 2].copy_from_slice(&[0xff, 0xee]);
        bytes[start + 2..start + 4].copy_from_slice(&((azimuth(block as u32) % 36_000) as u16).to_le_bytes());
    }
    for (block, channel, raw, reflectivity) in cells {
        let start = block * 100 + 4 + channel * 3;
        bytes[start..start + 2].copy_from_slice(&raw.to_le_bytes());
        bytes[start + 2] = *reflectivity;
    }
    bytes[1_200..1_204].copy_from_slice(&stamp.to_le_bytes());
    bytes[1_204..].copy_from_slice(&tail);
    bytes
}

fn returns(model: Model, bytes: &[u8]) -> Vec<Return> {
    let mut all = Vec::new();
    let packet = Packet::new_checked(bytes).expect("a valid vector");
    Returns::new(model).for_each(&packet, ReturnsOf::DistinctEchoes, |each| all.push(each));
    all
}

/// (azimuth, time in ns, x, y, z); one centidegree of azimuth may differ between the interpolation rules.
fn agrees(found: &[Return], expected: &[(u16, u32, f32, f32, f32)]) {
    assert_eq!(found.len(), expected.len());
    for (each, (azimuth_cdeg, offset_ns, x_m, y_m, z_m)) in found.iter().zip(expected) {
        assert!(each.azimuth_cdeg.abs_diff(*azimuth_cdeg) <= 1, "{each:?}");
        assert_eq!(each.offset_ns, *offset_ns);
        let range_m = libm::sqrtf(x_m * x_m + y_m * y_m + z_m * z_m);
        let tolerance_m = 1.0e-5 + 2.0e-4 * range_m;
        let point = each.point_in_sensor;
        for (value, wanted) in [(point.x_m, x_m), (point.y_m, y_m), (point.z_m, z_m)] {
            assert!((value - wanted).abs() < tolerance_m, "{each:?} against {x_m} {y_m} {z_m}");
        }
    }
}

/// The packet was transcribed rightly: its zlib CRC-32.
fn is_transcribed(bytes: &[u8], crc: u32) {
    assert_eq!(crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes), crc);
}

#[test]
fn t1_a_captured_dual_return_packet() {
    let bytes = t1();
    is_transcribed(&bytes, 0x4c26_6472);
    let packet = Packet::new_checked(&bytes).expect("a valid vector");
    assert_eq!(packet.azimuths(), [66, 66, 105, 105, 145, 145, 185, 185, 225, 225, 265, 265]);
    assert_eq!((packet.stamp_us(), packet.is_dual(), packet.product_byte()), (140_554_572, true, 0x22));
    let all = returns(Model::Vlp16, &bytes);
    assert_eq!(all.len(), 97);
    let expected = [
        (67, 2304, 0.953790, -0.011154, 0.015918),
        (68, 6912, 1.423945, -0.016901, 0.072435),
        (70, 11520, 1.446367, -0.017672, 0.122883),
        (72, 16128, 0.706637, -0.008880, 0.081625),
        (73, 20736, 0.701202, -0.008934, 0.104431),
        (75, 25344, 0.681191, -0.008917, 0.124275),
        (77, 29952, 0.693689, -0.009323, 0.150489),
        (78, 34560, 0.701197, -0.009546, 0.176673),
        (87, 57600, 0.945747, -0.014362, 0.015778),
        (88, 62208, 1.433863, -0.022024, 0.072958),
    ];
    agrees(&all[..10], &expected);
    agrees(
        &all[95..],
        &[(296, 638_208, 0.698664, -0.036126, 0.151839), (297, 642_816, 0.700320, -0.036335, 0.176673)],
    );
    let sum = |value: fn(&Return) -> f32| all.iter().map(|each| f64::from(value(each))).sum::<f64>();
    assert!((sum(|each| each.point_in_sensor.x_m) - 99.80765).abs() < 1e-3);
    // 97 azimuths that the two rules may round differently.
    assert!((sum(|each| each.point_in_sensor.y_m) + 3.21206).abs() < 97.0 * 1.75e-4);
    assert!((sum(|each| each.point_in_sensor.z_m) - 10.98752).abs() < 1e-4);
    assert_eq!(sum(|each| f32::from(each.reflectivity)), 5142.0);
}

#[test]
fn t4_uneven_rotation_follows_each_block() {
    let azimuths = [0, 38, 76, 114, 152, 190, 228, 268, 308, 348, 388, 428];
    let cells = [(6, 16, 5000, 7), (7, 16, 5000, 7), (11, 16, 5000, 7)];
    let bytes = packet(|block| azimuths[block as usize], &cells, 12_345, [0x38, 0x22]);
    is_transcribed(&bytes, 0x9f74_bd3e);
    let found = returns(Model::Vlp16, &bytes);
    // The per-block rule, which is ours: to 10 micrometres.
    let expected = [(248, 9.650211, -0.417962), (288, 9.647058, -0.485323), (448, 9.629746, -0.754495)];
    for (each, (azimuth_cdeg, x_m, y_m)) in found.iter().zip(expected) {
        assert_eq!(each.azimuth_cdeg, azimuth_cdeg);
        let point = each.point_in_sensor;
        let off_m = [point.x_m - x_m, point.y_m - y_m, point.z_m + 2.576961];
        assert!(off_m.into_iter().all(|off_m| off_m.abs() < 1e-5), "{each:?}");
    }
    assert_eq!(found.len(), 3);
}

#[test]
fn t2_single_return_over_azimuth_and_hour_wrap() {
    let cells = [
        (0, 0, 500, 10),
        (0, 1, 1000, 20),
        (0, 16, 1500, 30),
        (2, 31, 2500, 255),
        (3, 15, 65535, 1),
        (5, 7, 1, 0),
        (11, 16, 5000, 100),
        (11, 31, 6000, 101),
    ];
    let bytes = packet(|block| 35_900 + 40 * block, &cells, 3_599_999_000, [0x37, 0x22]);
    is_transcribed(&bytes, 0x333c_a698);
    let expected = [
        (35900, 0, 0.965779, 0.016858, -0.247589),
        (35901, 2304, 1.999397, 0.034551, 0.034173),
        (35920, 55296, 2.897495, 0.040460, -0.765227),
        (13, 311040, 4.829617, -0.010958, 1.282866),
        (33, 366336, 126.6018, -0.729182, 33.91218),
        (106, 569088, 0.001985, -0.000037, -0.004902),
        (360, 1271808, 9.640198, -0.606510, -2.576961),
        (373, 1306368, 11.566557, -0.754057, 3.094599),
    ];
    agrees(&returns(Model::Vlp16, &bytes), &expected);
}

#[test]
fn t3_dual_return_gives_nearer_echo_to_columns() {
    let cells = [
        (0, 4, 1500, 40),
        (1, 4, 1200, 90),
        (0, 5, 800, 50),
        (1, 5, 800, 50),
        (3, 20, 700, 70),
        (10, 31, 3000, 9),
        (11, 31, 3000, 9),
    ];
    let bytes = packet(|block| 9_000 + 20 * (block / 2), &cells, 0, [0x39, 0x22]);
    is_transcribed(&bytes, 0x960d_7c0d);
    let expected = [
        (9002, 9216, -0.001028, -2.944881, -0.564281),
        (9002, 11520, -0.000556, -1.593911, 0.135783),
        (9002, 9216, -0.000822, -2.355905, -0.449795),
        (9032, 175104, -0.007675, -1.374257, -0.258986),
        (9116, 642816, -0.117327, -5.794367, 1.541685),
    ];
    agrees(&returns(Model::Vlp16, &bytes), &expected);
    let (columns, _) = Decoder::new(ModelChoice::Auto).decode(&bytes, Stamp::ZERO).expect("a valid vector");
    assert_eq!(columns.columns.len(), 12);
    assert_eq!((columns.columns[0].range_raw[2], columns.columns[0].reflectivity[2]), (1200, 90));
}

#[test]
fn t5_to_t7_other_models() {
    let vlp32 = packet(
        |block| 20 * block,
        &[(0, 0, 2500, 10), (0, 1, 2500, 11), (0, 5, 2500, 12), (5, 29, 2500, 13), (11, 31, 2500, 14)],
        1,
        [0x37, 0x28],
    );
    is_transcribed(&vlp32, 0xd9fe_1dbb);
    let expected = [
        (140, 0, 9.060372, -0.221431, -4.206411),
        (35580, 0, 9.971625, 0.732270, -0.173784),
        (35862, 4608, 9.9971, 0.240832, 0.0),
        (35973, 308736, 9.659142, 0.047204, 2.576829),
        (93, 642816, 9.995976, -0.162265, -0.231645),
    ];
    agrees(&returns(Model::Vlp32C, &vlp32), &expected);
    let hdl32 = packet(
        |block| 17 * block,
        &[(0, 0, 5000, 10), (0, 1, 5000, 11), (5, 15, 5000, 13), (11, 31, 5000, 14)],
        1,
        [0x37, 0x21],
    );
    is_transcribed(&hdl32, 0x5d8f_c965);
    let expected = [
        (0, 0, 8.601194, 0.0, -5.083757),
        (0, 1152, 9.86771, 0.0, -1.616445),
        (91, 247680, 9.998739, -0.158818, 0.0),
        (200, 542592, 9.821113, -0.342961, 1.846071),
    ];
    agrees(&returns(Model::Hdl32E, &hdl32), &expected);
    let hires = packet(
        |block| 40 * block,
        &[(0, 0, 5000, 10), (0, 1, 5000, 11), (5, 15, 5000, 13), (11, 31, 5000, 14)],
        1,
        [0x37, 0x24],
    );
    is_transcribed(&hires, 0x4ee9_9655);
    let expected = [
        (0, 0, 9.848078, 0.0, -1.729082),
        (1, 2304, 9.999322, -0.001745, 0.115511),
        (213, 587520, 9.841273, -0.366023, 1.729082),
        (473, 1306368, 9.814539, -0.812076, 1.729082),
    ];
    agrees(&returns(Model::HiRes, &hires), &expected);
}

#[test]
fn t8_position_packet() {
    let mut bytes = std::vec![0; 512];
    bytes[198..202].copy_from_slice(&[0xfb, 0x61, 0xdc, 0xc3]);
    bytes[202] = 2;
    let sentence = b"$GPRMC,225446,A,4916.45,N,12311.12,W,000.5,054.7,191194,020.3,E*68\r\n";
    bytes[206..206 + sentence.len()].copy_from_slice(sentence);
    is_transcribed(&bytes, 0x337f_aba2);
    let position = PositionPacket::new_checked(&bytes).expect("a valid vector");
    let fix = Gprmc::parse(position.sentence()).expect("a valid sentence");
    let place = fix.place.expect("a place");
    assert_eq!((fix.is_valid, fix.seconds_of_day % 3_600), (true, 54 * 60 + 46));
    assert!(
        (place.latitude_deg - 49.274_167).abs() < 1e-6 && (place.longitude_deg + 123.185_333).abs() < 1e-6
    );
    assert_eq!((position.stamp_us(), position.pps()), (3_286_000_123, PpsState::Locked));
    assert_eq!(position.sentence().as_bytes(), &sentence[..sentence.len() - 2]);
}

#[test]
fn damaged_packets_are_refused_whole_and_named() {
    let good = packet(|block| 40 * block, &[], 5, [0x37, 0x22]);
    assert_eq!(Packet::new_checked(&good[..1_205]).err(), Some(PacketError::Length { received: 1_205 }));
    let damaged = |at: usize, value: u8| {
        let mut bytes = good.clone();
        bytes[at] = value;
        Packet::new_checked(&bytes).err()
    };
    assert_eq!(damaged(701, 0xdd), Some(PacketError::BlockFlag { block: 7, found: [0xff, 0xdd] }));
    assert_eq!(damaged(1_204, 0x40), Some(PacketError::ReturnMode { found: 0x40 }));
    assert_eq!(damaged(1_203, 0xff), Some(PacketError::Stamp { micros: 0xff00_0005 }));
}

proptest::proptest! {
    #[test]
    fn any_bytes_give_a_value_or_an_error(bytes in proptest::collection::vec(0u8.., 0..1_300), flags: bool) {
        let mut bytes = bytes;
        if flags {
            bytes.resize(1_206, 0);
            for block in 0..12 {
                bytes[block * 100..block * 100 + 2].copy_from_slice(&[0xff, 0xee]);
                bytes[block * 100 + 3] &= 0x7f;
            }
            bytes[1_204] = 0x37 + bytes[1_204] % 3;
        }
        let mut decoder = Decoder::new(ModelChoice::Auto);
        let _ = decoder.decode(&bytes, Stamp::ZERO);
        let _ = PositionPacket::new_checked(&bytes);
    }
}

/// Early VLP-16 firmware sends a whole turn in place of 0: the packet means the same.
#[test]
fn an_azimuth_of_a_whole_turn_is_zero() {
    let (mut zero, mut whole) = ([0; 1_206], [0; 1_206]);
    for (block, azimuth_cdeg) in (35_800_u16..).step_by(40).take(12).enumerate() {
        let start = 100 * block;
        for (bytes, turn) in [(&mut zero, 0), (&mut whole, 36_000_u16)] {
            bytes[start..start + 2].copy_from_slice(&[0xff, 0xee]);
            let sent = if azimuth_cdeg == 36_000 { turn } else { azimuth_cdeg % 36_000 };
            bytes[start + 2..start + 4].copy_from_slice(&sent.to_le_bytes());
            bytes[start + 4..start + 7].copy_from_slice(&[0x10, 0x27, 9]);
        }
    }
    for bytes in [&mut zero, &mut whole] {
        bytes[1_204..].copy_from_slice(&[0x37, 0x22]);
    }
    let decode = |bytes: &[u8]| {
        let choice = ModelChoice::Fixed(Model::Vlp16);
        Decoder::new(choice).decode(bytes, Stamp::from_micros(1_000_000)).expect("a packet").0
    };
    assert_eq!(decode(&whole), decode(&zero));
}
