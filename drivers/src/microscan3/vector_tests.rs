//! The test message of the book, microScan3: Test message, in either order, and what is wrong about each of its bytes.

use std::vec::Vec;

use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

use super::*;

const A: &str =
    "4D5333204D440100740000004D0000000000000000000000560100006F96080170960801000000006712000068120000
                 C44800004E61BC0034001000440018005C0018000000000000000000010EFF0FFFFF0F01";
const B: &str =
    "4D5333204D440100740000004D0000003C0000000000000000000300000000000100050028000000000020F466660600
                 250000000000000005000000E8033201D0073C0900000002409CFF052C010731";

pub(super) fn hex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text.bytes().filter(u8::is_ascii_hexdigit).collect();
    digits
        .chunks(2)
        .map(|pair| u8::from_str_radix(core::str::from_utf8(pair).unwrap(), 16).unwrap())
        .collect()
}

/// The message of the vector without the headers of its two datagrams.
pub(super) fn message() -> Vec<u8> {
    let bytes = [&hex(A)[24..], &hex(B)[24..]].concat();
    assert_eq!(bytes.len(), 116);
    bytes
}

fn scans(receiver: &mut Receiver, datagrams: &[Vec<u8>], at_us: u64) -> Vec<Scan> {
    let mut found = Vec::new();
    for datagram in datagrams {
        receiver.push(datagram, Stamp::from_micros(at_us), |event| match event {
            Event::Scan(scan) => found.push(scan.clone()),
            other => panic!("{other:?}"),
        });
    }
    found
}

#[test]
fn the_message_decodes_to_the_published_values() {
    let bytes = message();
    let message = Message::new_checked(&bytes).unwrap();
    assert_eq!((message.serial_number(), message.plug_serial_number()), (17_340_015, 17_340_016));
    assert_eq!((message.sequence_number(), message.scan_number()), (4_711, 4_712));
    assert_eq!((message.date_days(), message.time_of_day_ms()), (18_628, 12_345_678));
    let geometry = message.geometry().unwrap();
    assert_eq!((geometry.factor_mm, geometry.beams, geometry.scan_time_ms), (1, 5, 40));
    assert_eq!((geometry.start_deg, geometry.beam_period_us), (-47.5, 37));
    assert!((geometry.resolution_deg - 0.099_999_9).abs() < 1e-6);
    let beams: Vec<_> = message.measured().unwrap().beams().collect();
    let wanted = [(1_000, 50, 0x01), (2_000, 60, 0x09), (0, 0, 0x02), (40_000, 255, 0x05), (300, 7, 0x31)];
    assert_eq!(beams, wanted.map(|(distance, strength, status)| (distance, strength, BeamStatus(status))));
    assert!(beams[1].2.is_reflector() && beams[3].2.has_glare() && beams[2].2.is_infinite());
    assert!(beams[4].2.is_contaminated() && beams[4].2.warns_of_contamination() && beams[4].2.is_valid());
    let status = message.status().unwrap();
    assert!(status.runs() && !status.stands_by() && !status.has_device_error());
    let paths = (1..=3).chain(8..=19).fold(0_u32, |paths, path| paths | 1 << path);
    assert_eq!(status.safe_paths(), paths);
    assert_eq!(status.other_paths(), 0xF_FFFF);
    assert_eq!((status.reset_required(), status.monitoring_cases()), (1, [3, 0, 0, 0]));
    assert!(message.intrusion().is_none() && message.application().is_none());
}

