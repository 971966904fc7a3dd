//! The operator's panel over HTTP, as a browser and as somebody who should not: shown, ordered, refused; and the robot
//! does not notice.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use floorguard_recording::{Recording, topics};
use floorguard_robot::environment::Calendar;
use serde_json::{Value, json};

const SECONDS: u64 = 13;
/// Beside other tests a robot in real time is late; what is waited for comes, or the test fails after this long.
const PATIENCE: Duration = Duration::from_secs(20);

struct Run {
    child: Child,
    address: String,
    token: String,
}

fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_floorguard"));
    for role in ["", "_VIEWER", "_TECHNICIAN"] {
        command.env_remove(format!("FLOORGUARD_PANEL{role}_TOKEN"));
    }
    command
}

fn start(more: &[&str]) -> Run {
    start_with(&[], &[&["--scenario", "empty"], more].concat())
}

fn start_with(tokens: &[(&str, &str)], more: &[&str]) -> Run {
    let arguments = ["simulate", "--json", "--panel", "127.0.0.1:0"];
    let mut child = program()
        .args(arguments)
        .args(more)
        .envs(tokens.iter().copied())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut lines = BufReader::new(child.stderr.take().expect("its words")).lines();
    let line = lines.find_map(|line| line.ok().filter(|line| line.contains("http://"))).expect("an address");
    std::thread::spawn(move || lines.for_each(drop));
    let (_, place) = line.split_once("http://").expect("an address");
    let (address, token) = place.split_once("/#").expect("a token");
    Run { child, address: address.to_owned(), token: token.trim().to_owned() }
}

impl Run {
    fn ask(&self, head: &str, body: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(&self.address).expect("the panel answers");
        stream.set_read_timeout(Some(PATIENCE)).expect("a limit");
        let host = if head.contains("Host:") { String::new() } else { format!("Host: {}\r\n", self.address) };
        let length = body.len();
        let request = format!("{head}\r\n{host}Content-Length: {length}\r\nConnection: close\r\n\r\n{body}");
        stream.write_all(request.as_bytes()).expect("sent");
        let mut answer = Vec::new();
        // A refused body may close the line before everything is read.
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let code = answer.split(' ').nth(1).and_then(|code| code.parse().ok()).expect("a status line");
        (code, answer.split_once("\r\n\r\n").map(|(_, body)| body.to_owned()).unwrap_or_default())
    }

    fn state(&self) -> Value {
        let (code, body) = self.ask("GET /state HTTP/1.1", "");
        assert_eq!(code, 200);
        serde_json::from_str(&body).expect("a picture")
    }

    fn order(&self, order: &str) -> (u16, String) {
        let head = format!(
            "POST /order HTTP/1.1\r\nContent-Type: application/json\r\nAuthorization: Bearer {}",
            self.token
        );
        self.ask(&head, &format!("{{\"order\":\"{order}\"}}"))
    }

    fn post(&self, path: &str, token: &str, body: &str) -> (u16, String) {
        let head = format!(
            "POST {path} HTTP/1.1\r\nContent-Type: application/json\r\nAuthorization: Bearer {token}"
        );
        self.ask(&head, body)
    }

