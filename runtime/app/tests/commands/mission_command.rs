//! `floorguard mission` as a user meets it: invalid maps, invalid dirt, and Ctrl-C.

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn mission(folder: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_floorguard"));
    command.args(["mission", "--out"]).arg(folder.join("out")).args(more);
    command
}

fn stderr_text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A room of 3 x 2 m as a picture in the plain form of PGM: walls, floor, and what is not known.
fn write_room(folder: &Path, name: &str, (wall, floor): (u8, u8), lines: &str) -> String {
    let is_wall = |x: u32, y: u32| x < 2 || y < 2 || x >= 58 || y >= 38;
    let pixels = (0..40).flat_map(|y| (0..60).map(move |x| if is_wall(x, y) { wall } else { floor }));
    let pixels: Vec<String> = pixels.map(|pixel| pixel.to_string()).collect();
    std::fs::write(folder.join(format!("{name}.pgm")), format!("P2\n60 40\n255\n{}\n", pixels.join(" ")))
        .unwrap();
    let path = folder.join(format!("{name}.yaml"));
    let text = format!("image: {name}.pgm\nresolution: 0.05\norigin: [-10.0, -20.0, 0.0]\n");
    // A line of the same key replaces the usual one.
    let key = lines.split(':').next().unwrap_or("");
    let usual: String = text
        .lines()
        .filter(|line| !line.starts_with(key) || key.is_empty())
        .map(|l| format!("{l}\n"))
        .collect();
    std::fs::write(&path, format!("{usual}{lines}")).unwrap();
    path.display().to_string()
}

#[test]
fn every_map_mode_works_bad_ones_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = |map: &str, dirt: &str| {
        mission(folder, &["--map", map, "--dirt", dirt, "--trials", "1"]).output().unwrap()
    };
    let good = [
        ("plain", (0, 254), ""),
        ("raw", (100, 0), "mode: raw\n"),
        ("negated", (255, 0), "negate: 1\n"),
        ("turned", (0, 254), "origin: [-10.0, -20.0, 0.6]\n"),
        ("listed", (0, 254), "origin:\n- -10.0\n- -20.0\n- 0.0\n"),
    ];
    for (name, greys, lines) in good {
        let output = run(&write_room(folder, name, greys, lines), "random:1%:10-15");
        assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr_text(&output));
        assert!(stderr_text(&output).contains("falsely claimed 0 of"), "{name}: {}", stderr_text(&output));
    }
    let bad = [
        ("yes", (0, 254), "mode: best\n", "none of trinary, scale, raw"),
        ("coarse", (0, 254), "resolution: 50\n", "up to 0.5 m"),
        ("dark", (0, 0), "", "no free floor"),
        ("field", (254, 254), "", "no wall within 25 m of the floor"),
        ("gone", (0, 254), "image: elsewhere.pgm\n", "elsewhere.pgm"),
        ("nowhere", (0, 254), "origin: [nan, 0, 0]\n", "not a number"),
    ];
    for (name, greys, lines, reason) in bad {
        let output = run(&write_room(folder, name, greys, lines), "random:1%:10-15");
        assert_eq!(output.status.code(), Some(3), "{name}: {}", stderr_text(&output));
        assert!(stderr_text(&output).contains(reason), "{name}: {}", stderr_text(&output));
    }
    let dirt = folder.join("dirt.csv");
    std::fs::write(&dirt, "x_m,y_m,units\n-9.0,-19.2,12\n-9.0,nan,12\n").unwrap();
    let map = folder.join("plain.yaml").display().to_string();
    let output = run(&map, &dirt.display().to_string());
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr_text(&output).contains("dirt.csv:3: expected x_m,y_m,units"), "{}", stderr_text(&output));
    assert_eq!(run(&map, "random:5%:20-10").status.code(), Some(2));
}

/// Ctrl-C: finished missions are reported and count; before the first one is finished there is nothing to
/// report.
#[test]
fn an_interrupt_ends_the_missions_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let interrupt = |more: &[&str], until: &str| {
        let mut child =
            mission(folder.path(), more).stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let mut stderr_text = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        while !line.contains(until) {
            line.clear();
            assert!(stderr_text.read_line(&mut line).unwrap() > 0, "ended before it ran");
        }
        // The first missions take a moment.
        std::thread::sleep(std::time::Duration::from_millis(300));
        let identity = child.id().to_string();
        assert!(
            Command::new("sh").args(["-c", &format!("kill -INT {identity}")]).status().unwrap().success()
        );
        let mut rest = String::new();
        stderr_text.read_to_string(&mut rest).unwrap();
        (child.wait().unwrap().code(), rest)
    };
    let file = folder.path().join("kept").display().to_string();
    let long = ["--map", "supermarket", "--dirt", "random:5%:20-30", "--trials", "1", "--resume", &file];
    let (code, rest) = interrupt(&long, "can be reached");
    assert_eq!(code, Some(130), "{rest}");
    assert!(rest.contains("the same command goes on from"), "{rest}");
    assert!(Path::new(&file).is_file());
    let (code, rest) = interrupt(
        &[
            "--map",
            "supermarket",
            "--dirt",
            "random:5%:20-30",
            "--trials",
            "100000",
            "--strategy",
            "guarantee,systematic",
        ],
        "can be reached",
    );
    assert_eq!(code, Some(130), "{rest}");
    assert!(rest.contains("ended before the first mission was done"), "{rest}");
}

/// `--until-clean`: on a floor without dirt nothing is left to do at once, on virtual time and on the real clock.
#[test]
fn a_run_until_clean_ends_with_the_mission() {
    for more in [&[][..], &["--real-io"]] {
        let output = Command::new(env!("CARGO_BIN_EXE_floorguard"))
            .args(["simulate", "--scenario", "empty", "--strategy", "guarantee", "--duration", "30"])
            .args(["--until-clean", "--json"])
            .args(more)
            .output()
            .unwrap();
        let verdict: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let lasted_s = verdict["duration_s"].as_f64().unwrap();
        assert_eq!(output.status.code(), Some(0), "nothing was to be done: {}", stderr_text(&output));
        assert!(lasted_s < 10.0, "{more:?}: {lasted_s} s; {}", stderr_text(&output));
    }
}