#[test]
fn either_order_gives_the_scan() {
    for order in [[A, B], [B, A]] {
        let mut receiver = Receiver::new(Configuration::default());
        let datagrams = order.map(hex);
        assert!(scans(&mut receiver, &datagrams[..1], 1_000_000).is_empty());
        let found = scans(&mut receiver, &datagrams[1..], 1_000_900);
        let [scan] = &found[..] else { panic!("one scan") };
        assert_eq!(scan.sequence, 4_712);
        // −47.5° in the device's frame is 137.5° to the right of straight ahead.
        assert!((scan.first_angle_rad - -137.5_f32.to_radians()).abs() < 1e-6);
        assert!((scan.step_rad - 0.1_f32.to_radians()).abs() < 1e-6);
        use BeamReturn::{Free, Hit, Unknown};
        assert_eq!(scan.beams, [Hit(1_000), Hit(2_000), Free(5_500), Unknown, Unknown]);
        // Two and a half beams of 37 µs before the last one, 10 ms before the first datagram.
        assert_eq!(scan.stamp.as_micros(), 1_000_000 - 10_000 - 92);
        assert_eq!(receiver.counters().scans, 1);
        assert!(receiver.status().unwrap().runs());
    }
}

#[test]
fn upside_down_the_beams_run_the_other_way() {
    let mut receiver = Receiver::new(Configuration { inverted: true, ..Configuration::default() });
    let found = scans(&mut receiver, &[hex(A), hex(B)], 1_000_000);
    assert!((found[0].first_angle_rad - (137.5_f32 - 0.4).to_radians()).abs() < 1e-5);
    assert_eq!(found[0].beams[4], BeamReturn::Hit(1_000));
    assert!(found[0].step_rad > 0.0);
}

/// The message with one change, as a single datagram.
fn reported_for(change: impl FnOnce(&mut Vec<u8>)) -> (Vec<ScanError>, u32, u32) {
    let mut bytes = message();
    change(&mut bytes);
    let mut datagram = hex(A)[..24].to_vec();
    datagram[8..12].copy_from_slice(&(bytes.len() as u32).to_le_bytes());
    datagram.extend(&bytes);
    let mut receiver = Receiver::new(Configuration::default());
    let (mut errors, mut stand_by) = (Vec::new(), 0);
    receiver.push(&datagram, Stamp::from_micros(1_000_000), |event| match event {
        Event::Refused(error) => errors.push(error),
        Event::StandBy { .. } => stand_by += 1,
        Event::Scan(_) => {}
    });
    (errors, stand_by, receiver.counters().scans)
}

#[test]
fn device_status_precedes_its_beams() {
    assert_eq!(reported_for(|_| {}), (std::vec![], 0, 1));
    assert_eq!(reported_for(|bytes| bytes[52] = 0b10), (std::vec![], 1, 0), "stand-by");
    assert_eq!(reported_for(|bytes| bytes[52] = 0), (std::vec![], 1, 0), "does not run");
    assert_eq!(reported_for(|bytes| bytes[67] = 1), (std::vec![ScanError::Device], 0, 0));
    assert_eq!(reported_for(|bytes| bytes[67] = 2), (std::vec![ScanError::Device], 0, 0));
}

