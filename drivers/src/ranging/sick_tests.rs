//! The printed example of the telegram, and what is lost or damaged.

use std::format;
use std::string::String;
use std::vec::Vec;

use super::{Cola, RangingEvent, RangingScanner, TIM5XX};
use crate::cola::{ScanTelegram, TelegramError};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

/// From the telegram listing of the maker (Ranging sensors, LMDscandata): fifteen distances from −5° in steps of 0.5°.
const EXAMPLE: &str = "sSN LMDscandata 1 1 89A27F 0 0 343 347 27477BA9 2747813B 0 0 7 0 0 5DC A2 0 1 DIST1 3F800000 00000000 \
                       FFFF3CB0 1388 F 8A1 8A5 8AB 8AC 8A6 8AC 8B6 8C8 8C2 8C9 8CB 8C4 8E4 8E1 8EB 0 0 0 0 0 0";

fn pushed(scanner: &mut Cola, bytes: &[u8], now_us: u64) -> (Vec<Scan>, Vec<String>) {
    let (mut scans, mut others) = (Vec::new(), Vec::new());
    scanner.push(bytes, Stamp::from_micros(now_us), &mut |event| match event {
        RangingEvent::Scan(scan) => scans.push(scan.clone()),
        other => others.push(format!("{other:?}")),
    });
    (scans, others)
}

fn framed(text: &str) -> Vec<u8> {
    format!("\x02{text}\x03").into_bytes()
}

#[test]
fn printed_example_is_understood() {
    let telegram = ScanTelegram::new_checked(EXAMPLE.as_bytes()).unwrap();
    assert_eq!((telegram.status, telegram.scan, telegram.begun_us), (0, 0x347, 0x2747_7BA9));
    assert_eq!(
        (telegram.first_angle, telegram.step, telegram.count, telegram.unit_mm),
        (-50_000, 5_000, 15, 1)
    );
    let distances: Vec<u32> = telegram.distances().collect();
    assert_eq!((distances.len(), distances[0], distances[14]), (15, 0x8A1, 0x8EB));
}

#[test]
fn scans_come_with_the_angles_of_the_robot() {
    let mut scanner = Cola::new(TIM5XX);
    let (scans, others) = pushed(&mut scanner, &framed(EXAMPLE), 5_000_000);
    assert!(others.is_empty(), "{others:?}");
    let [scan] = &scans[..] else { panic!("one scan") };
    // -5° of the sensor lies 95° to the right of ahead.
    assert!((scan.first_angle_rad + 95.0_f32.to_radians()).abs() < 1.0e-5);
    assert!((scan.step_rad - 0.5_f32.to_radians()).abs() < 1.0e-7);
    assert_eq!((scan.beams.len(), scan.beams[0], scan.sequence), (15, BeamReturn::Hit(0x8A1), 0x347));
    assert_eq!(scan.stamp, Stamp::from_micros(4_940_000));
}

#[test]
fn what_is_out_of_range_is_unknown() {
    let text = EXAMPLE.replace("8A1 8A5 8AB", "0 31 61A9");
    let (scans, _) = pushed(&mut Cola::new(TIM5XX), &framed(&text), 5_000_000);
    assert_eq!(scans[0].beams[..3], [BeamReturn::Unknown; 3]);
    assert_eq!(scans[0].beams[3], BeamReturn::Hit(0x8AC));
}

#[test]
fn damaged_telegrams_are_refused_next_is_read() {
    let mut scanner = Cola::new(TIM5XX);
    for (text, error) in [
        (EXAMPLE.replace(" 8A1 ", " 8G1 "), TelegramError::Values { found: 0, announced: 15 }),
        (EXAMPLE.replace(" F 8A1", " 1F 8A1"), TelegramError::Values { found: 21, announced: 31 }),
        (EXAMPLE.replace("DIST1", "RSSI1"), TelegramError::Channel),
        (EXAMPLE.replace("3F800000", "3F800001"), TelegramError::Channel),
        (EXAMPLE.replace("A2 0 1", "A2 9 1"), TelegramError::Form),
        (String::from(&EXAMPLE[..60]), TelegramError::Field(14)),
    ] {
        let found = ScanTelegram::new_checked(text.as_bytes()).map(|_| ()).unwrap_err();
        assert_eq!(found, error, "{text}");
        let (scans, others) = pushed(&mut scanner, &framed(&text), 5_000_000);
        assert!(scans.is_empty() && others == ["Refused"], "{others:?}");
    }
    // Cut in the middle, and split at every byte.
    let cut = [&framed(EXAMPLE)[..80], &framed(EXAMPLE)].concat();
    assert_eq!(pushed(&mut scanner, &cut, 6_000_000).0.len(), 1);
    let bytes = framed(EXAMPLE);
    let scans: usize = bytes.iter().map(|byte| pushed(&mut scanner, &[*byte], 6_100_000).0.len()).sum();
    assert_eq!(scans, 1);
    let long = [&b"\x02"[..], &[b'0'; 20_000], b"\x03", &framed(EXAMPLE)].concat();
    let (scans, others) = pushed(&mut scanner, &long, 6_200_000);
    assert_eq!((scans.len(), others.len()), (1, 1));
}

#[test]
fn trouble_and_refusal_are_reported() {
    let mut scanner = Cola::new(TIM5XX);
    let (scans, others) =
        pushed(&mut scanner, &framed(&EXAMPLE.replace("89A27F 0 0", "89A27F 0 1")), 5_000_000);
    assert!(scans.is_empty() && others == ["Fault(1)"], "{others:?}");
    let (_, others) = pushed(&mut scanner, &framed(&EXAMPLE.replace("89A27F 0 0", "89A27F 0 4")), 5_000_000);
    assert_eq!(others, ["Fault(4)"]);
    assert_eq!(pushed(&mut scanner, &framed("sFA 8"), 5_000_000).1, ["Unsuitable"]);
    assert!(pushed(&mut scanner, &framed("sEA LMDscandata 1"), 5_000_000).1.is_empty());
}

#[test]
fn silent_sensors_are_asked_again() {
    let mut scanner = Cola::new(TIM5XX);
    let mut asked = Vec::new();
    let mut events = 0;
    for step in 0..40_u64 {
        let now = Stamp::from_micros(1_000_000 + step * 100_000);
        let mut send = |_: &[u8]| asked.push(step);
        scanner.poll(now, &mut send, &mut |_| events += 1);
        if (5..15).contains(&step) {
            scanner.push(&framed(EXAMPLE), now, &mut |_| {});
        }
    }
    assert_eq!((asked, events), ([0, 24, 34].to_vec(), 1));
}
