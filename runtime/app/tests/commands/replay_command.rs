//! `floorguard replay` as a stranger types it: recordings, ROS 2 bags, CARMEN logs, and what is none of these.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use floorguard_recording::{PointRow, Recorder, Recording, topics};
use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::time::Stamp;
use serde_json::Value;

pub(super) fn floorguard(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floorguard")).args(arguments).output().expect("the program starts")
}

pub(super) fn text(path: &Path) -> &str {
    path.to_str().expect("a readable path")
}

pub(super) fn rows(output: &Output) -> Vec<Value> {
    let lines = String::from_utf8_lossy(&output.stdout);
    lines.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect()
}

pub(super) fn replay(path: &Path) -> (Output, Vec<Value>) {
    let output = floorguard(&["replay", text(path), "--json"]);
    let rows = rows(&output);
    (output, rows)
}

fn refusal(path: &Path) -> String {
    let output = floorguard(&["replay", text(path)]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A hall with a floor and somebody who walks through it, seen by a lidar of 16 rings at 0.8 m.
pub(super) fn hall(at_s: f32) -> Vec<PointRow> {
    let mut points = Vec::new();
    let walker = (3.0_f32, -2.0 + 1.2 * at_s);
    for ring in 0..16_u16 {
        let (sin, cos) = (-15.0 + 2.0 * f32::from(ring)).to_radians().sin_cos();
        for column in 0..1_800_u16 {
            let (y, x) = (-f32::from(column) * 0.2_f32.to_radians()).sin_cos();
            // The walls stand 9 m away; the floor is 0.8 m below; the walker is a cylinder of 0.22 m and 1.75 m.
            let mut range_m = (9.0 / cos).min(if sin < 0.0 { -0.8 / sin } else { f32::INFINITY });
            let along = walker.0 * x + walker.1 * y;
            let aside = (walker.1 * x - walker.0 * y).abs();
            if along > 0.0 && aside < 0.22 {
                let hit_m = (along - (0.22_f32.powi(2) - aside * aside).sqrt()) / cos;
                if hit_m < range_m && hit_m * sin < 0.95 {
                    range_m = hit_m;
                }
            }
            let position_m = [range_m * cos * x, range_m * cos * y, range_m * sin];
            points.push(PointRow { position_m, reflectivity: 20, ring, time_s: 0.0 });
        }
    }
    points
}

pub(super) fn bag(folder: &Path, seconds: u64) -> PathBuf {
    let path = folder.join("hall.mcap");
    let file = std::fs::File::create(&path).expect("a file");
    let mut recorder = Recorder::new(file).expect("written");
    for round in 0..seconds * 10 {
        let stamp = Stamp::from_micros(1_700_000_000_000_000 + round * 100_000);
        recorder.points(stamp, (stamp, "velodyne"), &hall(round as f32 * 0.1)).expect("written");
        recorder.digest(stamp, round).expect("written");
    }
    recorder.finish().expect("closed");
    path
}

#[test]
fn person_walks_through_a_bag() {
    let folder = tempfile::tempdir().expect("a folder");
    let (output, rows) = replay(&bag(folder.path(), 3));
    assert_eq!((output.status.code(), rows.len()), (Some(0), 30), "{output:?}");
    let last = rows.last().expect("a row");
    assert_eq!(last["frame"], "sensor");
    let people = last["people"].as_array().expect("people");
    let walker = people.iter().find(|person| {
        let near = |key: &str, value: f64| (person[key].as_f64().unwrap_or(99.0) - value).abs() < 0.3;
        near("x_m", 3.0) && near("y_m", -2.0 + 1.2 * 3.0) && near("vy_mps", 1.2)
    });
    assert!(walker.is_some_and(|person| person["status"] == "confirmed"), "{people:?}");
    check_written(&folder.path().join("hall.mcap"), topics::CLOUD);
}

/// What was found is written beside what it was found in, and the report of it shows both.
fn check_written(source: &Path, cloud_or_scan: &str) {
    let written = source.with_extension("found.mcap");
    let output = floorguard(&["replay", text(source), "--record", text(&written)]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let file = std::fs::File::open(&written).expect("a recording");
    let messages: Vec<_> = Recording::new(file).collect::<Result<_, _>>().expect("readable to its end");
    let count = |topic: &str| messages.iter().filter(|message| &*message.topic == topic).count();
    let frames = count(cloud_or_scan);
    assert!(frames >= 30 && count(topics::PEOPLE) == frames && count(topics::ODOMETRY) == frames, "{frames}");
    assert!(count(topics::TF_STATIC) >= 1);
    let (_, again) = replay(&written);
    let everybody = |row: &Value| row["people"].as_array().is_some_and(|people| !people.is_empty());
    assert!(again.iter().filter(|row| everybody(row)).count() > 5, "found again in the recording");
    let output = floorguard(&["report", text(&written)]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let page = std::fs::read_to_string(written.with_extension("html")).expect("a report");
    assert!(page.contains(" followed</li>") && page.contains("<svg"), "no report");
    // The cylinder in the hall moves, but does not look like somebody; legs that walk are.
    assert_eq!(page.contains("<b>1</b>person followed"), cloud_or_scan == topics::SCAN);
    // Over its own source: refused before anything is lost.
    let size = std::fs::metadata(source).expect("a file").len();
    let output = floorguard(&["replay", text(source), "--record", text(source)]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    assert_eq!(std::fs::metadata(source).expect("still there").len(), size);
}

#[test]
fn legs_walk_through_a_laser_log() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("walk.clf");
    let mut log = String::from("# a comment\nPARAM robot_frontlaser_offset 0.0 nohost 0\n");
    for round in 0..60 {
        let at_s = f64::from(round) * 0.08;
        log.push_str(&format!("ODOM 0 0 0 0 0 0 {at_s} host {at_s}\nFLASER 361"));
        for beam in 0..361 {
            let angle = (f64::from(beam) * 0.5 - 90.0).to_radians();
            log.push_str(&format!(" {:.3}", walker_range_m(angle, at_s)));
        }
        log.push_str(&format!(" 0 0 0 0 0 0 {at_s} host {at_s}\n"));
    }
    std::fs::write(&path, &log).expect("written");
    let (output, rows) = replay(&path);
    assert_eq!((output.status.code(), rows.len()), (Some(0), 60), "{output:?}");
    let count = |key: &str, least: usize| {
        rows.iter().filter(|row| row[key].as_array().is_some_and(|found| found.len() >= least)).count()
    };
    // A wall far behind the legs does not hide them: measured 60, 48 and 60 with the committee of the robot's own stage.
    let found = [count("legs", 1), count("legs", 2), count("people", 1)];
    assert!(found[0] > 55 && found[1] > 45 && found[2] > 55, "{found:?}");
    check_written(&path, topics::SCAN);
    // It is known by its words, whatever it is called and however it is packed.
    let renamed = folder.path().join("walk.txt");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(log.as_bytes()).expect("memory");
    std::fs::write(&renamed, packed.finish().expect("memory")).expect("written");
    assert_eq!(replay(&renamed).1, rows);
    // A damaged line ends it with its number.
    std::fs::write(&path, log.replacen("FLASER 361", "FLASER 400", 1)).expect("written");
    let output_text = refusal(&path);
    assert!(output_text.contains("line 4") && output_text.contains("FLASER"), "{output_text}");
}

/// Two legs of 0.12 m, 0.3 m apart, in front of a wall at 8 m.
fn walker_range_m(angle: f64, at_s: f64) -> f64 {
    let swing = 0.2 * (at_s * 6.0).sin();
    let legs = [(1.2 - 0.15, -1.5 + 1.0 * at_s + swing), (1.2 + 0.15, -1.5 + 1.0 * at_s - swing)];
    let (sin, cos) = angle.sin_cos();
    let leg = |(x, y): (f64, f64)| {
        let (along, aside) = (x * cos + y * sin, (y * cos - x * sin).abs());
        (aside < 0.06).then(|| along - (0.06_f64.powi(2) - aside * aside).sqrt())
    };
    legs.into_iter().filter_map(leg).fold(8.0, f64::min)
}

/// A data packet of a VLP-16 whose blocks all look in one direction.
fn standing_packet() -> Vec<u8> {
    let block = [&[0xff, 0xee, 0x10, 0x27][..], &[0xf4, 0x01, 9].repeat(32)].concat();
    [block.repeat(12), vec![0; 4], vec![0x37, 0x22]].concat()
}

/// A frame of a capture with a datagram to the lidar's port.
fn captured(payload: &[u8]) -> Vec<u8> {
    captured_at(0, 2_368, payload)
}

/// A frame of a capture with a datagram to a port, at a time in microseconds.
pub(super) fn captured_at(time_us: u64, port: u16, payload: &[u8]) -> Vec<u8> {
    let length = |more: usize| ((payload.len() + more) as u16).to_be_bytes();
    let udp = [&port.to_be_bytes()[..], &port.to_be_bytes(), &length(8), &[0, 0], payload].concat();
    let ip =
        [&[0x45, 0][..], &length(28), &[0, 0, 0, 0, 64, 17, 0, 0], &[192, 168, 1, 201], &[255; 4]].concat();
    let frame = [vec![0xff; 12], vec![8, 0], ip, udp].concat();
    let size = (frame.len() as u32).to_le_bytes();
    let time = [(time_us / 1_000_000) as u32, (time_us % 1_000_000) as u32].map(u32::to_le_bytes).concat();
    [&time[..], &size, &size, &frame].concat()
}

/// The head of a capture of Ethernet.
pub(super) fn pcap_head() -> Vec<u8> {
    [&[0xd4, 0xc3, 0xb2, 0xa1, 2, 0, 4, 0][..], &[0; 8], &[0, 0, 1, 0, 1, 0, 0, 0]].concat()
}

/// A capture of 20 GB in less than a mebibyte: after its head nothing but empty packets, zeros in frames of zstd.
fn packed_mountain(head: &[u8]) -> Vec<u8> {
    let frame = |blocks: &[u8]| [&[0x28, 0xb5, 0x2f, 0xfd, 0x00, 0x38][..], blocks].concat();
    let raw_bytes = ((head.len() as u32) << 3 | 1).to_le_bytes();
    let (zeros, last) = ([0x02, 0x00, 0x10, 0], [0x03, 0x00, 0x10, 0]);
    let beginning = frame(&[&raw_bytes[..3], head].concat());
    [beginning, frame(&[&zeros.repeat(150_000)[..], &last].concat())].concat()
}

#[test]
fn non_data_is_refused_with_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("written");
        path
    };
    let mut words = Recorder::new(std::io::Cursor::new(Vec::new())).expect("memory");
    words.digest(Stamp::ZERO, 7).expect("memory");
    let words = words.finish().expect("memory").into_inner();
    let pcap = pcap_head();
    let standing = [pcap.clone(), captured(&standing_packet())].concat();
    let mountain = packed_mountain(&pcap);
    assert!(mountain.len() < 1 << 20, "{} bytes", mountain.len());
    let cases: [(&str, &[u8], &str); 12] = [
        // A lidar that does not turn: every packet is refused, and that is no empty hall.
        ("standing.pcap", &standing, "1 packet refused and none taken"),
        ("no.mcap", b"hello", "capture"),
        ("words.mcap", &words, "no PointCloud2 and no LaserScan"),
        ("cut.mcap", &words[..30], "cut"),
        ("empty.clf", b"", "no scan in it"),
        ("nothing.pcap", b"", "is empty"),
        ("mountain.pcap.zst", &mountain, "unpacks to more than 250 times its size"),
        ("run.bag", b"#ROSBAG V2.0\n and more", "rosbags-convert"),
        ("run.db3", b"SQLite format 3\0 and more", "ros2 bag convert"),
        ("packed.pcap.xz", b"\xfd7zXZ\0 and more", "unxz"),
        // A capture is one by its bytes, even by the name of a laser log.
        ("capture.log", &pcap, "no datagram to port 2368"),
        ("text.log", b"this is a text of some kind\n", "no scan in it"),
    ];
    for (name, bytes, reason) in cases {
        let output_text = refusal(&file(name, bytes));
        assert!(output_text.contains(reason) && output_text.contains(name), "{name}: {output_text}");
    }
    // A wrong topic: the right ones are listed, and nothing else.
    let bag = bag(folder.path(), 1);
    let wrong = floorguard(&["replay", text(&bag), "--topic", "/nowhere"]);
    let output_text = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert_eq!(wrong.status.code(), Some(3));
    assert!(
        output_text.contains("PointCloud2)") && !output_text.contains("/floorguard/digest"),
        "{output_text}"
    );
    // A pipe is read once only.
    for command in ["replay", "decode"] {
        let piped = Command::new("sh")
            .args(["-c", &format!("echo hello | {} {command} /dev/stdin", env!("CARGO_BIN_EXE_floorguard"))])
            .output()
            .expect("a shell");
        let output_text = String::from_utf8_lossy(&piped.stderr).into_owned();
        assert!(
            piped.status.code() == Some(3) && output_text.contains("write it to a file first"),
            "{output_text}"
        );
    }
    let output_text = refusal(&folder.path().join("nowhere.mcap"));
    assert!(output_text.contains("nowhere.mcap"), "{output_text}");
}

/// The hall of [`hall`] without people, seen by a lidar 1.61 m high that looks down by 6.7°: which returns are floor.
fn tilted_hall() -> (Vec<PointRow>, usize) {
    let (tilt_sin, tilt_cos) = 6.7_f32.to_radians().sin_cos();
    let (mut points, mut floor) = (Vec::new(), 0);
    for ring in 0..16_u16 {
        let (sin, cos) = (-15.0 + 2.0 * f32::from(ring)).to_radians().sin_cos();
        for column in 0..1_800_u16 {
            let (y, x) = (-f32::from(column) * 0.2_f32.to_radians()).sin_cos();
            let (forward, left, up) = (cos * x, cos * y, sin);
            // In axes that stand upright; the walls stand 9 m away.
            let ahead = tilt_cos * forward + tilt_sin * up;
            let rise = tilt_cos * up - tilt_sin * forward;
            let wall_m = 9.0 / ahead.hypot(left);
            let floor_m = if rise < 0.0 { -1.61 / rise } else { f32::INFINITY };
            floor += usize::from(floor_m < wall_m);
            let range_m = wall_m.min(floor_m);
            let position_m = [range_m * forward, range_m * left, range_m * up];
            points.push(PointRow { position_m, reflectivity: 20, ring, time_s: 0.0 });
        }
    }
    (points, floor)
}

/// A bag with its frame tree: the floor below a tilted lidar is found, and empty clouds are called so.
#[test]
fn floor_below_a_tilted_lidar_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tilted.mcap");
    let mut recorder = Recorder::new(std::fs::File::create(&path).expect("a file")).expect("written");
    let (sin, cos) = 6.7_f32.to_radians().sin_cos();
    let mounting = Transform3 {
        translation: Point3::new(0.0, 0.0, 1.61),
        rotation: [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]],
    };
    recorder.mounting(Stamp::from_micros(1_000_000), "velodyne", &mounting).expect("written");
    let (points, floor) = tilted_hall();
    for round in 0..3_u64 {
        let stamp = Stamp::from_micros(1_000_000 + round * 100_000);
        recorder.points(stamp, (stamp, "velodyne"), &points).expect("written");
        recorder.points(stamp, (stamp, "velodyne"), &[]).expect("written");
    }
    recorder.finish().expect("closed");
    let (output, rows) = replay(&path);
    assert_eq!((output.status.code(), rows.len()), (Some(0), 3), "{output:?}");
    let found = rows[2]["floor_points"].as_u64().expect("a count") as usize;
    assert!(found * 10 > floor * 9, "{found} of {floor} floor returns");
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(words.contains("3 empty scans or clouds") && !words.contains("damaged"), "{words}");
}

/// A log in which all scans bear one time is not healthy, and says so.
#[test]
fn a_log_without_times_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("still.clf");
    let scan = format!("FLASER 181{} 0 0 0 0 0 0 7.5 host 7.5\n", " 4.0".repeat(181));
    std::fs::write(&path, scan.repeat(5)).expect("written");
    let (output, rows) = replay(&path);
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(words.contains("all 5 scans bear one time"), "{words}");
    let frozen = rows.iter().filter(|row| row["health"] == "frozen").count();
    assert_eq!((rows.len(), frozen), (5, 4));
}
