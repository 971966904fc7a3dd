//! `floorguard tape`: the packets of a capture, for the emulated board.

use std::path::Path;

use floorguard_runtime::tape::{TapeLine, TapeReader};
use serde_json::Value;

use super::replay_command::{floorguard, text};

/// The packets reach the robot as they were recorded, and twice give the same fingerprint.
#[test]
fn capture_becomes_a_tape() {
    let capture =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/vlp16_packets/mrpt_gps_600rpm.pcap");
    if !capture.exists() {
        eprintln!("skipped: the recording is not there");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("puck.tape");
    let write = || -> Value {
        let output = floorguard(&["tape", text(&capture), "--out", text(&tape)]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        serde_json::from_slice(&output.stdout).expect("one object")
    };
    let first = write();
    assert_eq!(first, write());
    let bytes = std::fs::read(&tape).expect("a tape");
    let records: Vec<_> = TapeReader::new(&bytes).expect("a tape").collect();
    let packets =
        records.iter().filter(|record| record.line == TapeLine::Lidar && record.data.len() == 1_206);
    assert_eq!(packets.count() as u64, first["packets"].as_u64().expect("a count"));
    for line in [TapeLine::Scanner, TapeLine::Imu, TapeLine::Can] {
        assert!(records.iter().any(|record| record.line == line), "{line:?}");
    }
    let wrong = folder.path().join("words.pcap");
    std::fs::write(&wrong, "no capture").expect("written");
    let output = floorguard(&["tape", text(&wrong), "--out", text(&tape)]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
}