#[test]
fn messages_that_lie_are_refused() {
    let only = |error| (std::vec![error], 0, 0);
    let invalid = ScanError::Message(MessageError::Invalid { found: 0 });
    assert_eq!(reported_for(|bytes| bytes[0] = 0), only(invalid));
    assert_eq!(
        reported_for(|bytes| bytes.truncate(51)),
        only(ScanError::Message(MessageError::Short { length: 51 }))
    );
    let header_alone = |bytes: &mut Vec<u8>| {
        bytes.truncate(52);
        bytes[32..].fill(0);
    };
    assert_eq!(reported_for(header_alone), only(ScanError::NoGeometry), "a whole message without blocks");
    let outside = ScanError::Message(MessageError::Block { offset: 92, size: 25 });
    assert_eq!(reported_for(|bytes| bytes[42] = 25), only(outside));
    let within_header = ScanError::Message(MessageError::Block { offset: 51, size: 24 });
    assert_eq!(reported_for(|bytes| bytes[40] = 51), only(within_header));
    let far = ScanError::Message(MessageError::Block { offset: 0xFFFF, size: 0xFFFF });
    assert_eq!(reported_for(|bytes| bytes[40..44].fill(0xFF)), only(far));
    assert_eq!(reported_for(|bytes| bytes[36..40].fill(0)), only(ScanError::NoGeometry));
    assert_eq!(reported_for(|bytes| bytes[38] = 19), only(ScanError::NoGeometry));
    assert_eq!(reported_for(|bytes| bytes[40..44].fill(0)), only(ScanError::NoMeasurement));
    assert_eq!(reported_for(|bytes| bytes[92] = 6), only(ScanError::NoMeasurement), "six beams of five");
    assert_eq!(reported_for(|bytes| bytes[92..96].fill(0xFF)), only(ScanError::NoMeasurement));
    assert_eq!(reported_for(|bytes| bytes[92] = 4), only(ScanError::Beams { found: 4, announced: 5 }));
    let none = |bytes: &mut Vec<u8>| (bytes[92], bytes[70]) = (0, 0);
    assert_eq!(reported_for(none), only(ScanError::Beams { found: 0, announced: 0 }));
    assert_eq!(
        reported_for(|bytes| bytes[68..70].fill(0)),
        only(ScanError::Geometry),
        "a count of no length"
    );
    assert_eq!(
        reported_for(|bytes| bytes[80..84].fill(0)),
        only(ScanError::Geometry),
        "all beams at one angle"
    );
    assert_eq!(reported_for(|bytes| bytes[83] = 0x80), only(ScanError::Geometry), "backwards");
    assert_eq!(reported_for(|bytes| bytes[83] = 0x7F), only(ScanError::Geometry), "more than a turn");
}

/// Flags of the book, microScan3: Beams, in all combinations: only "valid" alone is an obstacle and only "infinite"
/// alone is free.
#[test]
fn no_flag_makes_a_blind_beam_free() {
    for flags in 0..64_u8 {
        for distance in [0_u16, 1_234] {
            let mut bytes = message();
            bytes[96..98].copy_from_slice(&distance.to_le_bytes());
            bytes[99] = flags;
            let mut datagram = hex(A)[..24].to_vec();
            datagram.extend(&bytes);
            let mut receiver = Receiver::new(Configuration::default());
            let beam = scans(&mut receiver, &[datagram], 1_000_000)[0].beams[0];
            let wanted = match (flags & 0b111, flags & 0b1_0000, distance) {
                (0b001, 0, 1_234) => BeamReturn::Hit(1_234),
                (0b010, 0, _) => BeamReturn::Free(5_500),
                _ => BeamReturn::Unknown,
            };
            assert_eq!(beam, wanted, "{flags:06b} {distance}");
        }
    }
}

#[test]
fn intrusion_is_read_within_its_bounds() {
    let block = hex("02000000 0180 00000000 01000000 FF 05000000 00");
    let paths: Vec<&[u8]> = Intrusion::new(&block).paths().collect();
    assert_eq!(paths, [&[0x01, 0x80][..], &[], &[0xFF]]);
    let endless = [0; 400];
    assert_eq!(Intrusion::new(&endless).paths().count(), 24);
}

/// Blocks that the robot does not need, where they are sent.
#[test]
fn intrusion_and_application_are_delivered() {
    let mut bytes = message();
    let found = |bytes: &[u8]| {
        let message = Message::new_checked(bytes).unwrap();
        (message.intrusion().is_some(), message.application().map(<[u8]>::to_vec))
    };
    let (offset, length) = (bytes.len() as u16, 3_u16);
    for place in [44, 48] {
        bytes[place..place + 2].copy_from_slice(&offset.to_le_bytes());
        bytes[place + 2..place + 4].copy_from_slice(&length.to_le_bytes());
    }
    bytes.extend([7, 8, 9]);
    assert_eq!(found(&bytes), (true, Some(std::vec![7, 8, 9])));
    bytes[44..52].fill(0);
    assert_eq!(found(&bytes), (false, None));
    // A length without a place lies in the header: it is a lie.
    bytes[46] = 1;
    assert!(matches!(Message::new_checked(&bytes), Err(MessageError::Block { offset: 0, size: 1 })));
}
