//! Changes inside messages that stay well-formed: values, clocks, sender marks; checksums are made good again.

use super::bridged_edit::{imu_frame, scan_datagram};
use crate::can::CanFrame;
use crate::wire::{
    BEAM_BYTES, BEAMS_FROM, DATAGRAM_HEADER, IMU_HEAD_BYTES, IMU_START, LINK_CRC_BYTES, SCAN_HEAD_BYTES,
    SCAN_START, reseal_message, reseal_telegram, reseal_vectornav,
};
use crate::wire::{Payload, Stream, WireEvent};

/// Bytes of a lidar block, and of its header.
const BLOCK_BYTES: usize = 100;
/// Where the lidar keeps the microseconds of its hour.
const LIDAR_CLOCK: std::ops::Range<usize> = 1200..1204;
/// Where the scanner keeps its scan number: one in 40 ms.
const SCAN_NUMBER: std::ops::Range<usize> = 14..18;
const SCAN_US: i64 = 40_000;
/// First measured word of a telegram, and the bytes of its checksum.
const WORDS_FROM: usize = 24;
const CRC_BYTES: usize = 2;
const HOUR_US: i64 = 3_600_000_000;

/// What is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edit {
    /// Extreme values; the number chooses which.
    Extreme(u32),
    /// The device's clock, microseconds forward.
    Clock(i64),
    /// The mark of another device.
    Stranger,
    /// No returns from this many degrees in front.
    Blind(f32),
}

/// Changes a whole message.
pub fn apply(edit: Edit, event: &mut WireEvent) {
    match (event.stream, &mut event.payload) {
        (Stream::LidarData, Payload::Bytes(bytes)) if bytes.len() >= LIDAR_CLOCK.end + 2 => {
            lidar(edit, bytes)
        }
        (Stream::ScannerSerial, Payload::Bytes(bytes)) if bytes.len() > WORDS_FROM + CRC_BYTES => {
            scanner(edit, bytes);
            reseal_telegram(bytes);
        }
        (Stream::ScannerData, Payload::Bytes(bytes))
            if bytes.starts_with(SCAN_START) && bytes.len() > SCAN_HEAD_BYTES + LINK_CRC_BYTES =>
        {
            scan_datagram(edit, bytes);
        }
        (Stream::ScannerData, Payload::Bytes(bytes)) if bytes.len() > DATAGRAM_HEADER => {
            scanner_datagram(edit, bytes);
        }
        (Stream::ImuSerial, Payload::Bytes(bytes))
            if bytes.starts_with(IMU_START) && bytes.len() > IMU_HEAD_BYTES + LINK_CRC_BYTES =>
        {
            imu_frame(edit, bytes);
        }
        (Stream::ImuSerial, Payload::Bytes(bytes)) if bytes.starts_with(&[0xFA, 0x05]) => {
            vectornav(edit, bytes);
            reseal_vectornav(bytes);
        }
        (Stream::ImuSerial, Payload::Bytes(bytes)) if bytes.starts_with(&[0xFA, 0xFF]) && bytes.len() > 5 => {
            imu(edit, bytes);
            reseal_message(bytes);
        }
        (Stream::Can, Payload::Frame(frame)) => bus(edit, frame),
        _ => {}
    }
}

fn lidar(edit: Edit, bytes: &mut [u8]) {
    match edit {
        Edit::Extreme(which) => {
            let value = [[0xFF, 0xFF], [0x01, 0x00], [0x00, 0x80]][which as usize % 3];
            for cell in cells(bytes) {
                cell[..2].copy_from_slice(&value);
            }
        }
        Edit::Clock(forward_us) => {
            let clock = &mut bytes[LIDAR_CLOCK];
            let shown = i64::from(u32::from_le_bytes([clock[0], clock[1], clock[2], clock[3]]));
            let shifted = (shown + forward_us).rem_euclid(HOUR_US) as u32;
            clock.copy_from_slice(&shifted.to_le_bytes());
        }
        // Another model of the same maker.
        Edit::Stranger => bytes[LIDAR_CLOCK.end + 1] = 0x21,
        Edit::Blind(degrees) => {
            let half_cdeg = (degrees * 50.0) as u16;
            for block in bytes.chunks_exact_mut(BLOCK_BYTES).take(12) {
                let azimuth = u16::from_le_bytes([block[2], block[3]]);
                if azimuth.min(36_000_u16.saturating_sub(azimuth)) <= half_cdeg {
                    block[4..].fill(0);
                }
            }
        }
    }
}

fn cells(bytes: &mut [u8]) -> impl Iterator<Item = &mut [u8]> {
    bytes.chunks_exact_mut(BLOCK_BYTES).take(12).flat_map(|block| block[4..].chunks_exact_mut(3))
}

fn scanner(edit: Edit, bytes: &mut [u8]) {
    let end = bytes.len() - CRC_BYTES;
    match edit {
        Edit::Extreme(which) => {
            let value = [[0xFF, 0xFF], [0x00, 0x00], [0xFF, 0x1F]][which as usize % 3];
            for word in bytes[WORDS_FROM..end].chunks_exact_mut(2) {
                word.copy_from_slice(&value);
            }
        }
        Edit::Clock(forward_us) => {
            let number = &mut bytes[SCAN_NUMBER];
            let shown = u32::from_le_bytes([number[0], number[1], number[2], number[3]]);
            let shifted = shown.wrapping_add((forward_us / SCAN_US) as u32);
            number.copy_from_slice(&shifted.to_le_bytes());
        }
        // The address of another device on the line.
        Edit::Stranger => bytes[9] = 0x08,
        Edit::Blind(degrees) => {
            // 541 words of half a degree; straight ahead is the middle one. No echo is 0x1FFF.
            let words = (end - WORDS_FROM) / 2;
            let half = (degrees as usize).min(words / 2);
            for word in bytes[WORDS_FROM..end].chunks_exact_mut(2).skip(words / 2 - half).take(2 * half) {
                word.copy_from_slice(&0x1FFF_u16.to_le_bytes());
            }
        }
    }
}

