//! The recorder believes the samples that the robot believes.

use std::collections::BTreeMap;
use std::io::Cursor;

use floorguard_configuration::{EXAMPLE, parse};
use floorguard_drivers::vectornav::sentence;
use floorguard_runtime::configuration::ImuModel;
use floorguard_runtime::tape::TapeLine;

use super::{RunInfo, RunRecorder};
use crate::count_messages;

/// A frame of a VectorNav with a right checksum (book, VectorNav).
const FRAME: [u8; 42] = [
    0xFA, 0x05, 0x21, 0x01, 0x00, 0x08, 0x79, 0xDF, 0x0D, 0x86, 0x48, 0x70, 0x00, 0x00, 0x00, 0x00, 0x80,
    0x3E, 0x00, 0x00, 0x00, 0xBF, 0x00, 0x00, 0x00, 0x3D, 0x00, 0x00, 0xC0, 0x3F, 0x00, 0x00, 0x00, 0xBE,
    0x00, 0x00, 0x1D, 0xC1, 0x40, 0x00, 0x49, 0xCC,
];

/// Messages of a recording of what came over the line of the inertial sensor: moments, milliseconds, and bytes.
fn messages(line: &[(u64, Vec<u8>)]) -> u64 {
    let mut robot = parse("robot.toml", EXAMPLE).expect("the example").robot;
    let mut imu = robot.imu.unwrap_or_default();
    imu.model = ImuModel::VectorNav;
    robot.imu = Some(imu);
    let info = RunInfo {
        robot: &robot,
        robot_toml: EXAMPLE,
        imu_baud: 115_200,
        clouds_every: 0,
        texts: BTreeMap::new(),
    };
    let mut recorder = RunRecorder::new(Cursor::new(Vec::new()), &info).expect("a recorder");
    for (at_ms, bytes) in line {
        recorder.delivered((at_ms * 1_000, at_ms * 1_000), TapeLine::Imu, bytes);
    }
    let file = recorder.finish(10_000_000, None).expect("written").expect("a writer").into_inner();
    count_messages(&file).0
}

/// A wrong device is plugged in, is not used, and is replaced six seconds later by a right one.
#[test]
fn replaced_inertial_sensor_is_recorded_again() {
    let answer = |at_ms: u64, words: &str| (at_ms, sentence(words.as_bytes()).expect("words").to_vec());
    let mut line = vec![answer(10, "VNASY,0"), answer(20, "VNRRG,01,AB-100")];
    let before = messages(&line);
    line.push((30, FRAME.to_vec()));
    assert_eq!(messages(&line), before + 1, "its bytes, and no sample");
    line.push((6_000, Vec::new()));
    let rest = ["VNASY,0", "VNRRG,01,VN-100S", "VNWRG,06,0", "VNWRG,75,3,8,05,0121,0800", "VNASY,1"];
    line.extend(rest.into_iter().zip(1..).map(|(words, step)| answer(6_000 + 10 * step, words)));
    let before = messages(&line);
    line.push((6_100, FRAME.to_vec()));
    assert_eq!(messages(&line), before + 2, "its bytes and a sample");
}
