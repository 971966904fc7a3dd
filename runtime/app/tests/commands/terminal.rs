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
    assert_eq!(child.wait().expect("ended").code(), Some(1), "not by the signal, and not finished");
    let verdict: Value = serde_json::from_str(&verdict).expect("one verdict");
    assert_eq!(verdict["verdict"], "not-finished");
    assert!(verdict["reason"].as_str().is_some_and(|why| why.contains("ended by somebody")), "{verdict}");
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

/// A value on the command line that cannot be is wrong usage, whatever the command.
#[test]
fn wrong_flag_values_end_with_two() {
    let robot = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robot.toml");
    let cases: [(&[&str], &str); 9] = [
        (&["demo", "--duration", "1e400"], "give seconds"),
        (&["simulate", "--scenario", "crossing", "--duration", "0"], "give seconds"),
        (&["run", robot, "--duration", "1e400"], "give seconds"),
        (&["simulate", "--scenario", "crossing", "--emergency-stop", "5..1e400"], "FROM..TO"),
        (&["simulate", "--scenario", "crossing", "--fault", "lidar:drop=200%"], "--fault"),
        (&["simulate", "--scenario", "crosing"], "did you mean `crossing`?"),
        (&["simulate", "--scenario", "crossing", "--until-clean"], "no dirt to clean"),
        (&["simulate", "--scenario", "crossing", "--panel", "8080"], "ADDRESS:PORT"),
        (&["mission", "--map", "plain", "--dirt", "random:5%:10-15", "--people", "100000"], "1000 people"),
    ];
    for (arguments, remedy) in cases {
        let output = run(arguments);
        let stderr_text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr_text}");
        assert!(stderr_text.contains(remedy), "{arguments:?}: {stderr_text}");
    }
}

/// A file in which nothing stands: what is missing, and nothing that was made up.
#[test]
fn empty_configuration_names_missing_sections() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("empty.toml");
    std::fs::write(&path, b"").expect("written");
    let output = run(&["check", text(&path)]);
    let stderr_text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{stderr_text}");
    assert!(stderr_text.contains("[can]") && !stderr_text.contains("[1, 1"), "{stderr_text}");
}

/// A file that is not there is named once, and so is the reason of a verdict.
#[test]
fn errors_are_printed_once() {
    let output = run(&["mission", "--map", "nowhere.yaml", "--dirt", "random:5%:10-15"]);
    let stderr_text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(
        (output.status.code(), stderr_text.matches("nowhere.yaml").count()),
        (Some(3), 1),
        "{stderr_text}"
    );
    let output = run(&["simulate", "--scenario", "supermarket", "--duration", "0.5"]);
    let stderr_text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(
        (output.status.code(), stderr_text.matches("never became ready").count()),
        (Some(1), 1),
        "{stderr_text}"
    );
}

/// What was asked for and not reached is not finished, and no success; what ran as asked is good.
#[test]
fn runs_end_with_their_verdict() {
    let verdict = |more: &[&str]| {
        let output = run(&[&["simulate", "--scenario", "supermarket", "--json"], more].concat());
        let verdict: Value = serde_json::from_slice(&output.stdout).expect("one verdict");
        (
            output.status.code(),
            verdict["verdict"].clone(),
            verdict["reason"].as_str().unwrap_or_default().to_owned(),
        )
    };
    let (code, value, reason) = verdict(&["--duration", "8"]);
    assert!(code == Some(0) && value == "good" && reason.contains("mission in progress: "), "{reason}");
    let (code, value, reason) = verdict(&["--duration", "8", "--until-clean"]);
    assert!(code == Some(1) && value == "not-finished" && reason.contains("has not ended"), "{reason}");
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
fn valid_configuration_lists_devices_and_gaps() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("unseen.svg");
    let output = run(&["check", &format!("{root}/robot.toml"), "--picture", text(&picture)]);
    let stderr_text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(stderr_text.contains("lidar VLP-16, scanner S300, 4 waypoints"), "{stderr_text}");
    assert!(stderr_text.contains("accepted rear below 0.45 m: touched at up to 0.25 m/s"), "{stderr_text}");
    assert_eq!(output.status.code(), Some(0), "{stderr_text}");
    let [drawn, in_book] =
        [picture, format!("{root}/docs/pictures/coverage.svg").into()].map(std::fs::read_to_string);
    assert!(
        drawn.is_ok_and(|drawn| in_book.is_ok_and(|in_book| drawn == in_book)),
        "floorguard check robot.toml --picture docs/pictures/coverage.svg draws the book's picture again"
    );
    let fewest = run(&["check", &format!("{root}/examples/fewest-holes.toml")]);
    assert_eq!(fewest.status.code(), Some(0), "{}", String::from_utf8_lossy(&fewest.stderr));
}

