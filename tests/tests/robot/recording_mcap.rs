//! Recordings: what goes in comes out, and a cut at any byte loses nothing that was complete before it.

use std::io::Cursor;

use floorguard_recording::{
    Diagnostic, GridImage, Marker, MarkerShape, MotionRow, PointRow, RawStream, ReadError, Recorder,
    Recording, Severity, count_messages, octets_of, topics,
};
use floorguard_types::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::{BeamReturn, ImuSample, Scan};
use floorguard_types::time::Stamp;

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
        let points = [PointRow { position_m: [1.0, 2.0, 3.0], reflectivity: 9, ring: 4, time_s: 0.01 }; 100];
        recorder.points(now, (now, "lidar"), &points).expect("written");
        recorder.scan(now, &scan(now)).expect("written");
        recorder.imu(now, &ImuSample { stamp: now, ..ImuSample::default() }).expect("written");
        let motion = MotionRow {
            stamp: now,
            pose_in_odom: Pose2::new(1.0, 2.0, 0.5),
            twist: Twist2 { linear_mps: 0.4, angular_radps: 0.1 },
            covariance: [[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.03]],
        };
        recorder.motion(now, &motion).expect("written");
        recorder.raw(RawStream::Scanner, now, &[1, 2, 3, round as u8]).expect("written");
    }
    let grid = GridImage { resolution_m: 0.05, width: 2, origin: Pose2::default(), cells: &[0, 100, -1, 50] };
    recorder.map("/map", (at(1), "odom"), &grid).expect("written");
    let person = Marker {
        group: "people",
        id: 7,
        shape: MarkerShape::Cylinder,
        pose: Pose2::new(3.0, 1.0, 0.0),
        size_m: [0.5, 0.5, 1.7],
        color: [0.1, 0.6, 1.0, 0.8],
        text: String::from("7"),
        points: Vec::new(),
    };
    recorder.markers(topics::PEOPLE, (at(2), "odom"), &[person]).expect("written");
    let stop = Diagnostic {
        severity: Severity::Error,
        name: String::from("scanner"),
        message: String::from("no telegram for 212 ms"),
        values: vec![(String::from("limit"), String::from("200 ms"))],
    };
    recorder.diagnostics(topics::STOPS, at(3), &[stop]).expect("written");
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
    let raw: Vec<_> = messages.iter().filter(|message| &*message.topic == "/raw/scanner").collect();
    assert_eq!(octets_of(&raw[2].data), Some([1, 2, 3, 2].as_slice()));
    assert_eq!((raw[2].at, &*raw[2].schema), (at(80), "std_msgs/msg/UInt8MultiArray"));
    let scan = messages.iter().find(|message| &*message.topic == topics::SCAN).expect("a scan");
    assert_eq!(&*scan.schema, "sensor_msgs/msg/LaserScan");
    let ranges: Vec<f32> = scan.data[scan.data.len() - 16..scan.data.len() - 4]
        .chunks(4)
        .map(|four| f32::from_le_bytes(four.try_into().expect("four bytes")))
        .collect();
    assert_eq!(ranges[..2], [1.5, f32::INFINITY]);
    assert!(ranges[2].is_nan());
}

/// Offsets at which a message is complete, from the file format itself: opcode, length, content. A chunk's content is
/// 28 bytes of times, size and checksum, the name of its packing (none), its length, and records.
fn complete_at(file: &[u8]) -> Vec<usize> {
    const CHUNK_HEAD: usize = 28 + 4 + 8;
    let mut offset = 8;
    let mut ends = Vec::new();
    while offset + 9 <= file.len() {
        let length =
            u64::from_le_bytes(file[offset + 1..offset + 9].try_into().expect("eight bytes")) as usize;
        match file[offset] {
            // A chunk: its records stand in the file one after the other, too.
            6 => offset += 9 + CHUNK_HEAD,
            // 0x0f ends the data section.
            0x0F => break,
            opcode => {
                offset += 9 + length;
                ends.extend((opcode == 5).then_some(offset));
            }
        }
    }
    ends
}

