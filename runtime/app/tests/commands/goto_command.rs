//! `floorguard goto` without devices: what it says and how it ends.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A robot.toml with the map of a hall of 8 m × 6 m, and devices that are not there.
fn robot(folder: &Path) -> PathBuf {
    let wall = |x: u32, y: u32| x < 4 || y < 4 || x >= 156 || y >= 116;
    let pixel = |x, y| image::Luma([if wall(x, y) { 0_u8 } else { 254 }]);
    image::GrayImage::from_fn(160, 120, pixel).save(folder.join("hall.png")).unwrap();
    let devices = folder.display();
    let text = floorguard_configuration::EXAMPLE
        .replace("udp:0.0.0.0:2368", "udp:127.0.0.1:0")
        .replace("/dev/tty", &format!("{devices}/tty"))
        .replace("socketcan:can0", &format!("slcan:{devices}/ttyACM0"));
    let section = "[navigation]\nmap = \"hall.png\"\nstart_x_m = 2.0\nstart_y_m = 3.0\n";
    let file = folder.join("robot.toml");
    std::fs::write(&file, format!("{text}\n{section}")).unwrap();
    file
}

/// Without devices the robot stands, and the goal is not reached: 1 and the reason. Without [navigation] nothing begins: 3.
#[test]
fn goto_says_why_it_did_not_arrive() {
    let folder = tempfile::tempdir().unwrap();
    let file = robot(folder.path());
    let goto = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_floorguard"));
        command
            .args(["goto", "3.0", "3.0", "0", &file.display().to_string()])
            .args(more)
            .stdin(Stdio::null());
        let output = command.output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, stderr_text) = goto(&["--duration", "0.5"]);
    assert_eq!(code, Some(1), "{stderr_text}");
    assert!(stderr_text.contains("the drive never began"), "{stderr_text}");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.split("[navigation]").next().unwrap()).unwrap();
    let (code, stderr_text) = goto(&["--duration", "0.5"]);
    assert_eq!(code, Some(3), "{stderr_text}");
    assert!(stderr_text.contains("write [navigation] with map"), "{stderr_text}");
}
