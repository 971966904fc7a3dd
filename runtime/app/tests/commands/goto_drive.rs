//! `floorguard goto` from its command line to its end, with simulated devices on the lines of a real robot: UDP,
//! pseudo-terminals, an SLCAN adapter. The operator resets and starts once a second, so that a computer that is too busy for the
//! devices delays the drive and does not end it.

use std::fs::File;
use std::io::{Read, Write};
use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use floorguard_host::carriers::PseudoTerminal;
use floorguard_sim::can::{SlcanDecoder, encode_slcan};
use floorguard_sim::{CanFrame, Payload, Scenario, Simulation, Stream, WireEvent};
use floorguard_types::geometry::Point2;

/// A hall of 8 m × 6 m; the map begins at its corner.
const HALL: &str = "title = \"a hall\"\nstart = { at_m = [2.0, 3.0], yaw_deg = 0.0 }\n\
    [route]\nspeed_mps = 0.5\nwaypoints_m = [[3.0, 3.0]]\n[scene]\nwall = [\n\
    { from_m = [0.2, 0.2], to_m = [7.8, 0.2] }, { from_m = [7.8, 0.2], to_m = [7.8, 5.8] },\n\
    { from_m = [7.8, 5.8], to_m = [0.2, 5.8] }, { from_m = [0.2, 5.8], to_m = [0.2, 0.2] }]\n";
/// Nothing waits for this: it ends a test that would never end.
const PATIENCE: Duration = Duration::from_secs(900);

/// The simulator's ends of the lines, and the operator's keyboard.
struct Devices {
    lidar: UdpSocket,
    scanner: File,
    imu: File,
    can: File,
    slcan: SlcanDecoder,
    keyboard: File,
}

/// What a pseudo-terminal is called, and the end that is held here.
fn line() -> (PathBuf, File) {
    let PseudoTerminal { near, device } = PseudoTerminal::open().unwrap();
    (device, File::from(near))
}

fn read_all(line: &mut File) -> Vec<u8> {
    let mut bytes = vec![0; 4_096];
    // Nothing there, or the other end is not open yet: no bytes.
    let count = line.read(&mut bytes).unwrap_or(0);
    bytes.truncate(count);
    bytes
}

impl Devices {
    fn deliver(&mut self, event: WireEvent) {
        // A line that is not read yet is full after a while, and refuses.
        let _ = match (event.stream, event.payload) {
            (Stream::LidarData, Payload::Bytes(bytes)) => self.lidar.send(&bytes).map(drop),
            (Stream::ScannerSerial, Payload::Bytes(bytes)) => self.scanner.write(&bytes).map(drop),
            (Stream::ImuSerial, Payload::Bytes(bytes)) => self.imu.write(&bytes).map(drop),
            (Stream::Can, Payload::Frame(frame)) => self.can.write(encode_slcan(&frame).as_bytes()).map(drop),
            _ => Ok(()),
        };
    }

    /// What the robot has sent.
    fn receive(&mut self) -> (Vec<CanFrame>, Vec<u8>) {
        let (frames, replies) = self.slcan.push(&read_all(&mut self.can));
        if !replies.is_empty() {
            let _ = self.can.write(&replies);
        }
        (frames, read_all(&mut self.imu))
    }
}

/// A robot.toml with the map of the hall, and the lines that it names.
fn robot(folder: &Path) -> (PathBuf, PathBuf, Devices) {
    let wall = |x: u32, y: u32| x < 4 || y < 4 || x >= 156 || y >= 116;
    let pixel = |x, y| image::Luma([if wall(x, y) { 0_u8 } else { 254 }]);
    image::GrayImage::from_fn(160, 120, pixel).save(folder.join("hall.png")).unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let [(scanner_line, scanner), (imu_line, imu), (can_line, can), (terminal, keyboard)] =
        [(); 4].map(|()| line());
    let text = floorguard_configuration::EXAMPLE
        .replace("udp:0.0.0.0:2368", &format!("udp:127.0.0.1:{port}"))
        .replace("/dev/ttyUSB0", &scanner_line.display().to_string())
        .replace("/dev/ttyUSB1", &imu_line.display().to_string())
        .replace("socketcan:can0", &format!("slcan:{}", can_line.display()));
    let section = "[navigation]\nmap = \"hall.png\"\nstart_x_m = 2.0\nstart_y_m = 3.0\n";
    let file = folder.join("robot.toml");
    std::fs::write(&file, format!("{text}\n{section}")).unwrap();
    let lidar = UdpSocket::bind("127.0.0.1:0").unwrap();
    lidar.connect(("127.0.0.1", port)).unwrap();
    (file, terminal, Devices { lidar, scanner, imu, can, slcan: SlcanDecoder::default(), keyboard })
}

fn last_line(stdout: &[u8]) -> serde_json::Value {
    let text = String::from_utf8_lossy(stdout);
    serde_json::from_str(text.lines().last().expect("lines")).expect("an object")
}

/// The robot stands truly at its goal when the program ends, and the last line says so.
#[test]
fn goto_ends_at_the_goal() {
    let folder = tempfile::tempdir().unwrap();
    let (file, terminal, mut devices) = robot(folder.path());
    let mut simulation = Simulation::new(&Scenario::from_toml(HALL).unwrap(), 1).unwrap();
    let output = folder.path().join("lines.json");
    let mut child = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(["goto", "3.0", "3.0", "0", &file.display().to_string(), "--json", "--duration", "800"])
        .stdin(File::options().read(true).write(true).open(&terminal).unwrap())
        .stdout(File::create(&output).unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let (began, mut next_key_s) = (Instant::now(), 1.0);
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        assert!(began.elapsed() < PATIENCE, "it never ends: {}", std::fs::read_to_string(&output).unwrap());
        let now_us = began.elapsed().as_micros() as u64;
        simulation.advance_to(now_us, &mut |event| devices.deliver(event));
        let (frames, imu) = devices.receive();
        frames.into_iter().for_each(|frame| simulation.receive_can(frame, now_us));
        simulation.receive(Stream::ImuSerial, &imu);
        if began.elapsed().as_secs_f64() > next_key_s {
            next_key_s += 1.0;
            devices.keyboard.write_all(b"r\ns\n").unwrap();
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    let lines = std::fs::read(&output).unwrap();
    let last = last_line(&lines);
    assert_eq!(status.code(), Some(0), "{}", String::from_utf8_lossy(&lines));
    assert_eq!((&last["type"], &last["reached"]), (&"goto".into(), &true.into()), "{last}");
    let (robot, _) = simulation.robot();
    let off_m = Point2::new(robot.x_m, robot.y_m).distance(Point2::new(3.0, 3.0));
    assert!(off_m < 0.4 && robot.heading_rad.abs() < 0.3, "{robot:?}");
    assert!(last["distance_m"].as_f64().is_some_and(|driven_m| driven_m > 0.5), "{last}");
}
