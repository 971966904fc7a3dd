//! Packets that the maker's own library (`ouster-sdk` 1.0.1 for Python) wrote, and the points that it computes for them.
//!
//! The packets are too long to stand here: they are built from the rule by which that library's were filled, and confirmed by their
//! checksums.

use std::vec::Vec;

use super::{Beams, DataFormat, Decoder, Packet};
use floorguard_types::sensing::LidarPacket;
use floorguard_types::time::Stamp;

const COLUMNS: u16 = 512;
const FRAME: u16 = 77;

fn beams(format: DataFormat) -> Beams {
    let mut beams = Beams::even(16, (15_000, -15_000));
    (beams.format, beams.columns_per_turn, beams.beam_origin_um) = (format, COLUMNS, 15_806);
    for (channel, azimuth) in beams.azimuth_mdeg.iter_mut().enumerate() {
        *azimuth = [3_164, 1_055, -1_055, -3_164][channel % 4];
    }
    beams
}

/// Millimetres; beam 3 sees nothing.
fn range_mm(channel: usize, column: usize) -> u32 {
    if channel == 3 { 0 } else { (1_000 + (37 * channel as u32 + 11 * column as u32) % 5_000) * 8 }
}

fn reflectivity(channel: usize, column: usize) -> u8 {
    ((7 * channel + column) % 251) as u8
}

/// The second echo: half of the first in even columns, twice in odd ones.
fn second_mm(channel: usize, column: usize) -> u32 {
    let first = range_mm(channel, column);
    if column.is_multiple_of(2) { first / 16 * 8 } else { first * 2 }
}

fn pixel(format: DataFormat, channel: usize, column: usize) -> Vec<u8> {
    let (range, bright) = (range_mm(channel, column), reflectivity(channel, column));
    let mut bytes = std::vec![0; format.pixel_bytes()];
    match format {
        DataFormat::Legacy | DataFormat::Single => {
            bytes[..4].copy_from_slice(&range.to_le_bytes());
            bytes[4] = bright;
        }
        DataFormat::Dual => {
            bytes[..4].copy_from_slice(&range.to_le_bytes());
            bytes[3] = bright;
            bytes[4..8].copy_from_slice(&second_mm(channel, column).to_le_bytes());
            bytes[7] = 251;
        }
        DataFormat::LowRate => {
            bytes[..2].copy_from_slice(&((range / 8) as u16).to_le_bytes());
            bytes[2] = bright;
        }
    }
    bytes
}

/// Without the last eight bytes, which are a checksum in all formats but the old one.
fn packet(format: DataFormat, first: usize) -> Vec<u8> {
    let is_old = format == DataFormat::Legacy;
    let mut bytes = Vec::new();
    if !is_old {
        bytes.extend([1, 0, FRAME as u8, 0]);
        bytes.resize(32, 0);
    }
    for column in first..first + 16 {
        bytes.extend((1_000_000_000 + column as u64 * 195_312).to_le_bytes());
        bytes.extend((column as u16).to_le_bytes());
        if is_old {
            // That library numbers the first column alone, and leaves the encoder at 0.
            bytes.extend(if column == first { FRAME.to_le_bytes() } else { [0; 2] });
            bytes.extend([0; 4]);
        } else {
            bytes.extend([1, 0]);
        }
        bytes.extend((0..16).flat_map(|channel| pixel(format, channel, column)));
        bytes.extend(if is_old { &[0xFF; 4][..] } else { &[] });
    }
    bytes.resize(bytes.len() + if is_old { 0 } else { 24 }, 0);
    bytes
}

/// zlib CRC-32.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 },
        )
    })
}

/// Columns 16 to 47 of a turn, decoded from two packets.
fn decoded(format: DataFormat) -> Vec<LidarPacket> {
    let mut decoder = Decoder::new(&beams(format));
    let decode = |first: usize| {
        let mut bytes = packet(format, first);
        bytes.resize(Packet::length(&beams(format)), 0);
        decoder.decode(&bytes, Stamp::from_micros(5_000_000 + first as u64 * 195)).unwrap().0
    };
    [16, 32].map(decode).to_vec()
}

#[test]
fn packets_are_those_of_the_makers_library() {
    let checksums = [
        (DataFormat::Legacy, 0x99F6_65B3),
        (DataFormat::Single, 0x5A9B_3C8E),
        (DataFormat::Dual, 0x258E_224E),
        (DataFormat::LowRate, 0x4F49_582A),
    ];
    for (format, checksum) in checksums {
        let bytes = [packet(format, 16), packet(format, 32)].concat();
        assert_eq!(crc32(&bytes), checksum, "{format:?}");
    }
}

/// Beam, column, and the point of the library in metres: x to the front, y to the left, z up from the base, which is 36.18 mm below.
const POINTS: [(usize, usize, [f64; 3], [f64; 3]); 5] = [
    (0, 16, [-8.8021, 2.2614, 2.4671], [-4.4014, 1.1303, 1.2496]),
    (1, 20, [-9.4596, 2.5552, 2.2947], [-4.7263, 1.2765, 1.1628]),
    (2, 33, [-10.4523, 4.2548, 2.2267], [-10.4523, 4.2548, 2.2267]),
    (15, 40, [-13.9763, 6.5067, -4.0905], [-6.9847, 3.2522, -2.0241]),
    (14, 44, [-13.5309, 7.7755, -3.5631], [-6.7656, 3.8880, -1.7617]),
];

#[test]
fn points_are_those_of_the_makers_library() {
    for format in [DataFormat::Legacy, DataFormat::Single, DataFormat::Dual, DataFormat::LowRate] {
        let (packets, beams) = (decoded(format), beams(format));
        for (channel, column, strongest, nearest) in POINTS {
            let [x, y, z] = if format == DataFormat::Dual { nearest } else { strongest };
            let shift = beams.shift(channel);
            let azimuth_cdeg = (column as i32 + shift) * 36_000 / 512 + 18_000;
            let mut columns = packets.iter().flat_map(|packet| &packet.columns);
            let found = columns.find(|found| i32::from(found.azimuth_cdeg) == azimuth_cdeg);
            let found = found.unwrap_or_else(|| panic!("{format:?}: no column at {azimuth_cdeg} cdeg"));
            // Beam 0 is the uppermost ring.
            let range_m = f64::from(found.range_raw[15 - channel]) * 0.004;
            let elevation = f64::from(beams.elevation_deg(channel as u8)).to_radians();
            let plane_m = range_m * elevation.cos();
            assert!((plane_m - x.hypot(y)).abs() < 0.005, "{format:?} {channel}: {plane_m} m");
            let height_m = range_m * elevation.sin() + f64::from(beams.height_m(channel as u8));
            assert!((height_m - (z - 0.036_18)).abs() < 0.005, "{format:?} {channel}: {height_m} m");
            // What is left of the beam's azimuth beside whole columns.
            let rest_deg = f64::from(beams.azimuth_mdeg[channel]) * 1.0e-3 - f64::from(shift) * 360.0 / 512.0;
            let turned_deg = (-y).atan2(x).to_degrees().rem_euclid(360.0);
            let error_deg = turned_deg - f64::from(azimuth_cdeg) * 0.01 - rest_deg;
            // The beam leaves 15.8 mm beside the axis.
            assert!(error_deg.abs() < 0.025 && rest_deg.abs() <= 0.352, "{format:?} {channel}: {error_deg}°");
        }
    }
}