/// Reads a file that was cut; gives the messages delivered and those that the error speaks of.
fn read_cut(file: &[u8]) -> (u64, Option<u64>) {
    let (mut delivered, mut reported) = (0, None);
    for message in Recording::new(file) {
        match message {
            Ok(_) => delivered += 1,
            Err(ReadError::Cut { messages } | ReadError::Broken { messages, .. }) => {
                reported = Some(messages)
            }
            Err(ReadError::Io(error)) => panic!("memory cannot fail: {error}"),
        }
    }
    (delivered, reported)
}

#[test]
fn cut_keeps_every_complete_message() {
    let file = every_kind(8);
    let ends = complete_at(&file);
    assert_eq!(ends.len(), 1 + 8 * 6 + 3);
    for cut in 0..file.len() {
        let expected = ends.iter().filter(|end| **end <= cut).count() as u64;
        let (delivered, reported) = read_cut(&file[..cut]);
        assert_eq!(delivered, expected, "cut at byte {cut}");
        assert!(reported.is_none_or(|reported| reported == expected), "cut at byte {cut}");
    }
}

/// Every one of the 1,048,576 offsets of a file of 1 MiB and more: nothing that was complete is lost.
#[test]
fn every_offset_of_a_mebibyte() {
    const MEBIBYTE: usize = 1 << 20;
    let file = every_kind(300);
    assert!(file.len() > MEBIBYTE, "{}", file.len());
    let ends = complete_at(&file);
    let halves = [0..MEBIBYTE / 2, MEBIBYTE / 2..MEBIBYTE];
    std::thread::scope(|scope| {
        for half in halves {
            let (file, ends) = (&file, &ends);
            scope.spawn(move || {
                for cut in half {
                    let expected = ends.partition_point(|end| *end <= cut);
                    let last = expected.checked_sub(1).map_or(0, |last| ends[last]);
                    assert_eq!(count_messages(&file[..cut]), (expected as u64, last), "cut at byte {cut}");
                }
            });
        }
    });
    // The reader that users have, which copies: around every fifth end of a message.
    for (index, end) in ends.iter().enumerate().step_by(5).filter(|(_, end)| **end < MEBIBYTE) {
        let complete = index as u64 + 1;
        assert_eq!(read_cut(&file[..end - 1]).0, complete - 1);
        assert_eq!(read_cut(&file[..end + 5]), (complete, Some(complete)));
    }
}

#[test]
fn other_bytes_are_refused_with_a_reason() {
    let error = Recording::new(Cursor::new(b"this is no recording at all".to_vec())).next();
    assert!(matches!(error, Some(Err(ReadError::Broken { messages: 0, .. }))), "{error:?}");
}

#[test]
fn the_reference_library_reads_what_we_write() {
    let file = every_kind(3);
    let messages: Vec<_> = mcap::MessageStream::new(&file)
        .expect("a readable file")
        .collect::<Result<_, _>>()
        .expect("to its end");
    let ours: Vec<_> = Recording::new(file.as_slice()).collect::<Result<_, _>>().expect("to its end");
    assert_eq!(messages.len(), ours.len());
    for (theirs, ours) in messages.iter().zip(&ours) {
        assert_eq!((theirs.channel.topic.as_str(), &*theirs.data), (&*ours.topic, ours.data.as_slice()));
    }
}

/// Files of other recorders: in chunks, packed or not.
#[test]
fn chunks_of_other_recorders_are_unfolded() {
    let options = mcap::WriteOptions::new().use_chunks(true).chunk_size(Some(512)).compression(None);
    let mut writer = options.create(Cursor::new(Vec::new())).expect("memory takes everything");
    let schema = writer.add_schema("std_msgs/msg/String", "ros2msg", b"string data").expect("added");
    let channel = writer.add_channel(schema, "/words", "cdr", &Default::default()).expect("added");
    for sequence in 0..100 {
        let times = u64::from(sequence) * 1_000_000;
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence,
            log_time: times,
            publish_time: times,
        };
        writer.write_to_known_channel(&header, &[sequence as u8; 40]).expect("written");
    }
    writer.finish().expect("closed");
    let file = writer.into_inner().into_inner();
    let messages: Vec<_> = Recording::new(file.as_slice()).collect::<Result<_, _>>().expect("to its end");
    assert_eq!(messages.len(), 100);
    assert_eq!((messages[99].at, messages[99].data[0]), (at(99), 99));
    for cut in 0..file.len() {
        assert!(read_cut(&file[..cut]).0 <= 100);
    }
}
