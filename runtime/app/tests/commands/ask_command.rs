//! `floorguard learn` and `floorguard ask` as an operator meets them.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn floorguard(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floorguard")).args(arguments).output().unwrap()
}

fn stderr_text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn recording(path: &str) -> Option<PathBuf> {
    let full = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(path);
    if !full.exists() {
        eprintln!("skipped: {path} is absent");
    }
    full.exists().then_some(full)
}

/// One day of a room of 8 m × 4 m: from 08:00 to 18:00 somebody crosses its lower half every minute; a person by the
/// door in the corner stands there all day, and so shows that the room is watched.
fn day(folder: &Path) -> String {
    let mut text = String::from("time_s,id,x_m,y_m\n");
    for minute in 0..24 * 60 {
        let _infallible = writeln!(text, "{},0,7.9,3.9", minute * 60);
        if (8 * 60..18 * 60).contains(&minute) {
            for step in 0..12 {
                let _infallible = writeln!(
                    text,
                    "{},{},{:.1},1.0",
                    minute * 60 + step,
                    minute + 1,
                    0.2 + 0.6 * f64::from(step)
                );
            }
        }
    }
    let path = folder.join("day.csv");
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

fn ask(model: &str, question: &[&str]) -> Value {
    let arguments = [&["ask", "--model", model, "--json"], question].concat();
    let output = floorguard(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr_text(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn an_operator_learns_a_week_and_asks() {
    let folder = tempfile::tempdir().unwrap();
    let tracks = day(folder.path());
    let model = folder.path().join("room.model").display().to_string();
    for date in 6..13 {
        let start = format!("2026-04-{date:02}T00:00");
        let output =
            floorguard(&["learn", "--model", &model, &tracks, "--start", &start, "--timezone", "+02:00"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr_text(&output));
    }
    let at = |time: &'static str, rest: &[&'static str]| ask(&model, &[&["--now", time], rest].concat());
    let (noon, night) = ("2026-04-13T12:00", "2026-04-13T22:00");

    let best = at(noon, &["best-time", "--zone", "way=0,0,8,2", "--minutes", "60"]);
    let hour: u32 = best["details"]["start"].as_str().unwrap()[11..13].parse().unwrap();
    assert!(!(8..18).contains(&hour), "{best}");
    assert!(best["details"]["encounters_now"].as_f64().unwrap() > 30.0, "{best}");
    assert!(best["details"]["encounters"].as_f64().unwrap() < 5.0, "{best}");
    assert_eq!(best["confidence"], "fair");

    assert_eq!(at(noon, &["wet-or-dry", "--zone", "way=0,0,8,2"])["details"]["clean"], "dry");
    // Nobody came in seven nights of ten hours: 0 to 0.5 an hour, too few nights for a floor that stays wet.
    let rest = at(night, &["wet-or-dry", "--zone", "rest=0,2,6,4", "--threshold", "0.3"]);
    assert_eq!(rest["details"]["clean"], "wet", "{rest}");

    let people = at(noon, &["people", "--from", "12", "--to", "13"]);
    let places = people["details"]["places"].as_array().unwrap();
    assert_eq!(places.len(), 4, "{people}");
    for place in places {
        assert_eq!(place["y_m"], 1.0);
        assert!((place["visits_per_hour"].as_f64().unwrap() - 60.0).abs() < 3.0, "{place}");
    }
    assert!(
        at(noon, &["people", "--from", "20", "--to", "22"])["answer"].as_str().unwrap().starts_with("Nobody")
    );
    assert_eq!(at(noon, &["dirt"])["confidence"], "guess", "dirt was never measured");
    assert!(at(noon, &["best-zone"])["details"]["zones"].is_array());

    let output = floorguard(&["ask", "people", "--from", "12", "--to", "13", "--model", &model]);
    let words = String::from_utf8(output.stdout).unwrap();
    assert!(words.contains("between 12:00 and 13:00 on any day") && words.contains("how sure: "), "{words}");
}

#[test]
fn mistakes_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("m").display().to_string();
    let tracks = folder.path().join("t.csv").display().to_string();
    std::fs::write(&tracks, "time_s,id,x_m,y_m\n0,1,0,0\n1,1,1.5,0\n").unwrap();
    let refused = |arguments: &[&str], code: i32, word: &str| {
        let output = floorguard(arguments);
        assert_eq!(output.status.code(), Some(code), "{}", stderr_text(&output));
        assert!(stderr_text(&output).contains(word), "{}", stderr_text(&output));
    };
    refused(&["ask", "dirt", "--model", &model], 3, "floorguard learn");
    refused(&["learn", "--model", &model, &tracks], 3, "--start");
    refused(&["learn", "--model", &model], 3, "tracks or a map");
    refused(&["learn", "--model", &model, &tracks, "--start", "today"], 3, "today");
    refused(
        &["learn", "--model", &model, &tracks, "--start", "2026-04-06T08:00", "--timezone", "X/Y"],
        3,
        "X/Y",
    );
    refused(&["ask", "what"], 2, "what");
    let output = floorguard(&["learn", "--model", &model, &tracks, "--start", "2026-04-06T08:00"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr_text(&output));
    refused(
        &["learn", "--model", &model, &tracks, "--start", "2026-04-05T08:00"],
        3,
        "in the order of their time",
    );
    refused(&["ask", "best-time", "--zone", "Z9", "--model", &model], 3, "A1");
    refused(&["ask", "people", "--from", "13", "--to", "12", "--model", &model], 3, "from 13 to 12");
    std::fs::write(&model, "no model").unwrap();
    refused(&["ask", "dirt", "--model", &model], 3, "no environment model");
}

/// The key beside the recordings: 360, 118 and (of every second person) 152 people.
#[test]
fn real_recordings_become_models_and_pictures() {
    for (file, people, places) in [
        ("trajectories/eth_obsmat.txt.gz", 360, 30),
        ("trajectories/lcas_vlp16_people.ndjson.gz", 152, 30),
        ("trajectories/hermes_corridor2d_bo-360-050-050.txt.gz", 118, 10),
    ] {
        let Some(tracks) = recording(file) else { return };
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).display().to_string();
        let (model, picture) = (path("m"), path("m.png"));
        let tracks = tracks.display().to_string();
        let learn =
            ["learn", "--model", &model, &tracks, "--start", "2026-04-06T12:05", "--picture", &picture];
        let output = floorguard(&learn);
        assert_eq!(output.status.code(), Some(0), "{}", stderr_text(&output));
        assert!(stderr_text(&output).contains(&format!("{people} people")), "{}", stderr_text(&output));
        assert!(std::fs::metadata(&picture).unwrap().len() > 1_000);
        let answer = ask(&model, &["people", "--from", "12", "--to", "13"]);
        assert!(answer["details"]["places"].as_array().unwrap().len() >= places, "{file}: {answer}");
    }
}

/// One person who walks for 40 s, in the layouts that others write.
#[test]
fn tables_and_json_teach_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let (mut table, mut frames, mut json) = (
        String::from("scene_id,agent_id,frame_id,pos_x,pos_y,timestamp\n"),
        String::from("frame,id,x,y\n"),
        String::from("[\n"),
    );
    for step in 0..100 {
        let (seconds, x_m) = (0.4 * f64::from(step), 0.05 * f64::from(step));
        let _infallible = writeln!(table, "hall,3,{},{x_m},1.0,{seconds}", 10 * step);
        let _infallible = writeln!(frames, "{},3,{x_m},1.0", 10 * step);
        let comma = if step == 0 { "" } else { ",\n" };
        let _infallible = write!(json, "{comma}{{\"t\": {seconds}, \"id\": 3, \"x\": {x_m}, \"y\": 1.0}}");
    }
    json.push_str("\n]\n");
    let learned = |name: &str, text: &str, more: &[&str]| {
        let (tracks, model) = (folder.path().join(name), folder.path().join(format!("{name}.model")));
        std::fs::write(&tracks, text).unwrap();
        let (tracks, model) = (tracks.display().to_string(), model.display().to_string());
        let learn = ["learn", "--model", &model, &tracks, "--start", "2026-04-06T12:05"];
        let output = floorguard(&[&learn, more].concat());
        (output.status.code(), stderr_text(&output))
    };
    let summary = "1 people, 100 positions, 40 s";
    let opentraj = learned("opentraj.csv", &table, &[]);
    assert!(opentraj.0 == Some(0) && opentraj.1.contains(summary), "{opentraj:?}");
    let json = learned("tracks.json", &json, &[]);
    assert!(json.0 == Some(0) && json.1.contains(summary), "{json:?}");
    let (code, error) = learned("frames.csv", &frames, &[]);
    assert!(code == Some(3) && error.contains("give --rate"), "{code:?} {error}");
    let frames = learned("frames.csv", &frames, &["--rate", "25"]);
    assert!(frames.0 == Some(0) && frames.1.contains(summary), "{frames:?}");
}
