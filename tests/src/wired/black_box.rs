//! Asks the board for its black box, with the program that anybody would use.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Context;
use serde_json::Value;

/// What `floorguard blackbox` has read.
#[derive(Debug, Default)]
pub struct ReadOut {
    /// Causes of the moments, in order, of the life before the last reset; empty without one.
    pub before: Vec<Option<String>>,
    /// What ended that life, in words.
    pub restart: Option<String>,
    /// Causes since.
    pub since: Vec<Option<String>>,
    /// Every row was whole, and the last read-out complete.
    pub whole: bool,
}

/// Read-outs at most: the program takes a second of silence for the end, which a busy host takes for nothing.
const ASKED: usize = 4;

/// The program's answer for the socket of a board; asked again where it broke off.
///
/// # Errors
/// The program cannot be started, or finds nothing.
pub fn read_out(program: &Path, socket: &Path) -> anyhow::Result<ReadOut> {
    let mut read = read_once(program, socket);
    for _ in 1..ASKED {
        if read.as_ref().is_ok_and(|read| read.whole) {
            break;
        }
        read = read_once(program, socket);
    }
    read
}

fn read_once(program: &Path, socket: &Path) -> anyhow::Result<ReadOut> {
    let recording: PathBuf = socket.with_extension("mcap");
    let mut command = Command::new(program);
    command.arg("blackbox").arg(socket).arg("--json").arg("--out").arg(&recording);
    let output = command.output().with_context(|| format!("cannot start {}", program.display()))?;
    let reported = String::from_utf8_lossy(&output.stderr);
    anyhow::ensure!(output.status.success(), "floorguard blackbox: {reported}");
    anyhow::ensure!(std::fs::metadata(&recording)?.len() > 0, "floorguard blackbox wrote no recording");
    let mut read = ReadOut { whole: reported.contains(" 0 damaged rows, complete"), ..ReadOut::default() };
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let row: Value = serde_json::from_str(line)?;
        if let Some(cause) = row["restart"].as_str() {
            read.restart = Some(cause.to_owned());
            read.before = std::mem::take(&mut read.since);
        } else {
            read.since.push(row["cause"].as_str().map(str::to_owned));
        }
    }
    Ok(read)
}