/// A gap that is not accepted: refused by `check` with 1 and by `run` with 3, with its name and the remedy; drawn and in the JSON.
#[test]
fn unaccepted_gap_is_refused_named_and_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, picture) = (folder.path().join("robot.toml"), folder.path().join("unseen.svg"));
    let kept = "  \"rear below 0.45 m\"";
    let example = floorguard_configuration::EXAMPLE;
    assert!(example.contains(kept));
    let slower = ("rear stepping in below 0.60 m\"", "rear stepping in below 0.60 m at 0.10 m/s\"");
    let example = example.replace(kept, "  # \"rear below 0.45 m\"").replace(slower.0, slower.1);
    std::fs::write(&path, example).expect("written");
    let output = run(&["check", text(&path), "--picture", text(&picture), "--json"]);
    let stderr_text = String::from_utf8_lossy(&output.stderr).into_owned();
    let refusal = "no sensor sees \"rear below 0.45 m\"";
    assert!(output.status.code() == Some(1) && stderr_text.contains(refusal), "{stderr_text}");
    let checked: Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert_eq!(
        (&checked["verdict"], checked["refusals"].as_array().map(Vec::len)),
        (&"failed".into(), Some(1))
    );
    let gaps = checked["gaps"].as_array().expect("gaps");
    let open: Vec<&Value> = gaps.iter().filter(|gap| gap["is_accepted"] == false).collect();
    assert!(gaps.len() > 8 && open.len() == 1 && open[0]["name"] == "rear below 0.45 m", "{checked}");
    let limits = checked["limits"].as_array().expect("limits");
    let reverse = limits.iter().find(|limit| limit["direction"] == "reverse").expect("reverse is slower");
    let [limit_mps, configured_mps] = ["limit_mps", "configured_mps"].map(|speed| reverse[speed].as_f64());
    assert!(limit_mps < configured_mps && limit_mps > Some(0.0), "{reverse}");
    assert_eq!(reverse["gap"], "rear stepping in below 0.60 m", "{reverse}");
    assert!(checked["unknown_rear"]["known_after_m"].as_f64() > Some(0.5), "{checked}");
    let drawn = std::fs::read_to_string(&picture).expect("a picture");
    assert!(
        drawn.contains("rear below 0.45 m")
            && drawn.matches("<rect").count() > 500
            && drawn.ends_with("</svg>\n")
    );
    let output = run(&["run", text(&path), "--duration", "1"]);
    let stderr_text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{stderr_text}");
    assert!(stderr_text.contains(refusal) && stderr_text.contains("accept_unseen"), "{stderr_text}");
}

/// Each command that can be typed has an example in its help, a man page, and completions.
#[test]
fn each_command_has_example_and_man_page() {
    let folder = tempfile::tempdir().expect("a folder");
    assert!(run(&["manual", "--out", text(folder.path())]).status.success());
    let program = <floorguard_app::commands::Arguments as clap::CommandFactory>::command();
    let mut waiting: Vec<(String, clap::Command)> = vec![("floorguard".to_owned(), program)];
    let mut seen = 0;
    while let Some((name, command)) = waiting.pop() {
        let page = folder.path().join(format!("{name}.1"));
        assert!(page.is_file(), "{}", page.display());
        let example = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        let is_group = command.has_subcommands() && name != "floorguard";
        assert!(is_group || example.contains("floorguard "), "{name}: {example}");
        seen += 1;
        let inner = command.get_subcommands();
        waiting.extend(inner.map(|sub| (format!("{name}-{}", sub.get_name()), sub.clone())));
    }
    assert!(seen > 25, "{seen}");
    let pages = std::fs::read_dir(folder.path()).expect("pages").filter_map(Result::ok);
    let pages =
        pages.filter(|file| file.path().extension().is_some_and(|extension| extension == "1")).count();
    assert_eq!(pages, seen, "a page for each command, and none for `help`");
    let completions = std::fs::read_to_string(folder.path().join("floorguard.bash")).expect("completions");
    assert!(completions.contains("--panel-records"));
}
