//! The program in a shell: ended by Ctrl-C, read by a pipe that closes, given what is nearly right.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use serde_json::Value;

fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_floorguard"));
    command.env_remove("FLOORGUARD_PANEL_TOKEN").stdin(Stdio::null());
    command
}

fn run(arguments: &[&str]) -> Output {
    program().args(arguments).output().expect("the program starts")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a readable path")
}

/// As a terminal does it.
fn interrupt(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.is_ok_and(|status| status.success()));
}

/// Everything that a run has to show until Ctrl-C: the verdict, a recording that is whole and repeats itself, a report.
fn ended_in_order(more: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let (recording, report) = (folder.path().join("run.mcap"), folder.path().join("report"));
    let mut child = program()
        .args([
            "simulate",
            "--scenario",
            "crossing",
            "--seed",
            "3",
            "--duration",
            "3000",
            "--json",
            "--record",
        ])
        .args([text(&recording), "--report", text(&report)])
        .args(more)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // Somebody who looks a while and has seen enough.
    while std::fs::metadata(&recording).map_or(0, |file| file.len()) < 6_000_000 {
        assert!(child.try_wait().expect("a child").is_none(), "it must not end by itself");
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    interrupt(&child);
    let mut stderr_text =
        BufReader::new(child.stderr.take().expect("its words")).lines().map_while(Result::ok);
    assert!(stderr_text.any(|line| line.contains("Ctrl-C")));
    let mut verdict = String::new();
    child.stdout.take().expect("its verdict").read_to_string(&mut verdict).expect("readable");
    assert!(child.wait().expect("ended").code().is_some(), "not by the signal");
    let verdict: Value = serde_json::from_str(&verdict).expect("one verdict");
    let duration_s = verdict["duration_s"].as_f64().expect("a duration");
    assert!((1.0..600.0).contains(&duration_s), "{verdict}");
    assert!(report.join("index.html").exists());
    let again = run(&["replay", text(&recording)]);
    let stdout_text = String::from_utf8_lossy(&again.stderr).into_owned();
    assert_eq!(again.status.code(), Some(0), "{stdout_text}");
    assert!(more.contains(&"--real-io") || stdout_text.contains("as recorded"), "{stdout_text}");
}

#[test]
fn ctrl_c_ends_a_run_with_its_results() {
    ended_in_order(&[]);
    ended_in_order(&["--strategy", "guarantee"]);
}

#[test]
fn ctrl_c_ends_a_run_in_real_time() {
    ended_in_order(&["--real-io"]);
}

#[test]
fn who_reads_enough_may_go() {
    let folder = tempfile::tempdir().expect("a folder");
    let recording = folder.path().join("run.mcap");
    let made =
        ["simulate", "--scenario", "crossing", "--duration", "4", "--json", "--record", text(&recording)];
    assert!(run(&made).status.success());
    let mut child = program()
        .args(["replay", text(&recording), "--topic", "/scanner/scan", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut first = String::new();
    BufReader::new(child.stdout.take().expect("rows")).read_line(&mut first).expect("a row");
    let output = child.wait_with_output().expect("ended");
    assert!(first.starts_with('{'), "{first}");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}

#[test]
fn nearly_right_input_is_refused_with_remedy() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("written");
        path
    };
    let cases = [
        (folder.path().to_owned(), "folder"),
        (file("one.bag", b"#ROSBAG V2.0\n"), "ROS 1"),
        (file("two.db3", b"SQLite format 3\0"), "ros2 bag convert"),
        (file("diary.txt", b"words"), ".mcap"),
    ];
    for (path, remedy) in cases {
        let output = run(&["replay", text(&path)]);
        let stdout_text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{stdout_text}");
        assert!(stdout_text.contains(text(&path)) && stdout_text.contains(remedy), "{stdout_text}");
    }
}

/// A folder that cannot be created is reported before the run, not after it; a run of nothing is no success.
#[test]
fn wrong_arguments_are_reported_at_once() {
    let late = ["simulate", "--scenario", "crossing", "--duration", "80000", "--report", "/proc/nowhere"];
    let output = run(&late);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("/proc/nowhere"));
    assert_eq!(run(&["campaign", "encounters", "--trials", "0"]).status.code(), Some(2));
}

#[test]
fn emergency_stop_behind_the_end_is_reported() {
    let run = |span: &str| {
        let output = run(&["simulate", "--scenario", "empty", "--duration", "0.5", "--emergency-stop", span]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        String::from_utf8_lossy(&output.stderr).contains("nobody presses it")
    };
    assert!(run("1..2") && !run("0.2..2"));
}

#[test]
fn interrupted_campaign_reports_partial_results() {
    let mut child = program()
        .args(["campaign", "single-faults", "--trials", "100000", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    std::thread::sleep(std::time::Duration::from_secs(2));
    interrupt(&child);
    let (mut stdout_text, mut stderr_text) = (String::new(), String::new());
    child.stdout.take().expect("a pipe").read_to_string(&mut stdout_text).expect("readable");
    child.stderr.take().expect("a pipe").read_to_string(&mut stderr_text).expect("readable");
    assert_eq!(child.wait().expect("a child").code(), Some(130), "{stderr_text}");
    let summary: Value = serde_json::from_str(&stdout_text).expect("one object");
    assert!(summary["runs"].as_u64().is_some_and(|runs| runs < 100_000), "{summary}");
    assert!(
        stderr_text.contains(&format!("interrupted after {} of 100000 runs", summary["runs"])),
        "{stderr_text}"
    );
}

#[test]
fn valid_configuration_lists_its_devices() {
    let robot = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robot.toml");
    let stderr_text = String::from_utf8_lossy(&run(&["check", robot]).stderr).into_owned();
    assert!(stderr_text.contains("lidar VLP-16, scanner S300, 4 waypoints"), "{stderr_text}");
}
