//! Capsules that a sensor sent, and what two decoders of others make of them.
//!
//! The bytes and the samples are those of the tests of `pyrplidar` 0.1.2 (MIT), recorded from an A-series sensor; `pyrplidar` computes
//! them as the maker's `rplidar_sdk` does. The requests are those of the maker's *Interface protocol and application notes*.

use std::format;
use std::string::String;
use std::vec::Vec;

use super::{
    AnswerKind, CAPSULE_BYTES, Capsule, CapsuleError, Descriptor, Device, DeviceEvent, DeviceFamily,
    NodeError, Sample, decode_node,
};
use floorguard_types::time::Stamp;

/// Three capsules that follow each other.
const RECORDED: [&str; 3] = [
    "ae5adb546a097209ee76096a09dd66096209ce5a095a09cd5e096e09ec7a097e09ee82098a09dd8e099a \
     09dea209ae09eeb209ae09eeb209b609eeba09be09fec609ca09fed209d209efd609de09dfea09f609ee",
    "ae5b8f58f609060afe1e0a260aff2e0a320aff320a360aff3a0a420aee4e0a560aef5e0a6a0aff7a0a83 \
     0a0f930a9e0af09e0aa20affa70aa60af09e0a9a0aff970a960af09b0aa30a00af0ab70a00c20acf0a0f",
    "af584302d70adf0a00f20af70a0fe30ae60af0e60af30a0f02008a0aff660a670a0f660a620aff620a02 \
     00ffea09260aff00000000000300ef0a00f30af70a01ff0a070b01170b2b0b00470b670b10830bbb0b21",
];
/// Angles in 16,384ths of a right angle and millimetres of the samples of the first two.
const SAMPLES: [(u32, u16); 64] = [
    (60743, 602),
    (60825, 604),
    (60933, 605),
    (61016, 602),
    (61078, 601),
    (61209, 600),
    (61269, 598),
    (61377, 598),
    (61462, 599),
    (61499, 603),
    (61585, 606),
    (61667, 607),
    (61775, 608),
    (61860, 610),
    (61920, 611),
    (62028, 614),
    (62091, 616),
    (62173, 619),
    (62259, 620),
    (62341, 619),
    (62427, 620),
    (62512, 621),
    (62594, 622),
    (62657, 623),
    (62765, 625),
    (62825, 626),
    (62910, 628),
    (63015, 628),
    (63078, 629),
    (63209, 631),
    (63268, 634),
    (63354, 637),
    (63439, 637),
    (63499, 641),
    (63584, 647),
    (63667, 649),
    (63752, 651),
    (63837, 652),
    (63920, 652),
    (64005, 653),
    (64113, 654),
    (64196, 656),
    (64258, 659),
    (64364, 661),
    (64426, 663),
    (64512, 666),
    (64594, 670),
    (64657, 672),
    (64742, 676),
    (64847, 679),
    (64932, 679),
    (65015, 680),
    (65078, 681),
    (65186, 681),
    (65268, 679),
    (65353, 678),
    (65416, 677),
    (65521, 677),
    (48, 678),
    (130, 680),
    (216, 683),
    (301, 685),
    (406, 688),
    (469, 691),
];

fn bytes_of(hexadecimal: &str) -> Vec<u8> {
    let digits: String = hexadecimal.split_whitespace().collect();
    (0..digits.len()).step_by(2).map(|at| u8::from_str_radix(&digits[at..at + 2], 16).unwrap()).collect()
}

fn recorded(index: usize) -> [u8; CAPSULE_BYTES] {
    bytes_of(RECORDED[index]).try_into().unwrap()
}

#[test]
fn recorded_capsules_give_the_same_samples() {
    let capsules =
        [0, 1, 2].map(|index| Capsule::new_checked(AnswerKind::Capsule, &recorded(index)).unwrap());
    let samples: Vec<Sample> =
        capsules.windows(2).flat_map(|pair| pair[0].samples(&pair[1]).collect::<Vec<_>>()).collect();
    assert_eq!(samples.len(), SAMPLES.len());
    for (sample, (angle_q14, range_mm)) in samples.iter().zip(SAMPLES) {
        assert_eq!(((u32::from(sample.angle_q6) << 8) / 90, sample.range_mm), (angle_q14, range_mm));
    }
}

/// Forty distances of two bytes, in even steps; between 350° and 10° the angle passes 0.
#[test]
fn dense_capsules_pass_the_front() {
    let capsule = |angle_q6: u16| {
        let mut bytes = [0; CAPSULE_BYTES];
        bytes[2..4].copy_from_slice(&angle_q6.to_le_bytes());
        for (index, cell) in bytes[4..].chunks_exact_mut(2).enumerate() {
            cell.copy_from_slice(&(30_000 + index as u16).to_le_bytes());
        }
        let check = bytes[2..].iter().fold(0, |check, byte| check ^ byte);
        (bytes[0], bytes[1]) = (0xA0 | (check & 0x0F), 0x50 | (check >> 4));
        Capsule::new_checked(AnswerKind::DenseCapsule, &bytes).unwrap()
    };
    let samples: Vec<Sample> = capsule(350 * 64).samples(&capsule(10 * 64)).collect();
    let expected = (0..40)
        .map(|index| Sample { angle_q6: (350 * 64 + index * 32) % (360 * 64), range_mm: 30_000 + index });
    assert_eq!(samples, expected.collect::<Vec<_>>());
    assert_eq!(capsule(0).samples(&capsule(61 * 64)).count(), 0, "capsules between them are lost");
}

