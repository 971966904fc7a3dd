//! `floorguard inspect`: recordings of every kind, as published, and what is wrong with them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn inspect(path: &Path, json: bool) -> Output {
    let path = path.to_str().expect("a readable path");
    let words: &[&str] = if json { &["inspect", path, "--json"] } else { &["inspect", path] };
    Command::new(env!("CARGO_BIN_EXE_floorguard")).args(words).output().expect("the program starts")
}

fn page(path: &Path) -> Value {
    let output = inspect(path, true);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    serde_json::from_slice(&output.stdout).expect("one object")
}

/// A recording of the shared data; without it a line says that the test was left out.
fn recording(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    if !path.exists() {
        eprintln!("skipped: {name} is not there");
    }
    path.exists().then_some(path)
}

#[test]
fn published_recordings_are_known_by_their_bytes() {
    for (name, kind, count, command) in [
        ("vlp16_packets/mrpt_gps_600rpm.pcap", "capture", None, "replay"),
        ("vlp16_packets/cu_vlp16_single_600rpm.pcap.gz", "capture", None, "replay"),
        ("slam2d_logs/radish_intel.clf.bz2", "laser log", None, "replay"),
        ("xsens_mti/1_output.bin", "Xsens MTi", Some(100), "decode"),
        ("can_canopen/navican_two_wheel_cia402_start.candump.txt", "candump", None, "decode"),
        ("can_canopen/ros_canopen_issue259_start.candump.txt", "candump", None, "decode"),
        ("vlp16_clouds/acfr_lab/pose01_full.pcd.gz", "point cloud", Some(23_969), "eval ground"),
        ("trajectories/eth_obsmat.txt.gz", "tracks of people", None, "learn"),
        ("trajectories/lcas_vlp16_people.ndjson.gz", "tracks of people", None, "learn"),
    ] {
        let Some(path) = recording(name) else { continue };
        let page = page(&path);
        assert!(page["kind"].as_str().expect("a kind").contains(kind), "{page}");
        assert!(page["streams"].as_array().is_some_and(|streams| !streams.is_empty()), "{page}");
        assert!(page["commands"].to_string().contains(command), "{page}");
        if let Some(count) = count {
            assert_eq!(page["streams"][0]["count"], count, "{page}");
        }
        let words = String::from_utf8(inspect(&path, false).stdout).expect("text");
        assert!(words.contains(kind) && words.lines().count() < 60, "{words}");
    }
}

#[test]
fn what_is_wrong_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("still.clf");
    let scan = format!("FLASER 181{} 0 0 0 0 0 0 7.5 host 7.5\n", " 4.0".repeat(181));
    std::fs::write(&path, scan.repeat(5)).expect("written");
    let page = page(&path);
    assert_eq!(page["streams"][0]["faults"][0], "all 5 bear one time", "{page}");
    std::fs::write(&path, "this is a text of some kind\n").expect("written");
    let output = inspect(&path, false);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("nothing that we know"), "{output:?}");
}

/// Rows of `decode` of what is no lidar capture: one for each sample of an MTi and each frame of a candump.
#[test]
fn samples_and_frames_become_rows() {
    let rows = |name: &str| {
        let path = recording(name)?;
        let words = ["decode", path.to_str().expect("a readable path"), "--csv"];
        let output =
            Command::new(env!("CARGO_BIN_EXE_floorguard")).args(words).output().expect("the program starts");
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let text = String::from_utf8(output.stdout).expect("text");
        Some(text.lines().map(str::to_owned).collect::<Vec<_>>())
    };
    for number in [1, 2] {
        let Some(rows) = rows(&format!("xsens_mti/{number}_output.bin")) else { continue };
        assert_eq!(rows.len(), 101, "a head and a hundred samples");
        assert!(rows[1..].iter().all(|row| row.split(',').count() == rows[0].split(',').count()));
    }
    let name = "can_canopen/ros_canopen_issue259_start.candump.txt";
    if let Some(rows) = rows(name) {
        assert_eq!(
            rows[1..4].join(" "),
            "0,000,network management,8203 14403,703,heartbeat,00 16868,083,emergency,B081010000000000"
        );
    }
}
