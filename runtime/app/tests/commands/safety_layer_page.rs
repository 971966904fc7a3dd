//! The page "The guard under your navigation in an hour": its two commands typed side by side, as a reader would; and the
//! test vectors of the velocity link as the reference encoder makes them.

use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The page's run and its script are cut to this; the robot needs two seconds to become ready.
const SECONDS: &str = "7";
const SCRIPT: &str = "0.5,0,2";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn has_python() -> bool {
    let there = Command::new("python3").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        println!("skipped: python3 is absent");
    }
    there
}

/// The words of the first line of the page that begins so; what stands in quotes is one word.
fn typed(page: &str, beginning: &str) -> Vec<String> {
    let line = page.lines().find(|line| line.starts_with(beginning)).expect("the page has the command");
    let parts = line.split('"').enumerate();
    let words = parts.flat_map(|(index, part)| match index % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect::<Vec<_>>(),
        _ => vec![part.to_owned()],
    });
    words.skip(1).collect()
}

/// The same with another value behind an option.
fn replaced(mut words: Vec<String>, option: &str, value: &str) -> Vec<String> {
    let at = words.iter().position(|word| word == option).expect("the option is there");
    words[at + 1] = value.to_owned();
    words
}

#[test]
fn client_of_the_page_drives_the_robot() {
    if !has_python() {
        return;
    }
    let page = read("docs/src/tutorial-safety-layer.md");
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let simulate = replaced(typed(&page, "floorguard simulate"), "--duration", SECONDS);
    let simulate = replaced(simulate, "--command", &format!("udp:127.0.0.1:{port}"));
    let robot = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(&simulate)
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let client = replaced(typed(&page, "python3 examples"), "--script", SCRIPT);
    let client = replaced(client, "--to", &format!("127.0.0.1:{port}"));
    let client = Command::new("python3").args(&client).current_dir(root()).output().unwrap();
    let heard = String::from_utf8_lossy(&client.stdout).into_owned();
    let robot = robot.wait_with_output().unwrap();
    let shown = String::from_utf8_lossy(&robot.stderr).into_owned();
    assert_eq!(client.status.code(), Some(0), "{heard}{}{shown}", String::from_utf8_lossy(&client.stderr));
    assert!(shown.contains(&format!("waits for velocities at udp:127.0.0.1:{port}")), "{shown}");
    assert!(heard.contains("run ") || heard.contains("slow "), "{heard}");
    assert!(
        heard.lines().any(|line| line.contains("permitted") && !line.contains("permitted  0.00")),
        "{heard}"
    );
    assert_eq!(robot.status.code(), Some(0), "the judge of the simulator: {shown}");
}

#[test]
fn book_has_vectors_of_the_reference_encoder() {
    if !has_python() {
        return;
    }
    let encoder =
        Command::new("python3").arg(root().join("tests/velocity_link/reference.py")).output().unwrap();
    let made = String::from_utf8(encoder.stdout).unwrap();
    assert_eq!(made.lines().count(), 7, "{made}");
    let chapter = read("docs/src/wire-formats/velocity-link.md");
    let vectors = chapter.split("## Test vectors").nth(1).expect("the chapter has vectors");
    assert!(vectors.contains(&made), "docs/src/wire-formats/velocity-link.md is old: {made}");
}
