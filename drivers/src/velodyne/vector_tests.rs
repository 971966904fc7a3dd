//! The specification's synthetic packets (wire-formats 1.11), built from their rules.

extern crate std;
use std::vec::Vec;

use floorguard_core::time::Stamp;

use super::*;

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

#[test]
fn t2_single_return_over_the_azimuth_wrap_and_the_hour() {
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
fn t3_dual_return_gives_each_echo_once_and_the_nearer_one_to_the_columns() {
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
    let position = PositionPacket::new_checked(&bytes).expect("a valid vector");
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
    assert_eq!(damaged(1_103, 0xf0), Some(PacketError::Azimuth { block: 11, azimuth_cdeg: 0xf0b8 }));
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