    fn wait_for(&self, what: &str, seen: impl Fn(&Value) -> bool) -> Value {
        let started = Instant::now();
        while started.elapsed() < PATIENCE {
            let state = self.state();
            if seen(&state) {
                return state;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        panic!("waited for {what}: {}", self.state());
    }
}

fn speed(state: &Value) -> f64 {
    state["speed_mps"].as_f64().unwrap_or(-1.0)
}

#[test]
fn only_the_panel_pauses_and_resumes() {
    let mut run = start(&["--duration", &SECONDS.to_string()]);
    let started = Instant::now();
    // Sixty browsers that ask and never read.
    let slow: Vec<TcpStream> = (0..60)
        .map(|_| {
            let mut stream = TcpStream::connect(&run.address).expect("the panel answers");
            let request = format!("GET /state HTTP/1.1\r\nHost: {}\r\n\r\n", run.address).repeat(20);
            stream.write_all(request.as_bytes()).expect("sent");
            stream
        })
        .collect();
    let (code, page) = run.ask("GET / HTTP/1.1", "");
    assert!(code == 200 && page.contains("<canvas") && !page.contains("://"), "{code}");
    let moving = run.wait_for("driving", |state| speed(state) > 0.2);
    assert_eq!((&moving["state"], &moving["paused"]), (&Value::from("Run"), &Value::from(false)));
    assert!(moving["scan"].as_array().is_some_and(|scan| scan.len() > 50), "{moving}");
    assert!(moving["lidar"].as_array().is_some_and(|points| points.len() > 100), "{moving}");
    assert!(moving["sources"].as_array().is_some_and(|sources| sources.len() > 4), "{moving}");
    refusals(&run);
    assert_eq!(run.order("reset").0, 409, "no stop waits for a reset");
    nonsense(&run);
    assert_eq!(run.order("pause").0, 202);
    let standing = run.wait_for("standing", |state| speed(state).abs() < 0.01 && state["paused"] == true);
    assert_ne!(standing["state"], "Latched");
    assert_eq!(run.order("resume").0, 202);
    run.wait_for("driving again", |state| speed(state) > 0.2);
    let mut verdict = String::new();
    run.child.stdout.take().expect("its verdict").read_to_string(&mut verdict).expect("readable");
    let took = started.elapsed();
    assert!(run.child.wait().expect("ended").success(), "{verdict}");
    assert!(took < Duration::from_secs(SECONDS + 5), "slow browsers must not slow the robot: {took:?}");
    let verdict: Value = serde_json::from_str(&verdict).expect("a verdict");
    assert!(verdict["faulty_sources"].as_array().is_some_and(Vec::is_empty), "{verdict}");
    drop(slow);
}

/// The robot on threads and real lines while 200 browsers ask and do not read, and one reads: it drives, it stops at once when
/// its emergency stop is pressed, every row of
/// its lines is in the recording, and who reads gets a picture every tenth of a second.
#[test]
fn slow_browsers_lose_pictures_robot_loses_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("run.mcap");
    let path = file.to_str().expect("a readable path");
    let mut run = start(&["--duration", "7", "--real-io", "--emergency-stop", "5..6", "--record", path]);
    let slow: Vec<TcpStream> = (0..200)
        .map(|_| {
            let mut stream = TcpStream::connect(&run.address).expect("the panel answers");
            let request = format!("GET /state HTTP/1.1\r\nHost: {}\r\n\r\n", run.address).repeat(100);
            stream.write_all(request.as_bytes()).expect("sent");
            stream
        })
        .collect();
    let (mut pictures, mut newest, began) = (0, 0, Instant::now());
    while began.elapsed() < Duration::from_secs(4) {
        let (code, body) = run.ask(&format!("GET /state?after={newest} HTTP/1.1"), "");
        let number =
            serde_json::from_str::<Value>(&body).map_or(0, |state| state["number"].as_u64().unwrap_or(0));
        pictures += u64::from(code == 200 && number > newest);
        newest = number.max(newest);
    }
    let mut verdict = String::new();
    run.child.stdout.take().expect("its verdict").read_to_string(&mut verdict).expect("readable");
    assert!(run.child.wait().expect("ended").success(), "{verdict}");
    println!("{pictures} pictures in 4 s; {verdict}");
    assert!(pictures > 9, "{pictures} pictures in 4 s");
    let verdict: Value = serde_json::from_str(&verdict).expect("a verdict");
    assert!(verdict["distance_m"].as_f64().is_some_and(|driven_m| driven_m > 0.5), "{verdict}");
    // From the button to the order on the bus; on an idle computer 10 ms, and this one has other work.
    assert!(verdict["stop_latency_ms"]["max"].as_f64().is_some_and(|ms| ms < 100.0), "{verdict}");
    let messages = Recording::new(std::fs::File::open(&file).expect("a recording"));
    let messages: Vec<_> = messages.collect::<Result<_, _>>().expect("whole");
    let lidar = messages.iter().filter(|message| &*message.topic == "/raw/lidar").count();
    assert!(lidar > 4_500, "{lidar} of 5,277 lidar datagrams");
    let text = messages.iter().filter(|message| &*message.topic == topics::DIAGNOSTICS);
    let lost = text.filter(|message| message.data.windows(9).any(|words| words == b"rows lost")).count();
    assert_eq!(lost, 0, "the recording misses rows");
    drop(slow);
}

/// Three hundred damaged requests, each on a line of its own, all with the right token: none is an order.
fn nonsense(run: &Run) {
    let right = format!(
        "POST /order HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\nContent-Type: application/json\r\n\
         Content-Length: 17\r\n\r\n{{\"order\":\"pausf\"}}",
        run.address, run.token
    );
    let mut seed = 20_261_121_u64;
    let mut random = move |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    for _ in 0..300 {
        let mut bytes = right.clone().into_bytes();
        for _ in 0..=random(6) {
            let at = random(bytes.len());
            match random(4) {
                0 => bytes[at] = random(256) as u8,
                1 => bytes.truncate(at.max(1)),
                2 => bytes.insert(at, random(256) as u8),
                _ => bytes.extend_from_within(at..),
            }
        }
        let mut stream = TcpStream::connect(&run.address).expect("the panel answers");
        // It may close the line at the first wrong byte.
        let _ = stream.write_all(&bytes);
    }
    assert_eq!(run.state()["paused"], Value::from(false));
}

/// A page that the panel did not send has nobody's leave, whatever it knows; nor has one without a name.
fn refusals(run: &Run) {
    let json = "Content-Type: application/json";
    let token = format!("Authorization: Bearer {}", run.token);
    let pause = "{\"order\":\"pause\"}";
    let long = format!("{{\"order\":\"pause\",\"x\":\"{}\"}}", "x".repeat(5_000));
    let cases = [
        (format!("POST /order HTTP/1.1\r\n{json}"), pause, 401),
        (format!("POST /order HTTP/1.1\r\n{json}\r\nAuthorization: Bearer 0123456789abcdef"), pause, 401),
        (format!("POST /order HTTP/1.1\r\n{token}\r\nContent-Type: text/plain"), pause, 415),
        (format!("POST /order HTTP/1.1\r\n{token}\r\n{json}"), "{\"order\":\"drive\"}", 400),
        (format!("POST /order HTTP/1.1\r\n{token}\r\n{json}"), "{\"order\":\"pause\",\"speed\":9}", 400),
        (format!("POST /order HTTP/1.1\r\n{token}\r\n{json}"), "\u{0}", 400),
        (format!("POST /order HTTP/1.1\r\n{token}\r\n{json}"), long.as_str(), 413),
        (format!("POST /order HTTP/1.1\r\n{token}\r\n{json}\r\nHost: evil.example"), pause, 421),
        ("GET /state HTTP/1.1\r\nHost: evil.example".to_owned(), "", 421),
        (format!("POST /order HTTP/1.1\r\n{token}\r\n{json}\r\nOrigin: http://evil.example"), pause, 403),
        (format!("POST /order HTTP/1.1\r\n{token}\r\n{json}\r\nOrigin: null"), pause, 403),
        (format!("POST /order HTTP/1.1\r\n{token}\r\n{json}\r\nOrigin: \u{e4}"), pause, 403),
        ("GET /state HTTP/1.1\r\nOrigin: http://evil.example".to_owned(), "", 403),
        ("GET /state?after=x HTTP/1.1".to_owned(), "", 400),
        ("GET /../etc/passwd HTTP/1.1".to_owned(), "", 404),
        ("GET /order HTTP/1.1".to_owned(), "", 405),
    ];
    for (head, body, expected) in cases {
        let (code, answer) = run.ask(&head, body);
        assert_eq!(code, expected, "{head}: {answer}");
    }
    assert_eq!(run.state()["paused"], Value::from(false));
}

/// The server refuses each role what it may not do, whatever the page shows.
#[test]
fn each_role_may_do_its_part_only() {
    let (viewer, operator, technician) =
        ("viewer-viewer-viewer", "operator-operator", "technician-technician");
    let tokens = [
        ("FLOORGUARD_PANEL_VIEWER_TOKEN", viewer),
        ("FLOORGUARD_PANEL_TOKEN", operator),
        ("FLOORGUARD_PANEL_TECHNICIAN_TOKEN", technician),
    ];
    // Ended by the test: longer than any computer needs for the requests.
    let mut run = start_with(&tokens, &["--scenario", "empty", "--duration", "300"]);
    let areas = r#"{"areas":[{"name":"hall","kind":"no-go","corners_m":[[0,0],[1,0],[1,1]]}]}"#;
    let requests = [
        ("/order", r#"{"order":"pause"}"#, [401, 202, 202]),
        ("/order", r#"{"order":"resume"}"#, [401, 202, 202]),
        ("/mission", r#"{"do":"cancel","place":0}"#, [401, 409, 409]),
        ("/acknowledge", r#"{"id":77}"#, [401, 409, 409]),
        ("/areas", areas, [401, 403, 202]),
        ("/schedules", r#"{"schedules":[]}"#, [401, 409, 409]),
        ("/changed", r#"{"part":"brushes"}"#, [401, 403, 409]),
    ];
    for (path, body, expected) in requests {
        for (token, code) in [viewer, operator, technician].into_iter().zip(expected) {
            let (answered, why) = run.post(path, token, body);
            assert_eq!(answered, code, "{path} by {token}: {why}");
        }
    }
    let shown = |path: &str| {
        let (code, body) = run.ask(&format!("GET {path} HTTP/1.1\r\nAuthorization: Bearer {viewer}"), "");
        (code, serde_json::from_str::<Value>(&body).unwrap_or_default())
    };
    // The brief comes with the first state of the robot.
    let began = Instant::now();
    let (code, brief) = loop {
        let (code, brief) = shown("/brief");
        if brief["headline_parts"].is_object() || began.elapsed() > PATIENCE {
            break (code, brief);
        }
    };
    assert!(code == 200 && brief["headline_parts"]["key"].is_string(), "{brief}");
    assert_eq!((shown("/robots"), shown("/camera.jpg").0), ((200, json!([])), 404));
    let (code, role) = run.ask(&format!("GET /role HTTP/1.1\r\nAuthorization: Bearer {operator}"), "");
    assert_eq!((code, role.as_str()), (200, "\"operator\""));
    for damaged in
        ["", "{}", r#"{"areas":[{}]}"#, &areas.replace("hall", ""), &areas.replace("[1,1]", "[1,1e9]")]
    {
        assert_eq!(run.post("/areas", technician, damaged).0, 400, "{damaged}");
    }
    let _ = run.child.kill();
    let _ = run.child.wait();
}

/// Missions ordered at the panel begin, keep to the drawn areas and end there; a replay repeats them to the bit.
#[test]
fn ordered_missions_repeat_to_the_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, kept) = (folder.path().join("run.mcap"), folder.path().join("panel.json"));
    let (file, kept) = (file.to_str().expect("a path"), kept.to_str().expect("a path"));
    let scenario = ["--scenario", "supermarket", "--strategy", "guarantee", "--duration", "9"];
    let run_with =
        |more: &[&str]| start_with(&[], &[&scenario, &["--panel-records", kept][..], more].concat());
    let mut run = run_with(&["--record", file]);
    run.wait_for("a mission", |state| state["mission"]["phase"] == "cleaning");
    let areas = r#"{"areas":[{"name":"till","kind":"clean","corners_m":[[1,-1.5],[4,-1.5],[4,1.5],[1,1.5]]},
        {"name":"spill","kind":"no-go","corners_m":[[9,-1],[11,-1],[11,1],[9,1]]}]}"#;
    let post = |run: &Run, path: &str, body: &str| run.post(path, &run.token.clone(), body).0;
    assert_eq!(post(&run, "/areas", areas), 202);
    assert_eq!(post(&run, "/mission", r#"{"do":"begin","areas":["nowhere"]}"#), 409);
    assert_eq!(post(&run, "/mission", r#"{"do":"begin","areas":["till"]}"#), 202);
    assert_eq!(post(&run, "/mission", r#"{"do":"cancel","place":0}"#), 202);
    run.wait_for("the mission of the area", |state| state["queue"]["name"] == "till");
    // The clock orders another one.
    let now = Calendar::of_this_computer().civil(Calendar::now()).expect("a date");
    let due =
        json!({"name": "now", "weekdays": [1, 2, 3, 4, 5, 6, 7], "minute": now.minute, "areas": ["till"]});
    assert_eq!(post(&run, "/schedules", &json!({"schedules": [due]}).to_string()), 202);
    run.wait_for("the scheduled mission", |state| state["queue"]["waiting"] == json!(["till"]));
    let mut verdict = String::new();
    run.child.stdout.take().expect("its verdict").read_to_string(&mut verdict).expect("readable");
    let _ = run.child.wait();
    let replay = program().args(["replay", file]).output().expect("the program starts");
    let words = String::from_utf8_lossy(&replay.stderr).into_owned();
    assert!(replay.status.success() && words.contains("as recorded"), "{words}");
    // The next run finds the areas again.
    let mut next = run_with(&[]);
    next.wait_for("a picture", |state| state["records"].as_u64().is_some());
    let (_, records) = next.ask("GET /records HTTP/1.1", "");
    let records: Value = serde_json::from_str(&records).expect("records");
    assert_eq!(records["areas"].as_array().map(Vec::len), Some(2), "{records}");
    assert_eq!(records["schedules"][0]["began"].as_str(), Some(now.date.as_str()), "{records}");
    let day = records["days"].as_object().and_then(|days| days.keys().next_back().cloned()).expect("a day");
    let (code, proof) = next.ask(&format!("GET /proof.pdf?day={day} HTTP/1.1"), "");
    assert!(code == 200 && proof.starts_with("%PDF-"), "{code}");
    let _ = next.child.kill();
    let _ = next.child.wait();
}

#[test]
fn the_network_sees_nothing_without_a_configured_token() {
    let arguments = ["simulate", "--scenario", "empty", "--duration", "1", "--panel", "0.0.0.0:0"];
    let output = program().args(arguments).output().expect("the program starts");
    let output_text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{output_text}");
    assert!(output_text.contains("FLOORGUARD_PANEL_TOKEN"), "{output_text}");
    let weak = program().args(arguments).env("FLOORGUARD_PANEL_TOKEN", "short").output().expect("starts");
    assert_eq!(weak.status.code(), Some(3));
}
