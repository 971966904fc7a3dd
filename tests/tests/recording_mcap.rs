//! Recordings: what goes in comes out, and a cut at any byte loses nothing that was complete before it.

use std::io::Cursor;

use floorguard_core::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_core::sensing::{BeamReturn, ImuSample, Scan};
use floorguard_core::time::Stamp;
use floorguard_hosted::recording::{
    Diagnostic, GridImage, Marker, MarkerShape, MotionRow, PointRow, RawStream, ReadError, Recorder,
    Recording, Severity,
};

fn at(millis: u64) -> Stamp {
    Stamp::from_micros(millis * 1_000)
}

fn scan(stamp: Stamp) -> Scan {
    let mut scan = Scan { stamp, sequence: 1, first_angle_rad: -2.356, step_rad: 0.00873, ..Scan::default() };
    for beam in [BeamReturn::Hit(1_500), BeamReturn::Free(30_000), BeamReturn::Unknown] {
        scan.beams.push(beam).expect("three beams fit");
    }
    scan
}

fn every_kind(rounds: u64) -> Vec<u8> {
    let mut recorder = Recorder::new(Cursor::new(Vec::new())).expect("memory takes everything");
    let mounting = Transform3::from_mounting(Point3::new(0.1, 0.0, 0.8), 0.1, -0.2, 2.5);
    recorder.mounting(at(0), "lidar", &mounting).expect("written");
    for round in 0..rounds {
        let now = at(round * 40);
        let points = [PointRow { position_m: [1.0, 2.0, 3.0], reflectivity: 9, ring: 4, time_s: 0.01 }; 20];
        recorder.points(now, "lidar", &points).expect("written");
        recorder.scan(&scan(now)).expect("written");
        recorder.imu(&ImuSample { stamp: now, ..ImuSample::default() }).expect("written");
        let motion = MotionRow {
            stamp: now,
            pose_in_odom: Pose2::new(1.0, 2.0, 0.5),
            twist: Twist2 { linear_mps: 0.4, angular_radps: 0.1 },
            covariance: [[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.03]],
        };
        recorder.motion(&motion).expect("written");
        recorder.raw(RawStream::Scanner, now, &[1, 2, 3, round as u8]).expect("written");
    }
    let grid = GridImage { resolution_m: 0.05, width: 2, origin: Pose2::default(), cells: &[0, 100, -1, 50] };
    recorder.map("/map", at(1), &grid).expect("written");
    let person = Marker {
        group: "people",
        id: 7,
        shape: MarkerShape::Cylinder,
        pose: Pose2::new(3.0, 1.0, 0.0),
        size_m: [0.5, 0.5, 1.7],
        color: [0.1, 0.6, 1.0, 0.8],
        text: String::from("7"),
    };
    recorder.markers(at(2), "odom", &[person]).expect("written");
    let stop = Diagnostic {
        severity: Severity::Error,
        name: String::from("scanner"),
        message: String::from("no telegram for 212 ms"),
        values: vec![(String::from("limit"), String::from("200 ms"))],
    };
    recorder.diagnostics(at(3), &[stop]).expect("written");
    recorder.finish().expect("closed").into_inner()
}

#[test]
fn what_goes_in_comes_out() {
    let file = every_kind(3);
    if let Some(path) = std::env::var_os("FLOORGUARD_KEEP_RECORDING") {
        std::fs::write(path, &file).expect("the example recording is written");
    }
    let messages: Vec<_> =
        Recording::new(Cursor::new(file)).collect::<Result<_, _>>().expect("a whole file reads to its end");
    assert_eq!(messages.len(), 1 + 3 * 6 + 3);
    let raw: Vec<_> = messages.iter().filter(|message| message.topic == "/raw/scanner").collect();
    assert_eq!(raw[2].data, [1, 2, 3, 2]);
    assert_eq!((raw[2].at, raw[2].schema.as_str()), (at(80), ""));
    let scan = messages.iter().find(|message| message.topic == "/scanner/scan").expect("a scan");
    assert_eq!(scan.schema, "sensor_msgs/msg/LaserScan");
    let ranges: Vec<f32> = scan.data[scan.data.len() - 16..scan.data.len() - 4]
        .chunks(4)
        .map(|four| f32::from_le_bytes(four.try_into().expect("four bytes")))
        .collect();
    assert_eq!(ranges[..2], [1.5, f32::INFINITY]);
    assert!(ranges[2].is_nan());
}

/// Offsets at which a message is complete, from the file format itself: opcode, length, content.
fn complete_at(file: &[u8]) -> Vec<usize> {
    let mut offset = 8;
    let mut ends = Vec::new();
    while offset + 9 <= file.len() {
        let length =
            u64::from_le_bytes(file[offset + 1..offset + 9].try_into().expect("eight bytes")) as usize;
        if file[offset] == 5 {
            ends.push(offset + 9 + length);
        }
        // 0x0f ends the data section.
        if file[offset] == 0x0f {
            break;
        }
        offset += 9 + length;
    }
    ends
}

#[test]
fn a_cut_at_any_byte_keeps_every_complete_message() {
    let file = every_kind(8);
    let ends = complete_at(&file);
    assert_eq!(ends.len(), 1 + 8 * 6 + 3);
    for cut in 0..file.len() {
        let expected = ends.iter().filter(|end| **end <= cut).count();
        let mut delivered = 0;
        let mut error = None;
        for message in Recording::new(Cursor::new(&file[..cut])) {
            match message {
                Ok(_) => delivered += 1,
                Err(problem) => error = Some(problem),
            }
        }
        assert_eq!(delivered, expected, "cut at byte {cut}");
        if let Some(ReadError::Cut { messages } | ReadError::Broken { messages, .. }) = error {
            assert_eq!(messages, expected as u64, "cut at byte {cut}");
        }
    }
}

#[test]
fn other_bytes_are_refused_with_a_reason() {
    let error = Recording::new(Cursor::new(b"this is no recording at all".to_vec())).next();
    assert!(matches!(error, Some(Err(ReadError::Broken { messages: 0, .. }))), "{error:?}");
}
