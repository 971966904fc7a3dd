//! Replies of the specification, of another program's tests, and damaged ones.

use super::*;
use floorguard_types::time::Stamp;
use proptest::prelude::*;
use std::string::String;
use std::vec::Vec;

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

/// Every reply as text, in portions of a length.
fn heard(bytes: &[u8], portion: usize) -> Vec<String> {
    let mut receiver = Receiver::new();
    let mut replies = Vec::new();
    for part in bytes.chunks(portion) {
        receiver.push(part, at(1_000), |reply| {
            replies.push(match reply {
                Reply::Scan(scan) => std::format!("scan {} {:?}", scan.sensor_ms, scan.distances_mm),
                other => std::format!("{other:?}"),
            });
        });
    }
    replies
}

/// A line with its check character, computed here another way.
fn line(content: &str) -> String {
    let sum: u32 = content.bytes().map(u32::from).sum();
    std::format!("{content}{}\n", char::from((sum % 64 + 48) as u8))
}

fn characters(number: u32, count: u32) -> String {
    (0..count).rev().map(|place| char::from(((number / 64_u32.pow(place)) % 64 + 48) as u8)).collect()
}

/// A reply with a scan, as the sensor sends it.
pub(super) fn scan_reply(echo: &str, status: &str, sensor_ms: u32, values: &[u32]) -> Vec<u8> {
    let mut text = std::format!("{echo}\n{}{}", line(status), line(&characters(sensor_ms, 4)));
    let count = if echo.as_bytes()[1] == b'S' { 2 } else { 3 };
    let data: String = values.iter().map(|value| characters(*value, count)).collect();
    for block in data.as_bytes().chunks(64) {
        text.push_str(&line(std::str::from_utf8(block).unwrap()));
    }
    text.push('\n');
    text.into_bytes()
}

/// The test data of a program that others wrote for these sensors (urg_stamped, test_scip2): of four replies two are complete.
#[test]
fn replies_are_found_among_others() {
    let bytes = b"QT\n00P\n\nFOO\nBAR\nQT\n\nQT\n\nQT\n00P\n\n";
    let accepted = std::format!("{:?}", Reply::Status { command: *b"QT", status: Status::Accepted });
    for portion in [1, 2, 5, 100] {
        let replies = heard(bytes, portion);
        assert_eq!(replies.iter().filter(|reply| **reply == accepted).count(), 2, "{replies:?}");
        assert_eq!(replies.len(), 4, "{replies:?}");
    }
}

/// The example of the specification's section 8.12, lines as printed; two of them are printed with other characters than their sums
/// have, and are left out.
#[test]
fn published_parameters_are_read() {
    let printed = "PP\n00P\nDMIN:20;4\nDMAX:5600;_\nAMIN:44;7\nAMAX:725;o\nAFRT:384;6\nSCAN:600;e\n\n";
    let mut found = None;
    Receiver::new().push(printed.as_bytes(), at(0), |reply| {
        if let Reply::Parameters(parameters) = reply {
            found = Some(parameters);
        }
    });
    let expected = SensorParameters { steps_per_turn: 0, ..SensorParameters::URG_04LX };
    assert_eq!(found, Some(expected));
}

/// The encodings of the specification's sections 6.1 to 6.3 within replies.
#[test]
fn published_numbers_are_read_within_scans() {
    let bytes = scan_reply("MD0044004501005", "99", 16_000_000, &[5_432, 19]);
    assert_eq!(
        std::str::from_utf8(&bytes).unwrap(),
        "MD0044004501005\n99b\nm2@0?\n1Dh00C@\n\n"
            .replace("m2@0?", line("m2@0").trim_end())
            .replace("1Dh00C@", line("1Dh00C").trim_end())
    );
    assert_eq!(heard(&bytes, 7), ["scan 16000000 [5432, 19]"]);
    let short = scan_reply("GS0000000000", "00", 5, &[1_234]);
    assert_eq!(heard(&short, 3), ["scan 5 [1234]"]);
}

#[test]
fn values_may_straddle_lines() {
    let values: Vec<u32> = (0..682).map(|step| 20 + step * 7).collect();
    let bytes = scan_reply("MD0044072501000", "99", 77, &values);
    // 2,046 characters in 32 lines: 64 is no multiple of three.
    assert_eq!(bytes.len(), 16 + 4 + 6 + 2_046 + 32 * 2 + 1);
    for portion in [1, 64, 65, 4_000] {
        assert_eq!(heard(&bytes, portion), [std::format!("scan 77 {values:?}")]);
    }
}

