//! Datagrams that the maker's own structures and checksum gave (Livox-SDK2 at commit 08f523c), one of each kind of points.

use std::vec::Vec;

use super::{Point, PointPacket};

/// 1,700,000,000.123456789 s; points 5 µs apart.
const TIME_NS: u64 = 1_700_000_000_123_456_789;
/// (2000, −1000, 70), (−3000, 0, −210), nothing.
const FINE: &str = "004e006400030001020001010000000000000000000000007e81e57615cd853dfe9c9717d007000018fcffff46000000090048f4\
                    ffff000000002effffffff100000000000000000000000000000";
/// (2000, −1000, 70), (−3000, 0, −210).
const COARSE: &str = "003400320002000102000201000000000000000000000000183a08af15cd853dfe9c9717c8009cff07000900d4fe0000ebffff10";
/// 2.5 m at zenith 90° and azimuth 45°, 4 m at zenith 86° and azimuth 270°.
const SPHERICAL: &str = "003800320002000102000301000000000000000000000000ebc0f96c15cd853dfe9c9717c4090000282394110900a00f0000\
                         98217869ff10";

pub(super) fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).unwrap()).collect()
}

fn points(hex: &str) -> Vec<Point> {
    let bytes = bytes(hex);
    let packet = PointPacket::new_checked(&bytes).unwrap();
    assert_eq!(packet.time_ns(), TIME_NS);
    assert_eq!(packet.duration_ns(), u64::from(packet.len() - 1) * 5_000);
    packet.points().collect()
}

#[test]
fn makers_points_in_millimetres() {
    let found = points(FINE);
    assert_eq!(found.len(), 3);
    assert_eq!(found[0], Point { at_mm: [2_000.0, -1_000.0, 70.0], reflectivity: 9, tag: 0 });
    assert_eq!(found[1], Point { at_mm: [-3_000.0, 0.0, -210.0], reflectivity: 255, tag: 16 });
    assert_eq!(found[2], Point::default());
}

#[test]
fn makers_points_in_centimetres() {
    let found = points(COARSE);
    assert_eq!(found.len(), 2);
    assert_eq!(found[0], Point { at_mm: [2_000.0, -1_000.0, 70.0], reflectivity: 9, tag: 0 });
    assert_eq!(found[1], Point { at_mm: [-3_000.0, 0.0, -210.0], reflectivity: 255, tag: 16 });
}

#[test]
fn makers_points_by_angles() {
    let found = points(SPHERICAL);
    let near = |one: [f32; 3], two: [f32; 3]| one.iter().zip(two).all(|(one, two)| (one - two).abs() < 0.5);
    assert!(near(found[0].at_mm, [1_767.8, 1_767.8, 0.0]), "{:?}", found[0]);
    assert!(near(found[1].at_mm, [0.0, -3_990.3, 279.0]), "{:?}", found[1]);
    assert_eq!((found[0].reflectivity, found[1].reflectivity, found[1].tag), (9, 255, 16));
}
