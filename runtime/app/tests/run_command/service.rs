//! `floorguard run` as a service of systemd.

use std::net::UdpSocket;
use std::os::unix::net::UnixDatagram;
use std::process::{Command, Stdio};

use super::robot_file;

/// As systemd starts it: ready once, a heartbeat while the guard decides, and the end.
#[test]
fn service_manager_hears_the_guards_heartbeat() {
    let folder = tempfile::tempdir().unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let socket = folder.path().join("notify");
    let listener = UnixDatagram::bind(&socket).unwrap();
    let status = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(["run", &robot_file(folder.path(), port), "--duration", "1.3"])
        .env("NOTIFY_SOCKET", &socket)
        .stderr(Stdio::null())
        .status()
        .unwrap();
    assert!(status.success());
    listener.set_nonblocking(true).unwrap();
    let next = || {
        let mut buffer = [0; 256];
        let length = listener.recv(&mut buffer).ok()?;
        Some(String::from_utf8_lossy(&buffer[..length]).into_owned())
    };
    let messages: Vec<String> = std::iter::from_fn(next).collect();
    assert!(messages.first().is_some_and(|first| first.contains("READY=1")), "{messages:?}");
    assert!(messages.last().is_some_and(|last| last.contains("STOPPING=1")), "{messages:?}");
    let beats = messages.iter().filter(|message| message.contains("WATCHDOG=1")).count();
    assert!((2..=3).contains(&beats), "{messages:?}");
}
