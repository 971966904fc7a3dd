//! The page "My robot in an hour": its sections typed into an empty file, its commands typed as a reader would, against the bytes of
//! simulated devices.

use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The page's run and its script are cut to this; arming and checking the watchdogs takes two seconds.
const SECONDS: &str = "14";
const SCRIPT: &str = "0.5,0,10";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn page() -> String {
    std::fs::read_to_string(root().join("docs/src/tutorial-my-robot.md")).expect("the page")
}

/// What stands between fences of this kind.
fn fenced<'a>(page: &'a str, kind: &str) -> Vec<&'a str> {
    let fences = page.split("```").skip(1).step_by(2);
    fences.filter_map(|block| block.strip_prefix(kind)?.strip_prefix('\n')).collect()
}

/// The words of the page's line that begins so, without its first; what stands in quotes is one word.
fn typed(page: &str, beginning: &str) -> Vec<String> {
    let line = page.lines().find(|line| line.starts_with(beginning)).expect("the page has the command");
    let parts = line.split('"').enumerate();
    let words = parts.flat_map(|(index, part)| match index % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect::<Vec<_>>(),
        _ => vec![part.to_owned()],
    });
    words.skip(1).collect()
}

fn replaced(mut words: Vec<String>, option: &str, value: &str) -> Vec<String> {
    let at = words.iter().position(|word| word == option).expect("the option is there");
    words[at + 1] = value.to_owned();
    words
}

fn floorguard(words: &[String], folder: &Path) -> (Output, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_floorguard")).args(words).current_dir(folder).output().unwrap();
    let shown = [output.stdout.as_slice(), output.stderr.as_slice()].concat();
    (output, String::from_utf8_lossy(&shown).into_owned())
}

/// From an empty file to the guard that stops the robot.
#[test]
fn guard_stops_the_robot_of_the_page() {
    let (page, folder) = (page(), tempfile::tempdir().unwrap());
    let file = folder.path().join("robot.toml");
    let check = typed(&page, "floorguard check");
    std::fs::write(&file, "").unwrap();
    let (refused, shown) = floorguard(&check, folder.path());
    assert!(!refused.status.success());
    for section in ["[robot]", "[limits]", "[scanner]", "[can]"] {
        let name = section.trim_matches(['[', ']']);
        assert!(shown.contains(&format!("`[{name}]`")) || shown.contains(section), "{section}: {shown}");
    }
    // Every section of the page, one below the other: read, and refused for what nobody sees.
    let mut text = with_metadata(&page, &fenced(&page, "toml").join("\n"));
    let uncertified = text.replace("accept_uncertified_mps", "# accept_uncertified_mps");
    std::fs::write(&file, uncertified).unwrap();
    let (refused, shown) = floorguard(&check, folder.path());
    assert!(!refused.status.success() && shown.contains("is no safety device"), "{shown}");
    std::fs::write(&file, &text).unwrap();
    let (refused, shown) = floorguard(&check, folder.path());
    assert!(!refused.status.success() && shown.contains("NOT ACCEPTED"), "{shown}");
    let gaps = shown.lines().filter_map(|line| line.trim().strip_prefix("NOT ACCEPTED "));
    let names: Vec<String> =
        gaps.map(|gap| format!("{:?}", gap.split(':').next().unwrap_or(gap).trim())).collect();
    text += &format!("\n[guard]\naccept_unseen = [{}]\n", names.join(", "));
    std::fs::write(&file, &text).unwrap();
    let (good, shown) = floorguard(&check, folder.path());
    assert!(good.status.success() && shown.contains("good"), "{shown}");
    assert!(shown.contains("does not brake") && shown.contains("inputs"), "{shown}");
    assert!(shown.contains("is no safety device") && shown.contains("it does not drive"), "{shown}");
    drive(&page, folder.path());
}

/// The lidar's section with the keys that the page's command writes from metadata.
fn with_metadata(page: &str, text: &str) -> String {
    let output = floorguard(&typed(page, "floorguard lidar-metadata"), &root());
    let (keys, shown) = (String::from_utf8_lossy(&output.0.stdout).into_owned(), output.1);
    assert!(keys.starts_with("[lidar]\n") && text.contains("[lidar]\n"), "{shown}");
    text.replace("[lidar]\n", &keys)
}

/// The page's two commands side by side.
fn drive(page: &str, folder: &Path) {
    let there = Command::new("python3").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        println!("skipped: python3 is absent");
        return;
    }
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let simulate = replaced(typed(page, "floorguard simulate"), "--duration", SECONDS);
    let simulate = replaced(simulate, "--command", &format!("udp:127.0.0.1:{port}"));
    let robot = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(&simulate)
        .current_dir(folder)
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let client = replaced(typed(page, "python3 examples"), "--script", SCRIPT);
    let client = replaced(client, "--to", &format!("127.0.0.1:{port}"));
    let client = Command::new("python3").args(&client).current_dir(root()).output().unwrap();
    let heard = String::from_utf8_lossy(&client.stdout).into_owned();
    let robot = robot.wait_with_output().unwrap();
    let shown = String::from_utf8_lossy(&robot.stderr).into_owned();
    assert_eq!(client.status.code(), Some(0), "{heard}{}{shown}", String::from_utf8_lossy(&client.stderr));
    let moved = |line: &str| line.contains("permitted") && !line.contains("permitted  0.00");
    assert!(heard.lines().any(moved), "it never drove: {heard}{shown}");
    assert!(heard.lines().any(|line| line.starts_with("slow") || line.starts_with("stop")), "{heard}{shown}");
    assert_eq!(robot.status.code(), Some(0), "the judge of the simulator: {shown}");
}
