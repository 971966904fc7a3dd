//! The telegrams of the book, SICK S300: Test telegrams, as the manufacturer printed them or built from their rules.

extern crate std;
use std::vec::Vec;

use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;

use super::*;

fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text.bytes().filter(u8::is_ascii_hexdigit).collect();
    digits
        .chunks(2)
        .map(|pair| u8::from_str_radix(core::str::from_utf8(pair).expect("ascii"), 16).expect("hexadecimal"))
        .collect()
}

/// Head, words, and the two bytes of the checksum that belong to them.
fn telegram(head: &str, words: impl Iterator<Item = u16>, tail: &str) -> Vec<u8> {
    let mut bytes = hex(head);
    bytes.extend(words.flat_map(u16::to_le_bytes));
    bytes.extend(hex(tail));
    bytes
}

const S1: &str = "00000000 0000 0228 FF07 0201 0000 78563412 BC9A BBBB 1111";
const S2: &str = "00000000 0000 0226 FF07 0301 0000 00010000 0700 BBBB 1111";
const S3: &str = "00000000 0000 0223 FF07 0301 0000 00010000 0700 BBBB 1111";
const S4: &str = "00000000 0000 0226 FF07 0301 0000 05000000 0500 BBBB 1111";
const S5: &str = "00000000 0000 0228 FF08 0201 0000 2A000000 2B00 BBBB 1111";

fn s1() -> Vec<u8> {
    telegram(S1, 0..541, "3D43")
}

fn configured(values: &[u16]) -> Configuration {
    Configuration {
        values_per_field: heapless::Vec::from_slice(values).expect("few fields"),
        bit13: Bit13::Reflector,
        ..Configuration::default()
    }
}

/// An event that outlives the receiver.
#[derive(Clone, Debug, PartialEq)]
enum Reported {
    Scan(floorguard_types::sensing::Scan),
    StandBy(u32),
    Refused(TelegramError),
}

fn reported(event: Event<'_>) -> Reported {
    match event {
        Event::Scan(scan) => Reported::Scan(scan.clone()),
        Event::StandBy { sequence } => Reported::StandBy(sequence),
        Event::Refused(error) => Reported::Refused(error),
    }
}

fn receive(configuration: Configuration, bytes: &[u8]) -> (Vec<Reported>, Counters) {
    let mut events = Vec::new();
    let mut receiver = Receiver::new(configuration);
    receiver.push(bytes, Stamp::from_micros(1_000_000), |event| events.push(reported(event)));
    (events, receiver.counters())
}

fn only_scan(events: &[Reported]) -> &floorguard_types::sensing::Scan {
    match events {
        [Reported::Scan(scan)] => scan,
        other => panic!("not one scan: {other:?}"),
    }
}

#[test]
fn t1_to_t3_four_fields_of_the_manufacturer() {
    let body = "1111 E823E823E823E803E803E823E823E803 2222 E803E803E803E803E803E803E803E803 \
                3333 E803E803E803E803E803E803E803E803 4444 E803E803E803E803E823";
    for (scan, telegram_number, sum) in [("17", "00", "9CF4"), ("18", "01", "DB8E"), ("19", "02", "3DE1")] {
        let head = std::format!("00000000 0000 002B FF07 0301 0000 {scan}010000 {telegram_number}00 BBBB");
        let bytes = hex(&std::format!("{head} {body} {sum}"));
        assert_eq!(bytes.len(), 90);
        let (events, _) = receive(configured(&[8, 8, 8, 5]), &bytes);
        let scan = only_scan(&events);
        assert_eq!(scan.beams.len(), 29);
        assert!(scan.beams.iter().all(|beam| *beam == BeamReturn::Hit(10_000)));
    }
}

