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

/// Text as delivered, then frames: what a capture of a VectorNav's start holds.
#[test]
fn vectornav_capture_becomes_rows() {
    use floorguard_sim::wire::{VectorNavSample, vectornav_frame, vectornav_sentence};
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("vn.bin");
    let frame = |step: u64| {
        let sample = VectorNavSample {
            since_start_ns: step * 10_000_000,
            rate_radps: [0.0, 0.0, -0.5],
            acceleration_mps2: [0.25, 0.0, -9.75],
            saturation: u16::from(step == 3) << 6,
        };
        vectornav_frame(&sample, 0x0121, 0x0800)
    };
    let sentences = ["VNASY,0", "VNRRG,01,VN-100S-CR", "VNASY,1"].into_iter().flat_map(vectornav_sentence);
    let bytes: Vec<u8> = sentences.chain((1..=50).flat_map(frame)).collect();
    std::fs::write(&path, bytes).expect("written");
    let page = page(&path);
    assert!(page["kind"].as_str().expect("a kind").contains("VectorNav"), "{page}");
    assert_eq!(
        (&page["streams"][0]["count"], &page["streams"][1]["count"]),
        (&50.into(), &3.into()),
        "{page}"
    );
    assert!(page["streams"][0]["faults"].to_string().contains("1 with a saturated axis"), "{page}");
    let words = ["decode", path.to_str().expect("a readable path"), "--csv"];
    let output = Command::new(env!("CARGO_BIN_EXE_floorguard")).args(words).output().expect("it starts");
    let text = String::from_utf8(output.stdout).expect("text");
    let rows: Vec<&str> = text.lines().collect();
    assert_eq!((rows.len(), rows[1]), (51, "10000,,0.25,0,-9.75,0,0,-0.5,,,,,0"));
    assert!(rows.iter().all(|row| row.split(',').count() == rows[0].split(',').count()));
}

/// A recording in which nobody can be looked for is called by its name, with the command that takes it.
#[test]
fn replay_names_what_it_cannot_play() {
    for (name, kind, command) in [
        ("can_canopen/navican_two_wheel_cia402_start.candump.txt", "candump", "floorguard decode --csv"),
        ("xsens_mti/1_output.bin", "Xsens MTi", "floorguard decode --csv"),
        ("trajectories/eth_obsmat.txt.gz", "tracks of people", "floorguard learn"),
        ("vlp16_clouds/acfr_lab/pose01_full.pcd.gz", "point cloud", "floorguard eval ground"),
    ] {
        let Some(path) = recording(name) else { continue };
        let replay = Command::new(env!("CARGO_BIN_EXE_floorguard")).arg("replay").arg(&path).output();
        let output = replay.expect("the program starts");
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{words}");
        assert!(words.contains(kind) && words.contains(command), "{words}");
    }
}

/// A lidar that is set to half a turn is silent for half of each: no gap, and no block with a fault.
#[test]
fn closed_sector_is_no_gap_in_a_capture() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("half.pcap");
    std::fs::write(&path, half_turns()).expect("written");
    let page = page(&path);
    assert!(page["streams"][0]["fields"].to_string().contains("a field of view is set"), "{page}");
    assert_eq!(page["streams"][0]["faults"].to_string(), "[]", "{page}");
}

/// A capture of ten turns of a VLP-16 at 600 turns a minute of which only the front half is sent.
fn half_turns() -> Vec<u8> {
    const BLOCK_NS: u64 = 110_592;
    let mut file = Vec::new();
    for word in [0xa1b2_c3d4_u32, 0x0004_0002, 0, 0, 65_535, 1] {
        file.extend(word.to_le_bytes());
    }
    let azimuth = |number: u64| number * BLOCK_NS % 100_000_000 * 36_000 / 100_000_000;
    let numbers = (0..1_000_000_000 / BLOCK_NS).filter(|number| !(9_000..27_000).contains(&azimuth(*number)));
    for blocks in numbers.collect::<Vec<u64>>().as_chunks::<12>().0 {
        let mut bytes = vec![0; 42];
        bytes[12..14].copy_from_slice(&[8, 0]);
        bytes[14] = 0x45;
        bytes[16..18].copy_from_slice(&1_234_u16.to_be_bytes());
        bytes[23] = 17;
        bytes[36..38].copy_from_slice(&2_368_u16.to_be_bytes());
        bytes[38..40].copy_from_slice(&1_214_u16.to_be_bytes());
        for number in blocks {
            bytes.extend([0xff, 0xee]);
            bytes.extend((azimuth(*number) as u16).to_le_bytes());
            (0..32).for_each(|_| bytes.extend([0xf4, 0x01, 50]));
        }
        bytes.extend(((blocks[0] * BLOCK_NS / 1_000) as u32).to_le_bytes());
        bytes.extend([0x37, 0x22]);
        let at_us = 5_000_000 + (blocks[11] + 1) * BLOCK_NS / 1_000;
        let length = bytes.len() as u32;
        for word in [(at_us / 1_000_000) as u32, (at_us % 1_000_000) as u32, length, length] {
            file.extend(word.to_le_bytes());
        }
        file.extend(bytes);
    }
    file
}
