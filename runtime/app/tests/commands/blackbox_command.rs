//! `floorguard blackbox`: a log comes out whole, and damage costs the damaged rows only.

use std::io::{Read, Write};
use std::os::unix::net::UnixListener;
use std::path::Path;
use std::process::{Command, Output};

use floorguard_guard::{Action, Cause, GuardState};
use floorguard_recording::{Recording, topics};
use floorguard_robot::assembly::black_box_log;
use floorguard_runtime::black_box_log::{LogRestart, LogRow, encode_row};
use floorguard_runtime::shared::BoxEntry;
use floorguard_types::time::Stamp;

fn blackbox(path: &Path) -> (Output, usize) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_floorguard"));
    let output = command.arg("blackbox").arg(path).arg("--json").output().expect("the program starts");
    let rows = String::from_utf8_lossy(&output.stdout).lines().count();
    (output, rows)
}

/// Five seconds of driving, then the emergency stop.
fn moments() -> Vec<(Stamp, BoxEntry)> {
    let entry = |index: u64| {
        let stopped = index >= 500;
        let entry = BoxEntry {
            state: if stopped { GuardState::Latched } else { GuardState::Run },
            action: if stopped { Action::Category0 } else { Action::None },
            cause: stopped.then_some(Cause::EmergencyStop),
            holding: stopped.then_some(Cause::EmergencyStop),
            permitted_mps: if stopped { 0.0 } else { 0.8 },
            measured_mps: 0.75,
            limit_mps: 1.0,
            field_set: 2,
        };
        (Stamp::from_micros(index * 10_000), entry)
    };
    (0..1_000).map(entry).collect()
}

#[test]
fn log_becomes_recording_despite_damage() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("stop.fgbox");
    let log = black_box_log(&moments());
    assert!(log.len() < 1_000 * 29, "compact: {} bytes", log.len());
    std::fs::write(&path, &log).expect("written");
    let (output, rows) = blackbox(&path);
    assert_eq!((output.status.code(), rows), (Some(0), 1_000), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("0 damaged rows, complete"), "{output:?}");
    let file = std::fs::File::open(folder.path().join("stop.mcap")).expect("a recording beside the log");
    let messages: Vec<_> = Recording::new(file).collect::<Result<_, _>>().expect("readable");
    let count = |topic: &str| messages.iter().filter(|message| &*message.topic == topic).count();
    assert_eq!((count(topics::PERMITTED), count(topics::MEASURED), count(topics::STOPS)), (1_000, 1_000, 1));
    // Two read-outs one after the other, as a serial line carries them.
    std::fs::write(&path, [log.as_slice(), b"words of a boot loader\0", log.as_slice()].concat())
        .expect("written");
    let (output, rows) = blackbox(&path);
    assert_eq!((output.status.code(), rows), (Some(0), 2_000), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("1 damaged row, complete"), "{output:?}");
    // Noise before it, a hole in it, cut in the middle of a row.
    let mut damaged = b"noise of a serial line".to_vec();
    damaged.extend(&log[..5_000]);
    damaged.extend(&log[5_100..log.len() - 30]);
    std::fs::write(&path, &damaged).expect("written");
    let (output, rows) = blackbox(&path);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!((985..1_000).contains(&rows), "{rows}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("cut"), "{output:?}");
}

#[test]
fn what_is_no_log_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("words.fgbox");
    for bytes in [b"".as_slice(), b"words\0and more words\0", &[0; 1_000]] {
        std::fs::write(&path, bytes).expect("written");
        let (output, rows) = blackbox(&path);
        assert_eq!((output.status.code(), rows), (Some(3), 0), "{output:?}");
    }
}

/// A machine that died and came back answers on its line: the life before, what ended it, the life since.
#[test]
fn machine_reports_its_crash_over_the_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("machine.socket");
    let listener = UnixListener::bind(&path).expect("a socket");
    let machine = std::thread::spawn(move || {
        let (mut line, _) = listener.accept().expect("somebody asks");
        let mut order = [0];
        line.read_exact(&mut order).expect("the order");
        assert_eq!(&order, b"B");
        let log = black_box_log(&moments());
        let death = LogRestart { cause: 3, detail: 7, uptime_ms: 12_000, deaths: 2 };
        // In two portions: a line is slow.
        line.write_all(&log).expect("the life before");
        std::thread::sleep(std::time::Duration::from_millis(100));
        line.write_all(&encode_row(&LogRow::Restart(death))).expect("the death");
        line.write_all(&log).expect("the life since");
    });
    let out = folder.path().join("machine.mcap");
    let mut command = Command::new(env!("CARGO_BIN_EXE_floorguard"));
    command.arg("blackbox").arg(&path).arg("--json").arg("--out").arg(&out);
    let output = command.output().expect("the program starts");
    machine.join().expect("the machine was asked");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let reported = String::from_utf8_lossy(&output.stdout);
    let rows: Vec<&str> = reported.lines().collect();
    assert_eq!(rows.len(), 2_001);
    let death = rows.get(1_000).expect("a row");
    assert!(death.contains("watchdog") && death.contains("\"deaths\":2"), "{death}");
    // Both lives begin at zero; in the recording the second one follows the first.
    let messages: Vec<_> = Recording::new(std::fs::File::open(&out).expect("recorded"))
        .collect::<Result<_, _>>()
        .expect("readable");
    let times: Vec<u64> = messages
        .iter()
        .filter(|message| &*message.topic == topics::MEASURED)
        .map(|message| message.at.as_micros())
        .collect();
    assert_eq!(times.len(), 2_000);
    assert!(times.is_sorted(), "time runs on");
    assert_eq!(times.last().map(|last| last / 1_000), Some(12_000 + 9_990));
}
