//! `floorguard run` as a user meets it: devices that are not there yet, and a port that is taken.

mod camera;
mod service;

use std::io::{BufRead as _, BufReader, Read as _};
use std::net::UdpSocket;
use std::process::{Child, ChildStderr, Command, Stdio};

use floorguard_configuration::load;
use floorguard_host::executor::StopFlag;
use floorguard_perception::floor::Plane;
use floorguard_recording::{Recording, topics};
use floorguard_robot::assembly::new_shared;
use floorguard_robot::assembly::{HostedShared, Links, run_rings};
use floorguard_robot::camera::{DepthPicture, FloorMounting, PictureCamera, PictureFolder};
use floorguard_runtime::clock;
use floorguard_sim::floor::{DirtKind, FloorCamera, FloorKind, FloorScene, PictureMoment, Spill};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::{ImageSize, PinholeCamera};
use floorguard_types::time::Stamp;

/// The robot's file with devices that are not there: it waits for them, says so, stands, and ends in order.
#[test]
fn missing_devices_are_named_and_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let file = robot_file(folder.path(), port);
    let model = folder.path().join("m").display().to_string();
    let record = folder.path().join("run.mcap");
    let output = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(["run", &file, "--duration", "1.5", "--json", "--learn", &model, "--panel", "127.0.0.1:0"])
        .arg("--record")
        .arg(&record)
        .env_remove("FLOORGUARD_PANEL_TOKEN")
        .output()
        .unwrap();
    let (stderr_text, stdout_text) =
        (String::from_utf8(output.stderr).unwrap(), String::from_utf8(output.stdout).unwrap());
    assert_eq!(output.status.code(), Some(0), "{stderr_text}");
    for source in ["safety scanner", "inertial sensor", "CAN bus"] {
        assert!(stderr_text.contains(&format!("{source}: not there yet")), "{stderr_text}");
    }
    assert!(
        stdout_text.contains("\"lidar\":\"absent\"") && stdout_text.contains("\"drive\":\"faulty\""),
        "{stdout_text}"
    );
    assert!(stdout_text.contains("\"limit_mps\":0.0"), "{stdout_text}");
    the_recording_tells(&record);
    // Without a scanner nothing was watched: nothing is known of the place, and the file says so.
    let asked =
        Command::new(env!("CARGO_BIN_EXE_floorguard")).args(["ask", "people", "--model", &model]).output();
    assert!(String::from_utf8(asked.unwrap().stdout).unwrap().starts_with("I do not know"));
}

/// Nothing came, and that is what the recording says; it can be replayed.
fn the_recording_tells(record: &std::path::Path) {
    let file = std::fs::File::open(record).unwrap();
    let messages: Vec<_> = Recording::new(file).collect::<Result<_, _>>().unwrap();
    let count = |topic: &str| messages.iter().filter(|message| &*message.topic == topic).count();
    assert!(count(topics::PERMITTED) > 5 && count(topics::DIAGNOSTICS) > 1, "{}", messages.len());
    assert_eq!(count("/raw/lidar"), 0);
    let output = Command::new(env!("CARGO_BIN_EXE_floorguard")).arg("replay").arg(record).output().unwrap();
    let stderr_text = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && stderr_text.contains("as recorded, to the bit"), "{stderr_text}");
}

/// Its messages, from when it waits for its devices.
fn once_it_runs(child: &mut Child) -> BufReader<ChildStderr> {
    let mut stderr_text = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("not there yet") {
        line.clear();
        assert!(stderr_text.read_line(&mut line).unwrap() > 0, "ended before it ran");
    }
    stderr_text
}

/// What systemd sends ends a run as Ctrl-C does: the robot is brought to a stand, and the recording has its end.
#[test]
fn a_term_ends_the_run_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let (file, record) = (robot_file(folder.path(), port), folder.path().join("run.mcap"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(["run", &file, "--duration", "60", "--record"])
        .arg(&record)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stderr_text = once_it_runs(&mut child);
    let identity = child.id().to_string();
    assert!(Command::new("sh").args(["-c", &format!("kill -TERM {identity}")]).status().unwrap().success());
    let mut rest = String::new();
    stderr_text.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0), "{rest}");
    assert!(rest.contains("the robot stands"), "{rest}");
    let messages: Result<Vec<_>, _> = Recording::new(std::fs::File::open(&record).unwrap()).collect();
    assert!(messages.is_ok_and(|messages| !messages.is_empty()));
}

