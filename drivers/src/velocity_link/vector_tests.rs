//! The frames of the book, Velocity link: Test vectors, made by an encoder in Python that shares nothing with this one.

extern crate std;
use core::fmt::Write as _;
use std::string::String;
use std::vec::Vec;

use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::DriveState;
use floorguard_types::time::Stamp;

use super::*;

const REQUEST: &str = "46470101070000000100000088130000960000000000003f000080be3a601443";
const TO_STAND: &str = "46470101efbeaddefffffffff0ffffffe803000000000000000000005efebb98";
const TORQUE_OFF: &str = "46470101010000000200000003000000140003000000000000000000342f595c";
const NO_NUMBER: &str = "464701010700000002000000ba130000960000000000c07f000000004d0d44c4";
const MOTION: &str = "46470103090000000c00000004000200000000003333f33e000000be623773cc";
const FAULT: &str = "46470103090000000d00000000000400118600000000000000000000d04d09be";
const PERMIT: &str = "4647010207000000fa00000001000000351cdcdf0200000000000000000000000000003f000080be0000803d000000bd \
    00000000030204090012000000000000cdcc4c3f9a99993f015200000100000002000000030000000400000005000000 \
    06000000070000006f62737461636c6520696e207468652070726f74656374697665206669656c642028736166657479 \
    207363616e6e6572293a20302e3830206d2c206c696d697420312e3230206d2c203435206d73206f6c64000000000000 \
    00000000000000000000000000000000000000000000000000000000000000000000000000000000c6bfa56a";

fn bytes(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text.bytes().filter(u8::is_ascii_hexdigit).collect();
    let pair = |pair: &[u8]| u8::from_str_radix(core::str::from_utf8(pair).unwrap(), 16).unwrap();
    digits.chunks(2).map(pair).collect()
}

const fn twist(linear_mps: f32, angular_radps: f32) -> Twist2 {
    Twist2 { linear_mps, angular_radps }
}

fn permit() -> Permit {
    let reason = "obstacle in the protective field (safety scanner): 0.80 m, limit 1.20 m, 45 ms old";
    Permit {
        sender: 7,
        sequence: 250,
        acknowledged: 1,
        stamp: Stamp::from_micros(12_345_678_901),
        permitted: Twist2::ZERO,
        requested: twist(0.5, -0.25),
        measured: twist(0.0625, -0.03125),
        speed_limit_mps: 0.0,
        state: 3,
        action: 2,
        flags: PermitFlags { is_held: true, ..PermitFlags::default() },
        cause: 9,
        causes: 1 << 9 | 1 << 12,
        value: 0.8,
        limit: 1.2,
        unit: 1,
        counters: LinkCounters {
            accepted: 1,
            damaged: 2,
            non_finite: 3,
            late: 4,
            out_of_order: 5,
            repeated: 6,
            other_sender: 7,
        },
        reason: {
            let mut text = Reason::EMPTY;
            text.write_str(reason).unwrap();
            text
        },
    }
}

#[test]
fn requests_match_the_reference_encoder() {
    let stop = StopDemand::None;
    let request = VelocityRequest {
        sender: 7,
        sequence: 1,
        sent_ms: 5_000,
        deadline_ms: 150,
        stop,
        twist: twist(0.5, -0.25),
    };
    let stand = VelocityRequest {
        sender: 0xDEAD_BEEF,
        sequence: u32::MAX,
        sent_ms: 0xFFFF_FFF0,
        deadline_ms: 1_000,
        stop,
        twist: Twist2::ZERO,
    };
    let off = VelocityRequest {
        sender: 1,
        sequence: 2,
        sent_ms: 3,
        deadline_ms: 20,
        stop: StopDemand::TorqueOff,
        twist: Twist2::ZERO,
    };
    for (text, value) in [(REQUEST, request), (TO_STAND, stand), (TORQUE_OFF, off)] {
        assert_eq!(value.encode().to_vec(), bytes(text));
        assert_eq!(VelocityRequest::decode(&bytes(text)), Ok(value));
    }
    assert_eq!(VelocityRequest::decode(&bytes(NO_NUMBER)), Err(FrameError::NonFinite));
}

#[test]
fn motion_reports_match_the_reference_encoder() {
    let moves = MotionReport {
        sender: 9,
        sequence: 12,
        age_ms: 4,
        state: DriveState::Enabled,
        twist: twist(0.475, -0.125),
    };
    let fault = MotionReport {
        sequence: 13,
        age_ms: 0,
        state: DriveState::Fault(0x8611),
        twist: Twist2::ZERO,
        ..moves
    };
    for (text, value) in [(MOTION, moves), (FAULT, fault)] {
        assert_eq!(value.encode().to_vec(), bytes(text));
        assert_eq!(MotionReport::decode(&bytes(text)), Ok(value));
    }
}

#[test]
fn permits_match_the_reference_encoder() {
    assert_eq!(permit().encode().to_vec(), bytes(PERMIT));
    assert_eq!(Permit::decode(&bytes(PERMIT)), Ok(permit()));
}

/// Each single bit flipped, each shorter and longer frame: refused.
#[test]
fn no_damaged_frame_is_accepted() {
    for text in [REQUEST, MOTION, PERMIT] {
        let whole = bytes(text);
        let is_read = |bytes: &[u8]| {
            VelocityRequest::decode(bytes).is_ok()
                || MotionReport::decode(bytes).is_ok()
                || Permit::decode(bytes).is_ok()
        };
        assert!(is_read(&whole));
        for bit in 0..whole.len() * 8 {
            let mut damaged = whole.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(!is_read(&damaged), "bit {bit}");
        }
        assert!((0..whole.len()).all(|length| !is_read(&whole[..length])));
        assert!(!is_read(&[whole.as_slice(), &[0]].concat()));
    }
}

/// However the line is damaged before: every whole frame behind it is found.
#[test]
fn line_finds_frames_behind_noise() {
    let (request, permit) = (bytes(REQUEST), bytes(PERMIT));
    let cut = &permit[..40];
    let line = [b"FG\x01".as_slice(), &request, cut, &request, &permit, b"FFG", &request].concat();
    let mut receiver = LineReceiver::new();
    let mut found = Vec::new();
    // A cut permit swallows what follows until its length is full: the bytes behind the last frame are part of the test.
    for byte in line.iter().chain(&[0; 8]) {
        if let Some(frame) = receiver.byte(*byte) {
            found.push(frame.to_vec());
        }
    }
    assert_eq!(found, [request.clone(), request.clone(), permit, request]);
    assert!(receiver.discarded() >= 46, "{}", receiver.discarded());
}

#[test]
fn refusals_name_what_is_wrong() {
    let reasons: Vec<String> = [
        FrameError::Length { found: 31, needed: 32 },
        FrameError::Start(*b"FG\x02\x01"),
        FrameError::Checksum { found: 1, computed: 2 },
        FrameError::NonFinite,
        FrameError::Field { offset: 16, found: 5 },
    ]
    .iter()
    .map(std::string::ToString::to_string)
    .collect();
    for (reason, word) in
        reasons.iter().zip(["31 bytes", "46, 47, 02, 01", "00000002", "not a number", "byte 16"])
    {
        assert!(reason.contains(word), "{reason}");
    }
}
