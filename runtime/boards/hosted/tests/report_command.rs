//! `floorguard report` as a stranger types it: one file that needs nothing else and names every stop.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn floorguard(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floorguard")).args(arguments).output().expect("the program starts")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a readable path")
}

#[test]
fn a_run_with_stops_is_one_page_with_each_of_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let (recording, page) = (folder.path().join("run.mcap"), folder.path().join("run.html"));
    let run = ["simulate", "--scenario", "supermarket", "--seed", "1", "--duration", "24", "--json"];
    let output =
        floorguard(&[run.as_slice(), &["--emergency-stop", "15..17", "--record", text(&recording)]].concat());
    let verdict: Value = serde_json::from_slice(&output.stdout).expect("a verdict");
    let stops = verdict["stops"].as_u64().expect("a number");
    assert!(stops >= 2, "{verdict}");
    let output = floorguard(&["report", text(&recording)]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let html = std::fs::read_to_string(&page).expect("a page beside the recording");
    assert_eq!(html.matches("<div class=stop id=").count() as u64, stops);
    assert!(html.contains("emergency stop pressed") && html.contains("person would be reached"));
    // Nothing from elsewhere: no scripts, styles, pictures or fonts by address.
    let addresses: Vec<&str> =
        html.match_indices("://").map(|(at, _)| &html[at.saturating_sub(6)..at + 20]).collect();
    assert!(addresses.iter().all(|address| address.contains("://www.w3.org/2000")), "{addresses:?}");
    assert!(!html.contains("<script") && !html.contains("<link") && html.len() < 1_000_000, "{}", html.len());
    for part in
        ["Map, way and stops", "Speed and limit", "Where people were", "Health of the sources", "Counters"]
    {
        assert!(html.contains(part), "{part}");
    }
    // Cut: everything before it is shown, and the page says so.
    let bytes = std::fs::read(&recording).expect("the recording");
    std::fs::write(&recording, &bytes[..bytes.len() / 2]).expect("written");
    assert_eq!(floorguard(&["report", text(&recording)]).status.code(), Some(0));
    assert!(std::fs::read_to_string(&page).expect("a page").contains("Incomplete"));
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