#[test]
fn t4_the_checksum_of_a_fetch_reply() {
    let mut bytes = hex("\
         00 00 00 00 0B 00 00 56 FF 07 08 38 FD FD 00 02 00 55 00 00 00 00 00 08 7D 00 C0 \
         02 00 00 35 01 00 00 52 00 61 04 00 00 9F 02 39 02 18 02 6A 00 0C 00 02 00 32 02 \
         1B 00 1A 00 0A 00 49 02 02 00 28 00 14 00 23 02 01 00 04 00 0F 00 00 02 20 00 06 \
         00 04 00 2A 02 1F 00 21 00 05 00 31 02 09 00 17 00 10 00 02 00 19 00 94 00 00 00 \
         00 00 00 00 0A 00 0E 49 87 47 F6 4A 18 44 65 4E A7 00 9C 14 31 02 64 00 5A 00 A5 \
         02 DE 02 07 01 69 01 6D 02 E8 02 A3 13 C3 00 F1 00 07 01 53 01 A6 01 34 02 03 03 \
         3D 04 54 06 05 0A 98 00 C7 08 AC 08 2D 2C");
    assert_eq!(bytes.len(), 176);
    assert!(Telegram::new_checked(&bytes).is_some());
    bytes[100] ^= 1;
    assert!(Telegram::new_checked(&bytes).is_none());
}

#[test]
fn s1_to_s3_by_each_size_rule() {
    let (events, _) = receive(configured(&[541]), &s1());
    let scan = only_scan(&events);
    assert_eq!((scan.beams.len(), scan.sequence), (541, 0x1234_5678));
    assert_eq!(scan.beams[0], BeamReturn::Unknown);
    assert!((1..541).all(|i| scan.beams[i] == BeamReturn::Hit(10 * i as u16)));
    for (head, sum) in [(S2, "315A"), (S3, "4F96")] {
        let bytes = telegram(head, 1_000..1_541, sum);
        let (events, _) = receive(configured(&[541]), &bytes);
        let scan = only_scan(&events);
        assert!((0..541).all(|i| scan.beams[i] == BeamReturn::Hit(10_000 + 10 * i as u16)));
    }
}

/// The reading that was right last is tried first and covers too much: the sum then begins anew for the others.
#[test]
fn size_rule_may_change_between_telegrams() {
    let with = |head: &str, sum: &str| telegram(head, 1_000..1_541, sum);
    let (s2, s3) = (with(S2, "315A"), with(S3, "4F96"));
    let bytes = [&s3[..], &s2, &s1(), &s2, &s3, &s1(), &s3].concat();
    for portion in [1, 7, 1_000, 1_107, 5_000, bytes.len()] {
        let (mut receiver, mut scans) = (Receiver::new(configured(&[541])), 0);
        for part in bytes.chunks(portion) {
            receiver.push(part, Stamp::from_micros(1_000_000), |event| {
                scans += u32::from(matches!(event, Event::Scan(_)))
            });
        }
        assert_eq!(scans, 7, "in portions of {portion}");
    }
}

#[test]
fn s4_stand_by_is_no_data() {
    let bytes = telegram(S4, core::iter::repeat_n(0x4004, 541), "ED4D");
    assert_eq!(receive(configured(&[541]), &bytes).0, [Reported::StandBy(5)]);
}

#[test]
fn s5_flags_and_no_echo_of_bit_13() {
    let first = [0x1fff, 0x2064, 0x4064, 0x8064, 0xc064, 0xe064];
    let bytes = telegram(S5, first.into_iter().chain(core::iter::repeat_n(500, 535)), "B648");
    let (events, _) = receive(configured(&[541]), &bytes);
    let scan = only_scan(&events);
    assert_eq!(scan.beams[0], BeamReturn::Free(30_000));
    assert!(scan.beams[1..6].iter().all(|beam| *beam == BeamReturn::Hit(1_000)));
    assert!(scan.beams[6..].iter().all(|beam| *beam == BeamReturn::Hit(5_000)));
    let (events, _) = receive(Configuration::default(), &bytes);
    let beams = &only_scan(&events).beams;
    assert_eq!(
        (beams[1], beams[2], beams[5]),
        (BeamReturn::Unknown, BeamReturn::Hit(1_000), BeamReturn::Unknown)
    );
}

