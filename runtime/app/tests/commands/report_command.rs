//! `floorguard report` as a stranger types it: one file that needs nothing else and names every stop.

use std::path::Path;
use std::process::{Command, Output};

use floorguard_operator::report::read_history;
use floorguard_recording::{MotionRow, PointRow, Recorder, Recording};
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::time::Stamp;
use serde_json::Value;

fn floorguard(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floorguard")).args(arguments).output().expect("the program starts")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a readable path")
}

#[test]
fn report_page_lists_each_stop() {
    let folder = tempfile::tempdir().expect("a folder");
    let (recording, page) = (folder.path().join("run.mcap"), folder.path().join("run.html"));
    let run = ["simulate", "--scenario", "supermarket", "--strategy", "route", "--duration", "24", "--json"];
    let output =
        floorguard(&[run.as_slice(), &["--emergency-stop", "15..17", "--record", text(&recording)]].concat());
    let verdict: Value = serde_json::from_slice(&output.stdout).expect("a verdict");
    let stops = verdict["stops"].as_u64().expect("a number");
    assert!(stops >= 2, "{verdict}");
    let proof = folder.path().join("run.pdf");
    let output = floorguard(&["report", text(&recording), "--pdf", text(&proof)]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let file = std::fs::read(&proof).expect("a PDF file");
    assert!(file.starts_with(b"%PDF-") && file.windows(22).any(|words| words == b"emergency stop pressed"));
    let html = std::fs::read_to_string(&page).expect("a page beside the recording");
    assert_eq!(html.matches("<div class=stop id=").count() as u64, stops);
    assert!(html.contains("emergency stop pressed") && html.contains("person would be reached"));
    // Nothing from elsewhere: no scripts, styles, pictures or fonts by address.
    let addresses: Vec<&str> =
        html.match_indices("://").map(|(at, _)| &html[at.saturating_sub(6)..at + 20]).collect();
    assert!(addresses.iter().all(|address| address.contains("://www.w3.org/2000")), "{addresses:?}");
    assert!(
        !html.contains("<script src") && !html.contains("<link") && html.len() < 1_000_000,
        "{}",
        html.len()
    );
    for part in [
        "Map, path and stops",
        "type=range",
        "Speed and limit",
        "Where people were",
        "Health of the sources",
        "Counters",
    ] {
        assert!(html.contains(part), "{part}");
    }
    // Cut: everything before it is shown, and the page says so.
    let bytes = std::fs::read(&recording).expect("the recording");
    std::fs::write(&recording, &bytes[..bytes.len() / 2]).expect("written");
    std::fs::remove_file(&page).expect("there");
    let output = floorguard(&["report", text(&recording)]);
    let output_text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "as replay: {output_text}");
    assert!(output_text.contains("is cut") && output_text.contains("report: "), "{output_text}");
    assert!(std::fs::read_to_string(&page).expect("a page").contains("Incomplete"));
}

/// A simulated run holds where the robot truly was, too, in another frame: a path through both would jump to and fro.
#[test]
fn path_is_that_of_the_wheels() {
    let folder = tempfile::tempdir().expect("a folder");
    let recording = folder.path().join("run.mcap");
    let run = ["simulate", "--scenario", "supermarket", "--strategy", "route", "--duration", "8", "--json"];
    let output = floorguard(&[run.as_slice(), &["--record", text(&recording)]].concat());
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    let file = std::io::BufReader::new(std::fs::File::open(&recording).expect("the recording"));
    let history = read_history(&mut Recording::new(file)).expect("messages");
    let begin = history.path.first().expect("a path");
    assert!(begin.x_m.hypot(begin.y_m) < 0.1, "the odometry begins at its origin: {begin:?}");
    let step = |pair: &[Pose2]| (pair[1].x_m - pair[0].x_m).hypot(pair[1].y_m - pair[0].y_m);
    let longest_m = history.path.windows(2).map(step).fold(0.0, f32::max);
    assert!(history.driven_m > 0.5 && longest_m < 0.6, "{} m, {longest_m} m", history.driven_m);
}