/// A microScan3 has no checksum above that of the network: its datagrams are changed where they stand.
fn scanner_datagram(edit: Edit, bytes: &mut [u8]) {
    let number = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    let (total, offset) = (number(8) as usize, number(16) as usize);
    let beams = total.saturating_sub(BEAMS_FROM) / BEAM_BYTES;
    match edit {
        Edit::Extreme(which) => {
            let value = [[0xFF, 0xFF, 0xFF, 0x01], [0; 4], [0, 0, 0, 0x02]][which as usize % 3];
            change_beams(bytes, offset, 0..beams, value);
        }
        Edit::Clock(forward_us) if offset == 0 && bytes.len() >= DATAGRAM_HEADER + 24 => {
            let shown = number(DATAGRAM_HEADER + 20);
            let shifted = shown.wrapping_add((forward_us / SCAN_US) as u32);
            bytes[DATAGRAM_HEADER + 20..DATAGRAM_HEADER + 24].copy_from_slice(&shifted.to_le_bytes());
        }
        Edit::Clock(_) => {}
        // Another protocol of the same maker.
        Edit::Stranger => bytes[4] = b'X',
        Edit::Blind(degrees) => {
            // Straight ahead is the middle of 275°. "Infinite" is status 2.
            let half = ((degrees / 275.0 * 0.5 * beams as f32) as usize).min(beams / 2);
            change_beams(bytes, offset, beams / 2 - half..beams / 2 + half, [0, 0, 0, 0x02]);
        }
    }
}

/// Writes one value into those beams of a message that lie in this datagram, whose first byte is the `offset`th.
fn change_beams(bytes: &mut [u8], offset: usize, beams: std::ops::Range<usize>, value: [u8; BEAM_BYTES]) {
    let span = BEAMS_FROM + beams.start * BEAM_BYTES..BEAMS_FROM + beams.end * BEAM_BYTES;
    for (at, byte) in (offset..).zip(bytes.iter_mut().skip(DATAGRAM_HEADER)) {
        if span.contains(&at) {
            *byte = value[(at - BEAMS_FROM) % BEAM_BYTES];
        }
    }
}

/// MTData2 (36h) is a list of items: identifier, length, big-endian data (book, Xsens MTi: Data items).
fn imu(edit: Edit, bytes: &mut [u8]) {
    if edit == Edit::Stranger {
        bytes[1] = 0x01;
    }
    if bytes[2] != 0x36 {
        return;
    }
    let (mut at, end) = (4, bytes.len() - 1);
    while at + 3 <= end {
        let id = u16::from_be_bytes([bytes[at], bytes[at + 1]]);
        let length = usize::from(bytes[at + 2]);
        let Some(data) = bytes.get_mut(at + 3..(at + 3 + length).min(end)) else { return };
        match (edit, id & 0xFFF0) {
            (Edit::Extreme(which), 0x4020 | 0x8020 | 0x2010) => {
                let value = [f32::NAN, f32::INFINITY, 3.0e38, -0.0][which as usize % 4];
                for number in data.chunks_exact_mut(4) {
                    number.copy_from_slice(&value.to_be_bytes());
                }
            }
            (Edit::Clock(forward_us), 0x1060) if data.len() == 4 => {
                let shown = u32::from_be_bytes([data[0], data[1], data[2], data[3]]);
                let shifted = shown.wrapping_add((forward_us / 100) as u32);
                data.copy_from_slice(&shifted.to_be_bytes());
            }
            _ => {}
        }
        at += 3 + length;
    }
}

/// A VectorNav's frame of time, rate of turn and acceleration (book, VectorNav: Frames); sentences stay as they are.
fn vectornav(edit: Edit, bytes: &mut [u8]) {
    if bytes.len() != 42 {
        return;
    }
    match edit {
        Edit::Extreme(which) => {
            let value = [f32::NAN, f32::INFINITY, 3.0e38, -0.0][which as usize % 4];
            for number in bytes[14..38].chunks_exact_mut(4) {
                number.copy_from_slice(&value.to_le_bytes());
            }
        }
        Edit::Clock(forward_us) => {
            let shown_ns = bytes[6..14].iter().rev().fold(0_u64, |sum, byte| (sum << 8) | u64::from(*byte));
            let shifted_ns = shown_ns.wrapping_add_signed(1_000 * forward_us);
            bytes[6..14].copy_from_slice(&shifted_ns.to_le_bytes());
        }
        // Other groups than were asked for.
        Edit::Stranger => bytes[1] = 0x01,
        Edit::Blind(_) => {}
    }
}

fn bus(edit: Edit, frame: &mut CanFrame) {
    let length = usize::from(frame.len);
    match edit {
        Edit::Extreme(which) => {
            let value = [0xFF, 0x00, 0x7F, 0x80][which as usize % 4];
            frame.data[..length].fill(value);
        }
        // The neighbour's number: traction and steering, left and right encoder change places.
        Edit::Stranger if frame.id >= 0x080 && frame.id & 0x7F != 0 => {
            let node = frame.id & 0x7F;
            frame.id = (frame.id & !0x7F) | if node % 2 == 1 { node + 1 } else { node - 1 };
        }
        // Process data carry no clock.
        _ => {}
    }
}