#[test]
fn s6_and_s7_are_valid_but_unusable() {
    let s6 = hex("000000000000 0010 FF07 0201 0100 2A000000 2B00 BBBB 1111 6400C8202C419081FF1F A1BE");
    let (events, _) = receive(configured(&[541]), &s6);
    assert_eq!(events, [Reported::Refused(TelegramError::LockOut { status: 1 })]);
    let s7 = hex("000000000000 000E FF07 0301 0000 2A000000 2B00 BBBB 1111 6400C8202C419081FF1F 5F76");
    let (events, _) = receive(configured(&[541]), &s7);
    assert_eq!(events, [Reported::Refused(TelegramError::Values { found: 5, expected: 541 })]);
}

#[test]
fn every_flipped_bit_is_refused() {
    let good = s1();
    for bit in 0..good.len() * 8 {
        let mut bytes = good.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let (events, _) = receive(configured(&[541]), &bytes);
        assert!(events.is_empty(), "bit {bit}: {events:?}");
    }
}

#[test]
fn resynchronises_within_one_telegram_after_any_beginning() {
    let good = s1();
    for cut in 1..good.len() {
        let bytes: Vec<u8> = good[cut..].iter().chain(&good).copied().collect();
        let (events, _) = receive(configured(&[541]), &bytes);
        assert_eq!(events.len(), 1, "{cut} bytes missing before");
    }
}

#[test]
fn unfinished_telegram_is_dropped_after_silence() {
    let good = s1();
    let mut receiver = Receiver::new(configured(&[541]));
    let mut scans = 0;
    receiver.push(&good[..1_107], Stamp::from_micros(0), |_| scans += 1);
    receiver.push(&good, Stamp::from_micros(40_000), |_| scans += 1);
    assert_eq!((scans, receiver.counters().gaps), (1, 1));
}

#[test]
fn lost_and_repeated_scans_are_counted() {
    let t = |scan: &str, number: &str, sum: &str| {
        let head = std::format!("00000000 0000 002B FF07 0301 0000 {scan}010000 {number}00 BBBB 1111");
        let body = "E823E823E823E803E803E823E823E803 2222 E803E803E803E803E803E803E803E803 \
                    3333 E803E803E803E803E803E803E803E803 4444 E803E803E803E803E823";
        hex(&std::format!("{head} {body} {sum}"))
    };
    let bytes: Vec<u8> = [t("17", "00", "9CF4"), t("19", "02", "3DE1"), t("19", "02", "3DE1")].concat();
    let (events, counters) = receive(configured(&[8, 8, 8, 5]), &bytes);
    assert_eq!((events.len(), counters.lost_scans, counters.repeated_scans), (3, 1, 1));
}

proptest::proptest! {
    /// The bytes may come in any portions, with anything before them.
    #[test]
    fn portions_do_not_matter(
        noise in proptest::collection::vec(0u8.., 0..300),
        portions in proptest::collection::vec(1usize..400, 1..40),
    ) {
        let bytes: Vec<u8> = noise.iter().copied().chain(s1()).chain(s1()).collect();
        let (whole, _) = receive(configured(&[541]), &bytes);
        let mut receiver = Receiver::new(configured(&[541]));
        let mut events = Vec::new();
        let mut rest = bytes.as_slice();
        for portion in portions.iter().cycle() {
            let (now, later) = rest.split_at((*portion).min(rest.len()));
            receiver.push(now, Stamp::from_micros(1_000_000), |event| events.push(reported(event)));
            rest = later;
            if rest.is_empty() { break; }
        }
        proptest::prop_assert!(!whole.is_empty());
        proptest::prop_assert_eq!(events, whole);
    }

    #[test]
    fn any_bytes_do_no_harm(bytes in proptest::collection::vec(proptest::sample::select(&[0u8, 0, 0, 0xff, 7, 2, 1, 0x28, 0xbb][..]), 0..3_000)) {
        let _ = receive(Configuration::default(), &bytes);
    }
}

/// Each field of the head stands in its place: two telegrams that differ in all of them.
#[test]
fn the_fields_of_the_head() {
    let bytes = s1();
    let first = Telegram::new_checked(&bytes).expect("a telegram");
    assert_eq!((first.version(), first.status()), (0x0102, 0));
    assert_eq!((first.scan_number(), first.telegram_number()), (0x1234_5678, 0x9ABC));
    // Too short and of odd length: no telegram, whatever its sum.
    assert!(Telegram::new_checked(&bytes[..bytes.len() - 1]).is_none());
}