/// What each sensor saw, which rule decided, what would have happened otherwise: as data, and as a page of its own.
#[test]
fn stop_is_explained_as_data_and_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let (recording, page) = (folder.path().join("run.mcap"), folder.path().join("why.html"));
    let run = ["simulate", "--scenario", "supermarket", "--strategy", "route", "--duration", "24", "--json"];
    let more = ["--emergency-stop", "15..17", "--record", text(&recording)];
    let output = floorguard(&[run.as_slice(), &more].concat());
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    let asked = ["explain", text(&recording), "--at", "15.2", "--json", "--out", text(&page)];
    let output = floorguard(&asked);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let why: Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert!(why["at_s"].as_f64().is_some_and(|at_s| (15.0..15.5).contains(&at_s)), "{why}");
    assert_eq!(why["action"], "torque off (category 0)");
    assert!(why["decided_by"]["requirement"].as_str().is_some_and(|it| it.starts_with("FG-REQ-")), "{why}");
    assert!(why["decided_by"]["remedy"].as_str().is_some_and(|remedy| !remedy.is_empty()), "{why}");
    assert!(why["sources"].as_array().is_some_and(|sources| sources.len() > 5), "{why}");
    let before = why["before"].as_array().expect("rows");
    let (first, last) = (&before[0]["at_s"], &before[before.len() - 1]["at_s"]);
    let seconds = last.as_f64().expect("a time") - first.as_f64().expect("a time");
    assert!((9.0..=10.0).contains(&seconds) && before.len() > 15, "{before:?}");
    assert!(why["repetition"].as_str().is_some_and(|words| words.contains("to the bit")), "{why}");
    let html = std::fs::read_to_string(&page).expect("a page");
    assert!(html.contains("<svg") && html.contains("What each sensor saw") && html.contains("FG-REQ-"));
    assert!(!html.contains("<script") && !html.contains("<link") && html.len() < 300_000, "{}", html.len());
    let late = floorguard(&["explain", text(&recording), "--at", "500"]);
    assert_eq!(late.status.code(), Some(3), "{late:?}");
    assert!(String::from_utf8_lossy(&late.stderr).contains("is not in it"), "{late:?}");
}

/// A bit that the disk has lost within a chunk: everything before it is shown, and the place is named.
#[test]
fn damage_in_a_chunk_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let recording = folder.path().join("run.mcap");
    let run =
        ["simulate", "--scenario", "crossing", "--duration", "6", "--json", "--record", text(&recording)];
    assert!(floorguard(&run).status.success());
    let mut bytes = std::fs::read(&recording).expect("the recording");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x10;
    std::fs::write(&recording, &bytes).expect("written");
    for command in ["report", "replay"] {
        let output = floorguard(&[command, text(&recording)]);
        let output_text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{command}: {output_text}");
        assert!(
            output_text.contains("checksum") && output_text.contains("byte "),
            "{command}: {output_text}"
        );
    }
}

#[test]
fn what_is_no_recording_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("words.mcap");
    std::fs::write(&path, b"no recording").expect("written");
    for path in [path.as_path(), &folder.path().join("nowhere.mcap")] {
        let output = floorguard(&["report", text(path)]);
        assert_eq!(output.status.code(), Some(3), "{output:?}");
        assert!(String::from_utf8_lossy(&output.stderr).contains(text(path)));
    }
}

/// A capture has no scanner and no odometry, and still there is a map of it.
#[test]
fn a_cloud_alone_gives_a_map() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cloud.mcap");
    let file = std::fs::File::create(&path).expect("a file");
    let mut recorder = Recorder::new(file).expect("written");
    let wall = |index: u16| PointRow {
        position_m: [4.0, f32::from(index) * 0.01 - 5.0, 0.8],
        reflectivity: 9,
        ring: 4,
        time_s: 0.0,
    };
    let wall: Vec<PointRow> = (0..1_000).map(wall).collect();
    for round in 0..4 {
        let stamp = Stamp::from_micros(round * 600_000);
        let row = MotionRow {
            stamp,
            pose_in_odom: Pose2::default(),
            twist: Twist2::ZERO,
            covariance: [[0.0; 3]; 3],
        };
        recorder.motion(stamp, &row).expect("written");
        recorder.points(stamp, (stamp, "lidar"), &wall).expect("written");
    }
    recorder.finish().expect("closed");
    assert_eq!(floorguard(&["report", text(&path)]).status.code(), Some(0));
    let page = std::fs::read_to_string(path.with_extension("html")).expect("a page");
    // The wall as a dark column of cells.
    let dark = page.split("fill=\"#46525e\"").next().and_then(|before| before.rsplit("<path d=\"").next());
    assert!(dark.is_some_and(|path| path.matches('M').count() > 80), "{page}");
}
