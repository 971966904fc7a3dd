//! Whatever is replayed goes through the robot's own stages, and comes out in rows of one form.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use floorguard_recording::{Recorder, Recording, octets_of};
use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::time::Stamp;
use serde_json::Value;

use super::replay_command::{bag, captured_at, floorguard, hall, pcap_head, replay, text};

/// A room of 12 m × 8 m; the scanner stands or drives along its middle. Pairs of legs by the places of their middles.
fn range_m(scanner_x: f64, angle: f64, pairs: &[(f64, f64)]) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let to_x = if cos > 0.0 { (11.0 - scanner_x) / cos } else { (-1.0 - scanner_x) / cos };
    let to_y = 4.0 / sin.abs().max(1.0e-9);
    let leg = |(x, y): (f64, f64)| {
        let (x, y) = (x - scanner_x, y);
        let (along, aside) = (x * cos + y * sin, (y * cos - x * sin).abs());
        (aside < 0.06 && along > 0.0).then(|| along - (0.06_f64.powi(2) - aside * aside).sqrt())
    };
    let legs = pairs.iter().flat_map(|(x, y)| [leg((*x, y - 0.14)), leg((*x, y + 0.14))]);
    legs.flatten().fold(to_x.min(to_y), f64::min)
}

/// A log of six seconds at 12.5 Hz: scans of the room with those pairs of legs at a time, the scanner at a speed.
fn log(path: &Path, speed_mps: f64, has_poses: bool, pairs: impl Fn(f64) -> Vec<(f64, f64)>) {
    let mut log = String::new();
    for round in 0..75 {
        let at_s = f64::from(round) * 0.08;
        let scanner_x = speed_mps * at_s;
        let ranges: Vec<String> = (0..361)
            .map(|beam| (f64::from(beam) * 0.5 - 90.0).to_radians())
            .map(|angle| format!("{:.3}", range_m(scanner_x, angle, &pairs(at_s))))
            .collect();
        let ranges = ranges.join(" ");
        let line = if has_poses {
            format!("FLASER 361 {ranges} {scanner_x} 0 0 {scanner_x} 0 0 {at_s} host {at_s}")
        } else {
            let step = 0.5_f64.to_radians();
            format!("RAWLASER1 0 -1.570796 3.141593 {step} 30 0.01 0 361 {ranges} 0 {at_s} host {at_s}")
        };
        writeln!(log, "{line}").expect("memory");
    }
    std::fs::write(path, log).expect("written");
}

fn people(row: &Value) -> &[Value] {
    row["people"].as_array().expect("people")
}

fn near(person: &Value, x_m: f64, y_m: f64) -> bool {
    let off = |key: &str, value: f64| (person[key].as_f64().unwrap_or(99.0) - value).abs() < 0.35;
    off("x_m", x_m) && off("y_m", y_m)
}

/// Somebody walks; beside stands a pair of legs that never walked, of a chair or of somebody who waits: it is shown, with
/// what explains it, and is no person.
#[test]
fn only_legs_that_walked_are_people() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("room.clf");
    log(&path, 0.0, true, |at_s| vec![(2.0, -2.0 + 0.7 * at_s), (3.0, -1.2)]);
    let (output, rows) = replay(&path);
    assert_eq!((output.status.code(), rows.len()), (Some(0), 75), "{output:?}");
    let last = &rows[74];
    let walker = people(last).iter().find(|person| near(person, 2.0, -2.0 + 0.7 * 5.92));
    assert!(walker.is_some_and(|person| person["is_person"] == true), "{last}");
    let standing: Vec<&Value> = people(last).iter().filter(|person| near(person, 3.0, -1.2)).collect();
    assert!(!standing.is_empty(), "{last}");
    for person in standing {
        assert_eq!(
            (&person["is_person"], &person["reason"]),
            (&false.into(), &"legs that never walked".into())
        );
    }
    for row in &rows {
        let ids: BTreeSet<u64> = people(row).iter().filter_map(|person| person["id"].as_u64()).collect();
        assert_eq!(ids.len(), people(row).len(), "an identity twice in {row}");
    }
}

/// A scanner without odometry drives behind a walker: by its scans it is known to drive, and the walker to walk, while the
/// legs of a table stand. Places are in the frame of the scanner.
#[test]
fn walker_before_a_driving_scanner_is_followed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("behind.clf");
    log(&path, 0.8, false, |at_s| vec![(1.5 + 0.8 * at_s, 0.1), (7.0, -1.5)]);
    let (output, rows) = replay(&path);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let late = &rows[40..];
    let followed = late.iter().filter(|row| {
        let mut found = people(row).iter().filter(|person| near(person, 1.5, 0.1));
        found.any(|person| person["is_person"] == true)
    });
    let followed = followed.count();
    assert!(followed * 10 >= late.len() * 8, "{followed} of {}", late.len());
    let table = late.iter().enumerate().filter(|(index, row)| {
        let x_m = 7.0 - 0.8 * 0.08 * (*index as f64 + 40.0);
        people(row).iter().any(|person| near(person, x_m, -1.5) && person["is_person"] == true)
    });
    assert_eq!(table.count(), 0, "the table walks");
    assert_eq!(rows[74]["frame"], "sensor");
}