/// Quality 15 at 90° and 1 m, and each check bit wrong.
#[test]
fn nodes_are_checked() {
    let sample = Sample { angle_q6: 90 * 64, range_mm: 1_000 };
    assert_eq!(decode_node(&[0x3D, 0x01, 0x2D, 0xA0, 0x0F]), Ok(sample));
    assert_eq!(decode_node(&[0x3E, 0x01, 0x2D, 0xA0, 0x0F]), Ok(sample));
    for bytes in [[0x3F, 0x01, 0x2D, 0, 0], [0x3C, 0x01, 0x2D, 0, 0], [0x3D, 0x00, 0x2D, 0, 0]] {
        assert_eq!(decode_node(&bytes), Err(NodeError::CheckBits));
    }
    assert_eq!(decode_node(&[0x3D, 0x01, 0xB4, 0, 0]), Err(NodeError::Angle(360 * 64)));
}

#[test]
fn every_flipped_bit_of_a_capsule_is_refused() {
    for bit in 0..CAPSULE_BYTES * 8 {
        let mut bytes = recorded(1);
        bytes[bit / 8] ^= 1 << (bit % 8);
        let found = Capsule::new_checked(AnswerKind::Capsule, &bytes);
        assert!(matches!(found, Err(CapsuleError::Start | CapsuleError::Checksum { .. })), "bit {bit}");
    }
}

#[test]
fn descriptors_say_what_follows() {
    let decoded = |text: &str| Descriptor::decode(&bytes_of(text).try_into().unwrap());
    assert_eq!(decoded("a55a0300000006"), Some(Descriptor::HEALTH));
    let kinds = ["a55a0500004081", "a55a5400004082", "a55a5400004085", "a55a8400004084"]
        .map(|text| decoded(text).and_then(Descriptor::samples));
    assert_eq!(
        kinds,
        [Some(AnswerKind::Node), Some(AnswerKind::Capsule), Some(AnswerKind::DenseCapsule), None]
    );
    assert_eq!(decoded("a55b0500004081"), None);
}

fn pushed(device: &mut Device, bytes: &[u8], now_us: u64) -> Vec<DeviceEvent> {
    let mut events = Vec::new();
    device.push(bytes, Stamp::from_micros(now_us), &mut |event| events.push(event));
    events
}

fn samples_in(events: &[DeviceEvent]) -> usize {
    events.iter().filter(|event| matches!(event, DeviceEvent::Sample(_))).count()
}

/// Asked step by step; of what comes byte by byte, with noise before it and a byte lost within, what is whole is used.
#[test]
fn sensors_are_asked_and_found_again() {
    let mut device = Device::new(DeviceFamily::A);
    let mut sent = Vec::new();
    for tick in 0..10 {
        device
            .poll(Stamp::from_micros(1_000_000 + tick * 20_000), &mut |bytes| sent.extend_from_slice(bytes));
    }
    let sent: String = sent.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(sent, "a525a552a5f0029402c1a58205010000000023");
    let stream = [
        bytes_of("00a5 a55a0300000006 000000 a55a5400004082").as_slice(),
        &recorded(0),
        &recorded(1),
        &recorded(2)[..40],
        &recorded(2)[41..],
        &recorded(0),
        &recorded(1),
        &recorded(2),
    ]
    .concat();
    let events: Vec<DeviceEvent> =
        stream.iter().flat_map(|byte| pushed(&mut device, &[*byte], 1_300_000)).collect();
    assert!(events.contains(&DeviceEvent::Refused));
    assert_eq!(samples_in(&events), 32 + 64, "nothing is made of the damaged capsule");
}

#[test]
fn trouble_and_other_answers_are_reported() {
    let mut device = Device::new(DeviceFamily::S);
    assert_eq!(pushed(&mut device, &bytes_of("a55a0300000006 023412"), 1), [DeviceEvent::Fault(0x1234)]);
    assert_eq!(pushed(&mut device, &bytes_of("a55a0300000006 010000"), 2), []);
    assert_eq!(pushed(&mut device, &bytes_of("a55a8400004084"), 3), [DeviceEvent::Unsuitable(0x84)]);
}

/// A sensor that never answers is asked in the other way; one that was heard is asked again as it was.
#[test]
fn silent_sensors_are_asked_anew() {
    let mut device = Device::new(DeviceFamily::S);
    let (mut sent, mut silences) = (Vec::new(), 0);
    let mut poll = |device: &mut Device, tick: u64| {
        let mut now = Vec::new();
        silences += u32::from(
            device.poll(Stamp::from_micros(tick * 20_000), &mut |bytes| now.extend_from_slice(bytes)),
        );
        if now.first() == Some(&0xA5) && now.get(1) == Some(&0x82) {
            sent.push((tick, now[3]));
        }
    };
    (1..300).for_each(|tick| poll(&mut device, tick));
    pushed(&mut device, &bytes_of("a55a0500004081 3d012da00f"), 300 * 20_000);
    (301..400).for_each(|tick| poll(&mut device, tick));
    assert_eq!(sent.iter().map(|(_, mode)| *mode).collect::<Vec<_>>(), [1, 0, 0]);
    assert_eq!((sent[0].0, silences), (4, 1));
}