/// A connection that is lost ends a run in order, too, unless it was started to outlive it, as `nohup` does.
#[test]
fn lost_connection_respects_nohup() {
    for (started, outlives) in [("", false), ("trap '' HUP; ", true)] {
        let folder = tempfile::tempdir().unwrap();
        let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let file = robot_file(folder.path(), port);
        let program = env!("CARGO_BIN_EXE_floorguard");
        // The test process may outlive a connection, too, and what is ignored is inherited.
        let mut child = Command::new("env")
            .args(["--default-signal=HUP", "sh", "-c"])
            .arg(format!("{started}exec {program} run {file} --duration 60"))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stderr_text = once_it_runs(&mut child);
        let id = child.id();
        let signal = |name: &str| {
            let kill = format!("kill -{name} {id}");
            Command::new("sh").args(["-c", &kill]).status().unwrap().success()
        };
        assert!(signal("HUP"));
        let mut is_there_after = |waited: std::time::Duration| {
            std::thread::sleep(waited);
            child.try_wait().unwrap().is_none()
        };
        // One that ends may take its time beside other tests; one that stays is asked once.
        let second = std::time::Duration::from_secs(1);
        let is_there = is_there_after(second) && (outlives || (0..20).all(|_| is_there_after(second)));
        signal("TERM");
        let mut rest = String::new();
        stderr_text.read_to_string(&mut rest).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(0), "{rest}");
        assert_eq!(is_there, outlives, "{started}: {rest}");
    }
}

/// Closed log outputs, a recording on a full disk: reported where an output is left, and the robot goes on.
#[test]
fn run_survives_full_disk_and_closed_log() {
    let folder = tempfile::tempdir().unwrap();
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let run = |more: &[&str]| {
        let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let mut command = Command::new(env!("CARGO_BIN_EXE_floorguard"));
        command.args(["run", &robot_file(folder.path(), port), "--duration", "1.2"]).args(more);
        command
    };
    let output = run(&["--json", "--record", "/dev/full"]).stdout(full()).output().unwrap();
    let stderr_text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "the recording is missing: {stderr_text}");
    assert_eq!(stderr_text.matches("standard output takes nothing any more").count(), 1, "{stderr_text}");
    assert_eq!(stderr_text.matches("the robot goes on without its recording").count(), 1, "{stderr_text}");
    assert!(stderr_text.contains("the run went on without its recording"), "{stderr_text}");
    let output = run(&[]).stdout(full()).stderr(full()).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    let taken = robot_file(folder.path(), 0);
    let stderr_text = run(&["--black-box", &taken]).output().unwrap();
    assert_eq!(stderr_text.status.code(), Some(3), "no folder");
}

/// Whatever becomes of the display, the rings end with it: a robot that nobody can end any more must not go on.
#[test]
fn a_panic_beside_the_rings_ends_them() {
    let (ended, heard) = std::sync::mpsc::channel();
    std::thread::spawn(move || ended.send(panic_beside_the_rings()));
    let outcome = heard.recv_timeout(std::time::Duration::from_secs(30));
    assert_eq!(outcome, Ok((true, true)), "the rings go on");
}

/// Whether the panic came through, and whether the rings were ordered to end.
fn panic_beside_the_rings() -> (bool, bool) {
    let folder = tempfile::tempdir().unwrap();
    let configuration = load(std::path::Path::new(&robot_file(folder.path(), 0))).unwrap();
    let links = Links::bind(&configuration.carriers).unwrap();
    let shared: Box<HostedShared> = new_shared(&configuration.robot, clock::now()).unwrap();
    let flag = StopFlag::default();
    let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        run_rings((&configuration.robot, links), &shared, &flag, || panic!("nobody listens"))
    }));
    (panicked.is_err(), flag.is_stopped())
}

/// A port that another program holds is bad input, not a robot without a lidar.
#[test]
fn a_taken_port_is_refused_with_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let taken = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let file = robot_file(folder.path(), port);
    let output = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(["run", &file, "--duration", "5"])
        .output()
        .unwrap();
    let stderr_text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{stderr_text}");
    assert!(
        stderr_text.contains(&format!("[lidar] udp:127.0.0.1:{port}"))
            && stderr_text.contains("end the other program"),
        "{stderr_text}"
    );
}

