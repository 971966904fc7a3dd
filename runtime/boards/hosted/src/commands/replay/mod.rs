//! `floorguard replay`: anybody's data through the same stages as on the robot.
//!
//! What a file is, its first bytes tell: a recording or bag (MCAP), a capture (pcap, pcapng, gzip), or a CARMEN log.

mod bag;
mod capture;
mod carmen;
mod cloud;
mod own;
mod recorded;
mod rows;
mod scans;
mod summary;

use std::fs::File;
use std::io::{BufReader, Read as _};
use std::path::Path;

use super::arguments::ReplayArguments;
use super::exit::BadInput;
use crate::recording::Recording;
use crate::world::is_replayable;

/// First bytes of an MCAP file.
const MCAP_MAGIC: &[u8] = b"\x89MCAP";

/// Runs the command.
///
/// # Errors
/// Bad input; everything before it has been processed and printed.
pub fn run(arguments: &ReplayArguments) -> anyhow::Result<()> {
    if let Some(what) = not_for_us(&arguments.file) {
        return Err(BadInput(format!("{}: {what}", arguments.file.display())).into());
    }
    if begins_with(&arguments.file, MCAP_MAGIC) {
        recording(arguments)
    } else if is_log(&arguments.file) {
        carmen::run(arguments)
    } else {
        capture::run(arguments)
    }
}

/// What people bring that is nearly right, and what they can do about it.
fn not_for_us(path: &Path) -> Option<&'static str> {
    if path.is_dir() {
        return Some("this is a folder; give the .mcap file in it");
    }
    if begins_with(path, b"#ROSBAG") {
        return Some(
            "this is a bag of ROS 1; make it a bag of ROS 2 in MCAP first, for example with rosbags-convert",
        );
    }
    begins_with(path, b"SQLite format 3").then_some(
        "this is a bag of ROS 2 in SQLite; make it MCAP first with ros2 bag convert (storage_id: mcap), or record with -s mcap",
    )
}

/// `.clf` or `.log`, packed or not.
fn is_log(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let bare = name.strip_suffix(".gz").or_else(|| name.strip_suffix(".bz2")).unwrap_or(&name);
    bare.ends_with(".clf") || bare.ends_with(".log")
}

fn begins_with(path: &Path, magic: &[u8]) -> bool {
    let mut found = Vec::new();
    let read = File::open(path).and_then(|file| file.take(magic.len() as u64).read_to_end(&mut found));
    read.is_ok() && found == magic
}

fn recording(arguments: &ReplayArguments) -> anyhow::Result<()> {
    let name = arguments.file.display().to_string();
    let bad = |error: &dyn std::fmt::Display| BadInput(format!("{name}: {error}"));
    let file = File::open(&arguments.file).map_err(|error| bad(&error))?;
    let mut recording = Recording::new(BufReader::new(file));
    let first = match recording.next() {
        Some(Ok(first)) => first,
        Some(Err(error)) => return Err(bad(&error).into()),
        None => return Err(bad(&"the recording holds no message").into()),
    };
    // Who names a topic wants people out of it, whoever wrote it.
    if is_replayable(&recording) && arguments.topic.is_none() {
        if arguments.record.is_some() {
            return Err(bad(&"it is a recording already; --record is for captures, bags and logs").into());
        }
        return own::run(first, &mut recording, (&name, arguments.json, arguments.realtime));
    }
    bag::run(first, &mut recording, (&name, arguments))
}
