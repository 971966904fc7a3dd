//! `floorguard map`, `localise` and `eval slam` as a stranger types them, on published logs and on our own recording.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use floorguard_mapping_host::metrics::{TimedPose, read_tum};
use floorguard_mapping_host::pose_graph::read_g2o;
use floorguard_recording::{MotionRow, Recorder};
use floorguard_robot::site::ros_map;
use floorguard_types::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;
use serde_json::Value;

use super::space_room::space_bag;

fn floorguard(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floorguard")).args(arguments).output().expect("the program starts")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a readable path")
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A file of the published laser logs, or a line that says what is skipped.
fn published(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/slam2d_logs").join(name);
    if path.exists() {
        return Some(path);
    }
    let _ = writeln!(std::io::stderr(), "skipped: slam2d_logs/{name} is absent");
    None
}

fn trajectory(path: &Path) -> Vec<TimedPose> {
    read_tum(&std::fs::read_to_string(path).expect("a trajectory")).expect("poses")
}

/// The ACES building, 22 minutes and 324 m: mapped, and judged by its published relations.
#[test]
fn published_log_becomes_a_map() {
    let Some(log) = published("radish_aces.clf.bz2") else { return };
    let Some(relations) = published("keys/radish_aces.relations") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("maps/aces");
    let output = floorguard(&["map", text(&log), "--out", text(&out), "--json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary: Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert_eq!((&summary["verdict"], &summary["not_later"]), (&Value::from("good"), &Value::from(0)));
    assert!(summary["odometry_drift_m"].as_f64().is_some_and(|drift_m| drift_m > 1.0), "{summary}");
    // Everything opens, and says the same.
    let map = ros_map::load(&out.join("map.yaml")).expect("a map of ROS");
    assert!(map.geometry().columns() > 300 && map.geometry().rows() > 300);
    let graph =
        read_g2o(&std::fs::read_to_string(out.join("graph.g2o")).expect("a graph")).expect("readable");
    assert_eq!(summary["kept_scans"], graph.poses.len());
    assert_eq!(summary["scans"], trajectory(&out.join("trajectory.tum")).len());
    let index = std::fs::read_to_string(out.join("submaps/index.txt")).expect("sub-maps");
    let submaps: Vec<&str> = index.lines().filter(|line| !line.starts_with('#')).collect();
    assert!(submaps.len() >= 20, "{index}");
    for line in submaps {
        let file = line.split(' ').next().expect("a file");
        assert!(ros_map::load(&out.join("submaps").join(file)).is_ok(), "{line}");
    }
    let picture = image::open(out.join("picture.png")).expect("a picture").into_rgb8();
    assert!(picture.pixels().any(|pixel| pixel.0 == [30, 100, 220]), "the path is drawn");
    assert!(std::fs::read_to_string(out.join("report.html")).expect("a page").contains("picture.png"));
    // Published: 0.0375 to 0.044 m. Measured here: 0.0345 m; odometry alone: 0.549 m.
    let judge = ["eval", "slam", "--relations", text(&relations), "--limit-m"];
    let result = out.join("trajectory.tum");
    let output = floorguard(&[judge.as_slice(), &["0.0375", text(&result), "--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let figures: Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert!(figures["relations"].as_u64().is_some_and(|count| count > 1_250), "{figures}");
    let output = floorguard(&[judge.as_slice(), &["0.001", text(&result)]].concat());
    assert_eq!(output.status.code(), Some(1), "no program is that good: {output:?}");
}

/// Against a map that others made, from the middle of a drive: the right place, and none in another building.
#[test]
fn place_is_found_or_not_known() {
    let Some(log) = published("radish_aces.clf.bz2") else { return };
    let Some(map) = published("keys/corrected_aces.map.yaml") else { return };
    let Some(other) = published("keys/corrected_fhw.map.yaml") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let found = folder.path().join("found.tum");
    let part = ["--from", "700", "--to", "740", "--json"];
    let arguments = [&["localise", text(&map), text(&log), "--out", text(&found)], part.as_slice()].concat();
    let output = floorguard(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let poses = trajectory(&found);
    // The published corrected log, whose clock is 70.18 s behind, has the robot here at 729.72 s.
    let (time_s, place) = (799.9, [-19.28_f64, 0.13_f64]);
    let near = poses.iter().min_by(|a, b| (a.time_s - time_s).abs().total_cmp(&(b.time_s - time_s).abs()));
    let near = near.expect("a pose");
    let away_m = (near.place_m.x - place[0]).hypot(near.place_m.y - place[1]);
    assert!(away_m < 0.15 && (near.flat().heading_rad - 1.63).abs() < 0.05, "{near:?}");
    let output = floorguard(&[&["localise", text(&other), text(&log)], part.as_slice()].concat());
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(words(&output).contains("I do not know"), "{output:?}");
    let last = String::from_utf8_lossy(&output.stdout).lines().last().map(str::to_owned);
    let last: Value = serde_json::from_str(&last.expect("a line")).expect("an object");
    assert_eq!(last["scans_found"], 0);
}

/// A square room of 6 × 4 m, seen by a scanner of 361 beams on a robot that drives along x.
fn room_log(scans: i32, speed_mps: f64) -> String {
    let mut log = String::new();
    for scan in 0..scans {
        let at_s = f64::from(scan) * 0.1;
        let x = -2.0 + speed_mps * at_s;
        log += "FLASER 361";
        for beam in 0..361 {
            let (sin, cos) = (f64::from(beam) * 0.5 - 90.0).to_radians().sin_cos();
            let along = if cos > 1e-9 { (3.0 - x) / cos } else { f64::INFINITY };
            log += &format!(" {:.3}", along.min(2.0 / sin.abs().max(1e-9)));
        }
        log += &format!(" {x:.4} 0 0 {x:.4} 0 0 {at_s:.2} host {at_s:.2}\n");
    }
    log
}

#[test]
fn wrong_usage_and_bad_input_have_their_codes() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, content: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).expect("written");
        path
    };
    let log = file("room.clf", &room_log(40, 0.5));
    let words_only = file("diary.txt", "words");
    let out = folder.path().join("map");
    let code = |arguments: &[&str]| floorguard(arguments).status.code();
    assert_eq!(code(&["map", text(&log)]), Some(2), "no folder");
    assert_eq!(code(&["map", text(&log), "--out", text(folder.path())]), Some(2), "files of others");
    assert!(words_only.exists());
    assert_eq!(code(&["map", text(&words_only), "--out", text(&out)]), Some(3));
    assert_eq!(code(&["map", text(&log), "--from", "99", "--out", text(&out)]), Some(3), "no scan there");
    assert_eq!(code(&["eval", "slam", text(&log)]), Some(2), "by what?");
    assert_eq!(code(&["eval", "slam", "--trajectory", text(&log), text(&log)]), Some(3));
    assert_eq!(code(&["localise", text(&words_only), text(&log)]), Some(3));
    assert!(!out.exists());
    assert_eq!(code(&["map", text(&log), "--out", text(&out)]), Some(0));
    // A damaged line: what came before is mapped, and the line is named.
    let cut = file("cut.clf", &(room_log(40, 0.5) + "FLASER 361 1.0 2.0\n"));
    let output = floorguard(&["map", text(&cut), "--out", text(&out)]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    assert!(words(&output).contains("line 41"), "{output:?}");
    // A scanner that repeats its first scan while the robot drives: the map is doubtful.
    let first = room_log(1, 0.0);
    let frozen = |line: &str, x: &str| line.replace(" -2.0000 0 0 -2.0000 0 0 0.00 host 0.00", x);
    let mut log = room_log(20, 0.5);
    for scan in 20..60 {
        let (x, at_s) = (-2.0 + 0.05 * f64::from(scan), 0.1 * f64::from(scan));
        log += &frozen(&first, &format!(" {x:.4} 0 0 {x:.4} 0 0 {at_s:.2} host {at_s:.2}"));
    }
    let output = floorguard(&["map", text(&file("frozen.clf", &log)), "--out", text(&out)]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(words(&output).contains("frozen"), "{output:?}");
}

/// The trajectory of a mapping against the truth of the room, with odometry and without.
#[test]
fn room_is_driven_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, truth) = (folder.path().join("room.clf"), folder.path().join("truth.tum"));
    std::fs::write(&log, room_log(80, 0.5)).expect("written");
    let line = |scan: i32| {
        format!("{:.2} {:.4} 0 0 0 0 0 1\n", 0.1 * f64::from(scan), -2.0 + 0.05 * f64::from(scan))
    };
    std::fs::write(&truth, (0..80).map(line).collect::<String>()).expect("written");
    for more in [&[][..], &["--without-odometry"]] {
        let out = folder.path().join("map");
        let output = floorguard(&[&["map", text(&log), "--out", text(&out)], more].concat());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let result = out.join("trajectory.tum");
        let judge = ["eval", "slam", "--limit-m", "0.01", "--trajectory", text(&truth), text(&result)];
        let output = floorguard(&judge);
        assert_eq!(output.status.code(), Some(0), "{more:?}: {output:?}");
    }
}

/// The same room as a bag: the scanner is mounted ahead and to the left of the robot's middle, and looks to its left.
fn room_bag(path: &Path, scans: u32) {
    let mut recorder = Recorder::new(std::fs::File::create(path).expect("a file")).expect("written");
    let rotation = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let mounting = Transform3 { translation: Point3::new(0.3, 0.1, 0.2), rotation };
    for index in 0..scans {
        let stamp = Stamp::from_micros(1_700_000_000_000_000 + u64::from(index) * 100_000);
        recorder.mounting(stamp, "scanner", &mounting).expect("written");
        let x_m = -2.0 + 0.05 * index as f32;
        let pose_in_odom = Pose2::new(x_m, 0.0, 0.0);
        let row = MotionRow { stamp, pose_in_odom, twist: Twist2::ZERO, covariance: [[0.0; 3]; 3] };
        recorder.motion(stamp, &row).expect("written");
        let mut scan = Scan { stamp, step_rad: 0.5_f32.to_radians(), ..Scan::default() };
        scan.first_angle_rad = -std::f32::consts::FRAC_PI_2;
        // Beam 0 looks ahead, the last one back.
        scan.beams.extend((0..361).map(|beam| {
            let (sin, cos) = (0.5 * beam as f32).to_radians().sin_cos();
            let along = if cos > 0.0 { 2.7 - x_m } else { 3.3 + x_m };
            BeamReturn::Hit((1_000.0 * (along / cos.abs().max(1e-6)).min(1.9 / sin.max(1e-6))) as u16)
        }));
        recorder.scan(stamp, &scan).expect("written");
    }
    recorder.finish().expect("closed");
}

#[test]
fn mounting_of_a_bag_is_used() {
    let folder = tempfile::tempdir().expect("a folder");
    let (bag, out) = (folder.path().join("room.mcap"), folder.path().join("map"));
    room_bag(&bag, 80);
    let truth = folder.path().join("truth.tum");
    let line = |scan: i32| {
        let (time_s, x) = (1.7e9 + 0.1 * f64::from(scan), -2.0 + 0.05 * f64::from(scan));
        format!("{time_s:.3} {x:.4} 0 0 0 0 0 1\n")
    };
    std::fs::write(&truth, (0..80).map(line).collect::<String>()).expect("written");
    let output = floorguard(&["map", text(&bag), "--out", text(&out)]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let result = out.join("trajectory.tum");
    let judge = ["eval", "slam", "--limit-m", "0.01", "--trajectory", text(&truth), text(&result)];
    assert_eq!(floorguard(&judge).status.code(), Some(0), "{:?}", floorguard(&judge));
    let first = trajectory(&result)[0];
    assert!((first.place_m.x + 2.0).abs() < 0.01 && first.place_m.y.abs() < 0.01, "the robot: {first:?}");
    let map = ros_map::load(&out.join("map.yaml")).expect("a map");
    let state =
        |x, y| map.geometry().cell_at(floorguard_types::geometry::Point2::new(x, y)).and_then(|c| map.get(c));
    assert_eq!(state(0.0, 1.0), Some(&floorguard_mapping::Occupancy::Free));
    assert!([1.98, 2.02].iter().any(|y| state(0.0, *y) == Some(&floorguard_mapping::Occupancy::Occupied)));
    let output = floorguard(&["map", text(&bag), "--topic", "/nothing", "--out", text(&out)]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    assert!(words(&output).contains("/scanner/scan"), "{output:?}");
}

/// A VLP-16 that stands in an office: it stays where it is, and its surfaces become a cloud that other programs read.
#[test]
fn standing_lidar_maps_its_office_in_space() {
    let capture = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data/vlp16_packets/einride_office_600rpm.pcap.gz");
    if !capture.exists() {
        let _ = writeln!(std::io::stderr(), "skipped: vlp16_packets is absent");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("office");
    let output = floorguard(&["map3d", text(&capture), "--out", text(&out), "--json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary: Value = serde_json::from_slice(&output.stdout).expect("one object");
    let number = |name: &str| summary[name].as_f64().expect("a number");
    // kiss-icp drifts by 0.2 to 1 cm here, small_gicp by 0.1 to 0.6 cm.
    assert!(number("displacement_m") < 0.0015 && number("turned_deg") < 0.02, "{summary}");
    assert_eq!((&summary["sweeps_blind"], &summary["packets"]), (&Value::from(0), &Value::from(1000)));
    let poses = trajectory(&out.join("trajectory.tum"));
    assert_eq!(summary["sweeps"], poses.len());
    assert!(poses.windows(2).all(|pair| (pair[1].time_s - pair[0].time_s - 0.1).abs() < 0.01));
    let cloud = std::fs::read(out.join("cloud.ply")).expect("a cloud");
    let header = String::from_utf8_lossy(&cloud[..300]).into_owned();
    assert!(header.contains(&format!("element vertex {}", summary["cloud_points"])), "{header}");
    assert!(std::fs::read(out.join("cloud.pcd")).expect("a cloud").starts_with(b"# .PCD v0.7"));
    // The same again gives the same bytes; what is no capture is bad input, a foreign folder wrong usage.
    let again = folder.path().join("again");
    assert_eq!(floorguard(&["map3d", text(&capture), "--out", text(&again)]).status.code(), Some(0));
    assert!(cloud == std::fs::read(again.join("cloud.ply")).expect("a cloud"));
    let words_only = folder.path().join("words.txt");
    std::fs::write(&words_only, "words").expect("written");
    let code = |arguments: &[&str]| floorguard(arguments).status.code();
    assert_eq!(code(&["map3d", text(&words_only), "--out", text(&out)]), Some(3));
    assert_eq!(code(&["map3d", text(&capture), "--out", text(folder.path())]), Some(2));
}

#[test]
fn recording_in_space_brings_wheels_and_gyroscope() {
    let folder = tempfile::tempdir().expect("a folder");
    let (bag, out) = (folder.path().join("room.mcap"), folder.path().join("map"));
    space_bag(&bag, 40);
    // The last sweep ends 4 s after the first began; the first pose is at its end.
    let way_m = 0.4 * 3.0;
    let cases = [
        (&[][..], [true, true], 0.005),
        (&["--lidar-alone", "--without-loops"][..], [false, false], 0.005),
        (&["--method", "lego-loam"][..], [false, false], 0.15),
    ];
    for (more, aids, limit_m) in cases {
        let arguments = [&["map3d", text(&bag), "--out", text(&out), "--json"], more].concat();
        let output = floorguard(&arguments);
        assert_eq!(output.status.code(), Some(0), "{more:?} {output:?}");
        let summary: Value = serde_json::from_slice(&output.stdout).expect("one object");
        assert_eq!([&summary["with_wheels"], &summary["with_gyroscope"]], aids.map(Value::from).each_ref());
        assert_eq!(summary["sweeps"], 40, "{summary}");
        let away_m = (summary["displacement_m"].as_f64().expect("a number") - way_m).abs();
        assert!(away_m < limit_m, "{more:?}: {summary}");
        assert!(std::fs::read(out.join("cloud.las")).expect("a cloud").starts_with(b"LASF"));
        let first = trajectory(&out.join("trajectory.tum"))[0];
        assert!((first.time_s - 1.7e9 - 0.1).abs() < 1e-3, "the clock of the recording: {first:?}");
    }
    let scans_only = folder.path().join("scans.mcap");
    room_bag(&scans_only, 3);
    let output = floorguard(&["map3d", text(&scans_only), "--out", text(&out)]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    assert!(words(&output).contains("/scanner/scan"), "{output:?}");
}

/// The walls of a corridor say nothing about the way along it, and people who walk there mislead: the lidar alone says so, and with the
/// wheels it is not needed.
#[test]
fn lidar_alone_doubts_a_smooth_corridor() {
    let folder = tempfile::tempdir().expect("a folder");
    let (recording, out) = (folder.path().join("drive.mcap"), folder.path().join("map"));
    let simulate = ["simulate", "--scenario", "corridor", "--seed", "3", "--duration", "35", "--record"];
    assert!(floorguard(&[&simulate, &[text(&recording)][..]].concat()).status.success());
    let verdict = |more: &[&str]| {
        let output =
            floorguard(&[&["map3d", text(&recording), "--out", text(&out), "--json"], more].concat());
        let summary: Value = serde_json::from_slice(&output.stdout).expect("one object");
        let held_m = summary["held_deviation_m"].as_f64().expect("metres");
        (output.status.code(), summary["verdict"].as_str().map(str::to_owned), held_m > 1.0)
    };
    assert_eq!(verdict(&["--lidar-alone"]), (Some(1), Some("doubtful".to_owned()), true));
    assert_eq!(verdict(&[]), (Some(0), Some("good".to_owned()), false));
}

/// A recording holds every fifth sweep as a cloud and the datagrams of all: all are mapped, and the lidar alone drives as far as the
/// robot did.
#[test]
fn own_recording_is_mapped_sweep_by_sweep() {
    let folder = tempfile::tempdir().expect("a folder");
    let (recording, out) = (folder.path().join("drive.mcap"), folder.path().join("map"));
    let simulate =
        ["simulate", "--scenario", "warehouse", "--seed", "2", "--duration", "8", "--json", "--record"];
    let output = floorguard(&[&simulate, &[text(&recording)][..]].concat());
    let verdict: Value = serde_json::from_slice(&output.stdout).expect("one object");
    let output = floorguard(&["map3d", text(&recording), "--out", text(&out), "--lidar-alone", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary: Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert!(summary["sweeps"].as_u64().is_some_and(|sweeps| (76..=80).contains(&sweeps)), "{summary}");
    let [driven_m, mapped_m] =
        [&verdict["distance_m"], &summary["path_m"]].map(|m| m.as_f64().expect("metres"));
    assert!(driven_m > 2.0 && (driven_m - mapped_m).abs() < 0.2, "{driven_m} m driven, {mapped_m} m mapped");
}
