//! The frame that the reference encoder (`examples/imu_samples.py --vector`) writes, what is refused, and damage at random.

use std::println;
use std::vec::Vec;

use super::{Device, DeviceEvent, DeviceFault, FrameError, SamplesFrame};
use crate::link::OrderError;
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::ImuSample;
use floorguard_types::time::Stamp;

/// Sender 7, sample 42, 1,000.000123 s, two samples 10 ms apart, the second one saturated.
const VECTOR: &str = "46470106070000002a0000007bca9a3b0000000010270000020000000000003f000080be0000003e0000c03f000020c000001c41000000000000000000000000000080bf00000000000000000000204101000000688be575";

fn vector() -> Vec<u8> {
    (0..VECTOR.len()).step_by(2).map(|at| u8::from_str_radix(&VECTOR[at..at + 2], 16).unwrap()).collect()
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

/// The same with a change, and the checksum made good again.
fn changed(change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = vector();
    bytes.truncate(bytes.len() - 4);
    change(&mut bytes);
    let checksum = crc32(&bytes);
    bytes.extend(checksum.to_le_bytes());
    bytes
}

fn number(sequence: u32) -> Vec<u8> {
    changed(|bytes| bytes[8..12].copy_from_slice(&sequence.to_le_bytes()))
}

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

fn events(device: &mut Device, bytes: &[u8], micros: u64) -> Vec<DeviceEvent> {
    let mut found = Vec::new();
    device.push(bytes, at(micros), |event| found.push(event));
    found
}

#[test]
fn reference_frame_gives_its_samples() {
    let found = events(&mut Device::default(), &vector(), 5_000_000);
    let first = ImuSample {
        stamp: at(4_990_000),
        sequence: 42,
        angular_radps: [0.5, -0.25, 0.125],
        linear_mps2: [1.5, -2.5, 9.75],
        orientation: None,
        suspect: false,
    };
    let second = ImuSample {
        stamp: at(5_000_000),
        sequence: 43,
        angular_radps: [0.0, 0.0, -1.0],
        linear_mps2: [0.0, 0.0, 10.0],
        orientation: None,
        suspect: true,
    };
    assert_eq!(found, [first, second].map(DeviceEvent::Sample));
    let bytes = vector();
    let frame = SamplesFrame::new_checked(&bytes).unwrap();
    assert_eq!((frame.sender(), frame.sequence(), frame.first_sample_us()), (7, 42, 1_000_000_123));
}

/// On a serial line: behind garbage, split at every byte, and one after the other.
#[test]
fn frames_are_found_in_any_portions() {
    let mut device = Device::default();
    let bytes = [&b"FGFFG\x01\x06\x07"[..], &number(1), &number(3), b"FG\x01", &number(5)].concat();
    let mut samples = 0;
    for byte in bytes {
        samples += events(&mut device, &[byte], 5_000_000).len();
    }
    assert_eq!((samples, device.counters().samples, device.counters().lost), (6, 6, 0));
}

#[test]
fn lost_repeated_and_strange_samples_are_found() {
    let mut device = Device::default();
    let mut count = |bytes: &[u8], micros| events(&mut device, bytes, micros).len();
    assert_eq!(count(&number(u32::MAX), 1_000_000), 2);
    assert_eq!(count(&number(1), 1_020_000), 2);
    assert_eq!(count(&number(5), 1_040_000), 2);
    assert_eq!(count(&number(6), 1_050_000), 0, "its first sample was heard already");
    assert_eq!(count(&changed(|bytes| (bytes[4], bytes[8]) = (9, 50)), 1_060_000), 0);
    // After a second of silence a bridge may count from the beginning.
    assert_eq!(count(&number(0), 2_100_000), 2);
    let counters = device.counters();
    assert_eq!((counters.samples, counters.refused, counters.lost), (8, 2, 2));
    assert_eq!(device.fault(), Some(DeviceFault::Order(OrderError::Sender { found: 9, expected: 7 })));
}

#[test]
fn faults_and_impossible_values_are_reported() {
    let fault = changed(|bytes| bytes[28 + 24] = 2);
    let found = events(&mut Device::default(), &fault, 1_000_000);
    assert_eq!(found[0], DeviceEvent::Error(1));
    assert!(matches!(found[1], DeviceEvent::Sample(ImuSample { suspect: true, .. })), "{found:?}");
    for value in [f32::NAN, f32::INFINITY, -101.0] {
        let bytes = changed(|bytes| bytes[28 + 28..28 + 32].copy_from_slice(&value.to_le_bytes()));
        let mut device = Device::default();
        assert_eq!(events(&mut device, &bytes, 1_000_000), [DeviceEvent::Refused]);
        assert_eq!(device.fault(), Some(DeviceFault::Frame(FrameError::Value { sample: 1 })));
    }
}

#[test]
fn damaged_frames_are_refused() {
    let refused = |bytes: &[u8]| SamplesFrame::new_checked(bytes).map(|_| ()).unwrap_err();
    for bit in 0..vector().len() * 8 {
        let mut bytes = vector();
        bytes[bit / 8] ^= 1 << (bit % 8);
        assert!(SamplesFrame::new_checked(&bytes).is_err(), "bit {bit}");
        assert!(events(&mut Device::default(), &bytes, 1_000_000).is_empty(), "bit {bit}");
    }
    assert!(matches!(refused(&[]), FrameError::Start(_)));
    assert!(matches!(refused(&vector()[..40]), FrameError::Length { found: 40, needed: 88 }));
    let field = |at: usize, value: &[u8]| changed(|bytes| bytes[at..at + value.len()].copy_from_slice(value));
    for (place, value) in [
        (4, &0_u32.to_le_bytes()[..]),
        (20, &0_u32.to_le_bytes()),
        (20, &50_001_u32.to_le_bytes()),
        (24, &[0]),
        (24, &[4]),
        (25, &[1]),
        (28 + 24, &[4]),
        (28 + 25, &[1]),
        (28 + 28 + 24, &[8]),
    ] {
        let error = refused(&field(place, value));
        assert!(
            matches!(error, FrameError::Field { offset, .. } if usize::from(offset) == place),
            "{place}: {error}"
        );
    }
}

/// Bits, bytes and lengths of 2,000 frames are damaged, with right ones between: only samples that were sent come out.
#[test]
fn nothing_comes_out_that_was_not_sent() {
    let (mut device, mut random) = (Device::default(), Pcg32::new(26, 2));
    let (mut samples, mut sent) = (0, 0);
    for step in 0..4_000_u32 {
        let turn = (step % 1_000) as f32 * 0.001;
        let mut bytes = changed(|bytes| {
            bytes[8..12].copy_from_slice(&(step * 2).to_le_bytes());
            bytes[12..20].copy_from_slice(&(u64::from(step) * 20_000).to_le_bytes());
            bytes[36..40].copy_from_slice(&turn.to_le_bytes());
            bytes[64..68].copy_from_slice(&turn.to_le_bytes());
        });
        sent += 2;
        if step % 2 == 0 {
            let place = random.below(bytes.len() as u32) as usize;
            match random.below(4) {
                0 => bytes[place] ^= 1 << random.below(8),
                1 => bytes[place] = bytes[place].wrapping_add(1 + random.below(255) as u8),
                2 => bytes.truncate(place),
                _ => bytes.extend((0..=random.below(300)).map(|byte| byte as u8)),
            }
        }
        let now_us = 1_000_000 + u64::from(step) * 20_000;
        for event in events(&mut device, &bytes, now_us) {
            let DeviceEvent::Sample(sample) = event else { panic!("{event:?}") };
            samples += 1;
            assert!(sample.stamp <= at(now_us));
            // Of this frame, or of one before whose bytes were held until a checksum confirmed them.
            let was_sent = (0..3).any(|back| {
                let turn = ((step.saturating_sub(back)) % 1_000) as f32 * 0.001;
                (sample.angular_radps[2] - turn).abs() < 1.0e-6
            });
            assert!(was_sent, "{step}: {sample:?}");
        }
    }
    let counters = device.counters();
    println!("{sent} samples sent, {samples} came out: {counters:?}");
    // Each right frame comes out, also behind a damaged one.
    assert!(samples >= 4_000 && samples < sent, "{samples}");
}