#[test]
fn strengths_come_with_distances() {
    let values: Vec<u32> = (0..20).collect();
    let bytes = scan_reply("ME0000000901007", "99", 1, &values);
    let mut taken = 0;
    Receiver::new().push(&bytes, at(0), |reply| {
        let Reply::Scan(scan) = reply else { panic!("{reply:?}") };
        taken += 1;
        assert_eq!(scan.distances_mm, (0..20).step_by(2).collect::<Vec<u32>>()[..]);
        assert_eq!(scan.strengths, (1..20).step_by(2).collect::<Vec<u32>>()[..]);
        assert_eq!((scan.remaining, scan.kind), (Some(7), RangeKind::Strength));
    });
    assert_eq!(taken, 1);
}

#[test]
fn statuses_mean_what_the_specification_says() {
    let meanings = [
        ("00", Status::Accepted),
        ("98", Status::Resumed),
        ("10", Status::LaserOff),
        ("21", Status::Interrupted(21)),
        ("49", Status::Interrupted(49)),
        ("50", Status::Trouble(50)),
        ("97", Status::Trouble(97)),
        ("04", Status::Refused(*b"04")),
        ("0E", Status::Refused(*b"0E")),
    ];
    for (code, status) in meanings {
        let bytes = std::format!("MD0044072501000\n{}\n", line(code));
        let expected = std::format!("{:?}", Reply::Status { command: *b"MD", status });
        assert_eq!(heard(bytes.as_bytes(), 9), [expected]);
    }
}

/// Any one damaged character refuses the scan, and the next one is whole again.
#[test]
fn damaged_scans_are_refused_whole() {
    let values: Vec<u32> = (0..100).map(|step| 1_000 + step).collect();
    let whole = scan_reply("MD0100019901000", "99", 9, &values);
    let expected = std::format!("scan 9 {values:?}");
    for place in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[place] ^= 1;
        bytes.extend_from_slice(&whole);
        bytes.extend_from_slice(&whole);
        let replies = heard(&bytes, 50);
        let wrong = replies.iter().filter(|reply| reply.starts_with("scan") && **reply != expected);
        // The number of scans that remain is in the echo, which has no check character.
        assert_eq!(wrong.count(), 0, "byte {place}: {replies:?}");
        assert_eq!(replies.last(), Some(&expected), "byte {place}");
    }
    let mut receiver = Receiver::new();
    let mut bytes = whole.clone();
    bytes[40] = b'n';
    receiver.push(&bytes, at(0), |_| {});
    assert_eq!((receiver.counters().check_characters, receiver.counters().scans), (1, 0));
}

#[test]
fn missing_and_surplus_values_are_refused() {
    for count in [0_usize, 1, 99, 101, 1_500] {
        let values = std::vec![30_u32; count];
        let bytes = scan_reply("MD0100019901000", "99", 9, &values);
        let replies = heard(&bytes, 64);
        let refused = |reply: &String| reply.starts_with("Refused(Values") || reply == "Refused(TooLong)";
        assert!(replies.len() == 1 && refused(&replies[0]), "{count}: {replies:?}");
    }
}

#[test]
fn broken_replies_end_with_silence() {
    let whole = scan_reply("MD0100010101000", "99", 9, &[500, 600]);
    let mut receiver = Receiver::new();
    receiver.push(&whole[..25], at(0), |reply| panic!("{reply:?}"));
    let mut replies = Vec::new();
    receiver.push(&whole, at(600_000), |reply| replies.push(std::format!("{reply:?}").starts_with("Scan")));
    assert_eq!(replies, [false, true]);
}

proptest! {
    /// Any bytes: no panic, and a whole scan after an empty line is understood.
    #[test]
    fn any_bytes_are_survived(noise in proptest::collection::vec(any::<u8>(), 0..3_000), portion in 1_usize..200) {
        let mut bytes = noise;
        bytes.extend_from_slice(b"\n\n");
        bytes.extend_from_slice(&scan_reply("MD0100010101000", "99", 9, &[500, 600]));
        let replies = heard(&bytes, portion);
        prop_assert_eq!(replies.last().map(String::as_str), Some("scan 9 [500, 600]"));
    }

    /// Lines with right check characters, of any form.
    #[test]
    fn any_lines_are_survived(lines in proptest::collection::vec("[0-o]{0,70}", 0..60)) {
        let mut text = String::from("MD0000144001000\n");
        text.push_str(&line("99"));
        for content in &lines {
            text.push_str(&line(content));
        }
        text.push('\n');
        for reply in heard(text.as_bytes(), 33) {
            prop_assert!(!reply.is_empty());
        }
    }
}