/// The mission of the file is reported before anything moves, and a missing map is bad input.
#[test]
fn mission_comes_from_file_wrong_one_refused() {
    let folder = tempfile::tempdir().unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let file = robot_file(folder.path(), port);
    let robot = std::fs::read_to_string(&file).unwrap();
    // 8 m x 6 m of free floor within walls.
    let wall = |x: u32, y: u32| x < 4 || y < 4 || x >= 156 || y >= 116;
    let pixel = |x, y| image::Luma([if wall(x, y) { 0_u8 } else { 254 }]);
    image::GrayImage::from_fn(160, 120, pixel).save(folder.path().join("hall.png")).unwrap();
    std::fs::write(folder.path().join("dirt.csv"), "x_m,y_m,units\n5.0,3.0,12\n5.1,3.0,14\n").unwrap();
    let run = |mission: &str| {
        std::fs::write(&file, format!("{robot}\n[mission]\nstrategy = \"guarantee\"\n{mission}")).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_floorguard"));
        let output = command.args(["run", &file, "--duration", "1"]).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let start = "start_x_m = 2.0\nstart_y_m = 3.0\n";
    let (code, stderr_text) = run(&format!("map = \"hall.png\"\ndirt = \"dirt.csv\"\n{start}"));
    assert_eq!(code, Some(0), "{stderr_text}");
    assert!(stderr_text.contains("mission: starting, 0 % of what was dirty"), "{stderr_text}");
    for (wrong, why) in [
        ("map = \"cellar.png\"\ndirt = \"dirt.csv\"\n", "cellar.png"),
        ("map = \"hall.png\"\ndirt = \"mud.csv\"\n", "mud.csv"),
        ("map = \"hall.png\"\n", "`dirt` is missing"),
    ] {
        let (code, stderr_text) = run(&format!("{wrong}{start}"));
        assert_eq!(code, Some(3), "{stderr_text}");
        assert!(stderr_text.contains("[mission]") && stderr_text.contains(why), "{stderr_text}");
    }
}

/// Bytes that come and are of no use: the driver says what is wrong with them, once.
#[test]
fn wrong_lidar_is_reported_with_reason() {
    let folder = tempfile::tempdir().unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let file = robot_file(folder.path(), port);
    let child = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(["run", &file, "--duration", "2"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    for length in 0..40 {
        // Before the robot listens this fails, which is part of the game.
        let _ = sender.send_to(&vec![7; 500 + length], ("127.0.0.1", port));
        std::thread::sleep(std::time::Duration::from_millis(40));
    }
    let stderr_text = String::from_utf8(child.wait_with_output().unwrap().stderr).unwrap();
    let stdout_text: Vec<&str> =
        stderr_text.lines().filter(|line| line.contains("lidar: lidar packet of 5")).collect();
    assert_eq!(stdout_text.len(), 1, "{stderr_text}");
    assert!(stdout_text[0].contains("a data packet has 1206"), "{stderr_text}");
}

/// Two devices that send to one port are reported once, with the remedy; datagrams of other senders are ignored where
/// the lidar's sender is configured.
#[test]
fn foreign_sender_on_lidar_port_is_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let [lidar, stranger] = [(); 2].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
    let run = |sender: &str| {
        let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let file = robot_file(folder.path(), port);
        let text = std::fs::read_to_string(&file).unwrap();
        let source = format!("source = \"udp:127.0.0.1:{port}\"\n");
        std::fs::write(&file, text.replace(&source, &format!("{source}{sender}"))).unwrap();
        let child = Command::new(env!("CARGO_BIN_EXE_floorguard"))
            .args(["run", &file, "--duration", "1.5"])
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        for _ in 0..30 {
            // Before the robot listens this fails, which is part of the game.
            let _ = lidar.send_to(&[7; 1_206], ("127.0.0.1", port));
            let _ = stranger.send_to(&[7; 33], ("127.0.0.1", port));
            std::thread::sleep(std::time::Duration::from_millis(40));
        }
        String::from_utf8(child.wait_with_output().unwrap().stderr).unwrap()
    };
    let [first, second] = [&lidar, &stranger].map(|socket| socket.local_addr().unwrap().to_string());
    let stderr_text = run("");
    assert_eq!(stderr_text.matches("datagrams come from").count(), 1, "{stderr_text}");
    assert!(
        stderr_text.contains(&first)
            && stderr_text.contains(&second)
            && stderr_text.contains("name the device"),
        "{stderr_text}"
    );
    assert!(stderr_text.contains("packet of 33 bytes"), "{stderr_text}");
    let stderr_text = run(&format!("sender = \"{first}\"\n"));
    let stdout_text =
        format!("[lidar] datagrams of {second} are left out: only sender {first} is listened to");
    assert_eq!(stderr_text.matches(&stdout_text).count(), 1, "{stderr_text}");
    assert!(!stderr_text.contains("packet of 33 bytes"), "{stderr_text}");
}

fn robot_file(folder: &std::path::Path, port: u16) -> String {
    let devices = folder.display();
    let text = floorguard_configuration::EXAMPLE
        .replace("udp:0.0.0.0:2368", &format!("udp:127.0.0.1:{port}"))
        .replace("/dev/tty", &format!("{devices}/tty"))
        .replace("socketcan:can0", &format!("slcan:{devices}/ttyACM0"));
    let file = folder.join("robot.toml");
    std::fs::write(&file, text).unwrap();
    file.display().to_string()
}