/// The keys of a row, without those that only some recordings have.
fn keys(row: &Value) -> BTreeSet<String> {
    let sometimes = ["topic", "coverage_deg", "digest"];
    let all = row.as_object().expect("an object").keys();
    all.filter(|key| !sometimes.contains(&key.as_str())).cloned().collect()
}

#[test]
fn every_recording_gives_rows_of_one_form() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("room.clf");
    log(&path, 0.0, true, |at_s| vec![(2.0, -2.0 + 0.7 * at_s)]);
    let of_scan = keys(&replay(&path).1[60]);
    let of_cloud = keys(&replay(&bag(folder.path(), 1)).1[5]);
    assert_eq!(of_scan, of_cloud);
    // A lidar of 32 rings: sixteen of them go through the stages.
    let many = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data/vlp16_packets/NEG_hdl32e_monterey_200pkts.pcap");
    if !many.exists() {
        eprintln!("skipped: the recording of 32 rings is not there");
        return;
    }
    let (output, rows) = replay(&many);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let whole = rows.iter().max_by_key(|row| row["points"].as_u64()).expect("a row");
    assert!(keys(whole) == of_scan && whole["points"].as_u64() > Some(10_000), "{whole}");
    assert!(whole["floor_points"].as_u64() > Some(1_000), "{whole}");
}

/// The hall of the other tests, seen by a lidar that hangs upside down: who walks there is found in the same place.
#[test]
fn hanging_lidar_finds_the_same_walker() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hanging.mcap");
    let mut recorder = Recorder::new(std::fs::File::create(&path).expect("a file")).expect("written");
    let mounting = Transform3::from_mounting(Point3::new(0.0, 0.0, 0.8), std::f32::consts::PI, 0.0, 0.0);
    recorder.mounting(Stamp::from_micros(1_700_000_000_000_000), "velodyne", &mounting).expect("written");
    for round in 0..30_u64 {
        let stamp = Stamp::from_micros(1_700_000_000_000_000 + round * 100_000);
        let mut points = hall(round as f32 * 0.1);
        for point in &mut points {
            let [x_m, y_m, z_m] = point.position_m;
            (point.position_m, point.ring) = ([x_m, -y_m, -z_m], 15 - point.ring);
        }
        recorder.points(stamp, (stamp, "velodyne"), &points).expect("written");
    }
    recorder.finish().expect("closed");
    let (output, rows) = replay(&path);
    assert_eq!((output.status.code(), rows.len()), (Some(0), 30), "{output:?}");
    let upright = replay(&bag(folder.path(), 3)).1;
    let [hanging, upright] = [&rows[29], &upright[29]];
    let floor = |row: &Value| row["floor_points"].as_f64().unwrap_or(0.0);
    assert!((floor(hanging) / floor(upright) - 1.0).abs() < 0.05, "{hanging} {upright}");
    for row in [hanging, upright] {
        let walker = people(row).iter().find(|person| near(person, 3.0, 1.6));
        assert!(walker.is_some_and(|person| person["status"] == "confirmed"), "{row}");
    }
}

/// Datagrams of a simulated microScan3, as a capture.
fn scanner_capture(folder: &Path) -> PathBuf {
    let run = folder.join("run.mcap");
    let words =
        ["simulate", "--scenario", "crossing", "--duration", "3", "--scanner", "microscan3", "--record"];
    floorguard(&[&words[..], &[text(&run)]].concat());
    let mut capture = pcap_head();
    for message in Recording::new(std::fs::File::open(&run).expect("a recording")).flatten() {
        if &*message.topic == "/raw/scanner" {
            let payload = octets_of(&message.data).expect("bytes");
            capture.extend(captured_at(1_000_000 + message.at.as_micros(), 6_060, payload));
        }
    }
    let path = folder.join("scanner.pcap");
    std::fs::write(&path, capture).expect("written");
    path
}

#[test]
fn datagrams_of_a_scanner_are_replayed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scanner_capture(folder.path());
    let (output, rows) = replay(&path);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(rows.len() > 50, "{} scans", rows.len());
    assert!(rows.iter().all(|row| row["sensor"] == "scanner" && row["health"] == "healthy"), "{:?}", rows[0]);
    let page = floorguard(&["inspect", text(&path)]);
    let words = String::from_utf8_lossy(&page.stdout).into_owned();
    assert!(words.contains("microScan3 data") && words.contains("floorguard replay"), "{words}");
}
