//! `floorguard replay`: any recording through the same stages as on the robot.
//!
//! What a file is, its first bytes tell: a recording or bag (MCAP), a capture (pcap, pcapng, gzip), or a CARMEN log.

mod bag;
mod capture;
mod carmen;
mod cloud;
mod floor_below;
mod own;
mod recorded;
mod rows;
mod scan_odometry;
mod scanner_line;
mod scans;
mod stages;
mod standing_lidar;
mod summary;

pub(crate) use cloud::{Cell, CloudSorter, Point, points};

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use super::arguments::ReplayArguments;
use super::inspect::{page_of, scanner};
use floorguard_host::outcome::BadInput;
use floorguard_host::packing::{beginning, must_be_a_file, unpacked};
use floorguard_recording::Recording;
use floorguard_recording::replay::is_replayable;

pub(crate) use cloud::cloud_number;

/// First bytes of an MCAP file.
pub(crate) const MCAP_MAGIC: &[u8] = b"\x89MCAP";
/// So much of a file tells what it is.
const SNIFF_BYTES: u64 = 16_384;

/// Runs the command.
///
/// # Errors
/// Bad input; everything before it has been processed and printed.
pub fn run(arguments: &ReplayArguments) -> anyhow::Result<()> {
    let refuse = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", arguments.file.display()));
    if arguments.file.is_dir() {
        return Err(refuse(&"this is a folder; give the .mcap file in it").into());
    }
    must_be_a_file(&arguments.file).map_err(|error| refuse(&error))?;
    let begins = beginning(&arguments.file, SNIFF_BYTES).map_err(|error| refuse(&error))?;
    if let Some(what) = not_for_us(&begins) {
        return Err(refuse(&what).into());
    }
    if begins.starts_with(MCAP_MAGIC) {
        recording(arguments)
    } else if !is_capture(&begins) && (is_log(&begins) || is_named_log(&arguments.file)) {
        carmen::run(arguments)
    } else if !is_capture(&begins) && scanner(&begins).is_some() {
        scanner_line::run(arguments)
    } else if !is_capture(&begins)
        && let Ok(page) = page_of(&arguments.file, &begins)
    {
        let commands = page.commands.join("; ");
        Err(refuse(&format!("this is {}, in which nobody can be looked for; {commands}", page.kind)).into())
    } else {
        capture::run(arguments)
    }
}

/// What people bring that is nearly right, and what they can do about it.
pub(crate) fn not_for_us(begins: &[u8]) -> Option<&'static str> {
    if begins.starts_with(b"#ROSBAG") {
        return Some(
            "this is a bag of ROS 1; make it a bag of ROS 2 in MCAP first, for example with rosbags-convert",
        );
    }
    begins.starts_with(b"SQLite format 3").then_some(
        "this is a bag of ROS 2 in SQLite; make it MCAP first with ros2 bag convert (storage_id: mcap), or record with -s mcap",
    )
}

/// pcap in both byte orders, with microseconds and with nanoseconds, and pcapng.
pub(crate) fn is_capture(begins: &[u8]) -> bool {
    let magics = [0xa1b2_c3d4_u32, 0xa1b2_3c4d, 0x0a0d_0d0a];
    magics
        .iter()
        .any(|magic| begins.starts_with(&magic.to_le_bytes()) || begins.starts_with(&magic.to_be_bytes()))
}

/// A line of it begins as one of a CARMEN log does, whatever the file is called.
pub(crate) fn is_log(begins: &[u8]) -> bool {
    let words = ["FLASER ", "RLASER ", "ROBOTLASER1 ", "RAWLASER1 ", "ODOM ", "PARAM "];
    let text = String::from_utf8_lossy(begins);
    text.lines().any(|line| words.iter().any(|word| line.starts_with(word)))
}

/// `.clf` or `.log`, packed or not.
fn is_named_log(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let packings = [".gz", ".bz2", ".zst"];
    let bare = packings.iter().find_map(|packing| name.strip_suffix(packing)).unwrap_or(&name);
    bare.ends_with(".clf") || bare.ends_with(".log")
}

fn recording(arguments: &ReplayArguments) -> anyhow::Result<()> {
    let name = arguments.file.display().to_string();
    let bad = |error: &dyn std::fmt::Display| BadInput(format!("{name}: {error}"));
    let file = File::open(&arguments.file).and_then(unpacked).map_err(|error| bad(&error))?;
    let mut recording = Recording::new(BufReader::new(file));
    let first = match recording.next() {
        Some(Ok(first)) => first,
        Some(Err(error)) => return Err(bad(&error).into()),
        None => return Err(bad(&"the recording holds no message").into()),
    };
    // An explicitly named topic is searched for people, whatever recorded it.
    if is_replayable(&recording) && arguments.topic.is_none() {
        if arguments.record.is_some() {
            return Err(bad(&"it is a recording already; --record is for captures, bags and logs").into());
        }
        return own::run(first, &mut recording, (&name, arguments));
    }
    bag::run(first, &mut recording, (&name, arguments))
}
