//! Lines that the reference in Python writes: `python3 examples/wheel_line.py vectors`.

use proptest::prelude::*;
use std::string::ToString;

use super::*;

const VECTOR_TURN: &str = "W 7 100 1 250 -250*3AF2";
const VECTOR_OFF: &str = "W 4294967295 65535 0 0 0 0 0*C866";
const VECTOR_REPORT: &str = "M 12 7 3 2 100 2147483647 -100 -2147483648*0DCD";

fn request(sequence: u32, deadline_ms: u16, follow: bool, speeds: &[i32]) -> WheelRequest {
    WheelRequest { sequence, deadline_ms, follow, speeds_mmps: speeds.iter().copied().collect() }
}

#[test]
fn lines_equal_the_vectors() {
    let table = [
        (request(7, 100, true, &[250, -250]), VECTOR_TURN),
        (request(u32::MAX, 65_535, false, &[0, 0, 0, 0]), VECTOR_OFF),
    ];
    for (request, line) in table {
        assert_eq!(request.encode().trim_end(), line);
        assert_eq!(WheelRequest::decode(line.as_bytes()), Ok(request));
    }
    let wheels = [(100, 2_147_483_647), (-100, -2_147_483_648)];
    let wheels = wheels.map(|(speed_mmps, count)| WheelValue { speed_mmps, count });
    let report = WheelReport {
        sequence: 12,
        heard: 7,
        age_ms: 3,
        state: WheelState::Expired,
        wheels: wheels.into_iter().collect(),
    };
    assert_eq!(report.encode().trim_end(), VECTOR_REPORT);
    assert_eq!(WheelReport::decode(VECTOR_REPORT.as_bytes()), Ok(report));
}

#[test]
fn damaged_lines_are_refused() {
    for line in [VECTOR_TURN, VECTOR_OFF] {
        for at in 0..line.len() {
            let mut bytes = line.as_bytes().to_vec();
            bytes[at] ^= 0x01;
            assert!(WheelRequest::decode(&bytes).is_err(), "{line} at {at}");
            assert!(WheelRequest::decode(&line.as_bytes()[..at]).is_err());
        }
        assert_eq!(WheelReport::decode(line.as_bytes()), Err(WheelLineError::Kind));
    }
    let summed = |text: &str| {
        let sum = crc::Crc::<u16>::new(&crc::CRC_16_IBM_3740).checksum(text.as_bytes());
        std::format!("{text}*{sum:04X}")
    };
    for text in [
        "W 1 100 1",
        "W 1 100 2 5",
        "W 1 70000 1 5",
        "W 1 100 1 5 5 5 5 5",
        "W -1 100 1 5",
        "W 1 100 1 5 ",
        "W",
    ] {
        assert_eq!(WheelRequest::decode(summed(text).as_bytes()), Err(WheelLineError::Words), "{text}");
    }
    for text in ["M 1 1 0 1", "M 1 1 0 4 5 5", "M 1 1 0 1 5", "M 1 1 0 1 1 1 1 1 1 1 1 1 1 1"] {
        assert_eq!(WheelReport::decode(summed(text).as_bytes()), Err(WheelLineError::Words), "{text}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_line_is_survived(line in proptest::collection::vec(any::<u8>(), 0..120)) {
        let _ = (WheelRequest::decode(&line).is_ok(), WheelReport::decode(&line).is_ok());
    }

    #[test]
    fn lines_come_back(values in proptest::collection::vec(any::<(i32, i32)>(), 1..=2), sequence in any::<u32>()) {
        let wheels = values.iter().map(|(speed_mmps, count)| WheelValue { speed_mmps: *speed_mmps, count: *count });
        let report = WheelReport { sequence, heard: sequence ^ 1, age_ms: 5, state: WheelState::Off, wheels: wheels.collect() };
        let line = report.encode().to_string();
        prop_assert_eq!(WheelReport::decode(line.trim_end().as_bytes()), Ok(report));
    }
}
