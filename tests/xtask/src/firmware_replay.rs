//! `cargo xtask firmware --replay`: a recorded lidar as a tape.

use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::program;

/// Bytes of the board's PSRAM for a tape: all but 64 KiB for the black box of the wired image, and as much for the options
/// of its bench.
const TAPE_BYTES_MAX: u64 = (16 << 20) - (128 << 10);
/// Simulated seconds of a tape that the board's memory holds.
const SECONDS_MAX: u32 = 12;

/// Writes the tape of a capture, and gives the fingerprint of what the host puts out.
pub fn record(capture: &Path, seconds: Option<u32>, tape: &Path) -> Result<String> {
    let capture = capture.canonicalize().with_context(|| format!("{}", capture.display()))?;
    let mut program = program::command("floorguard")?;
    program.arg("tape").arg(&capture).arg("--out").arg(tape);
    program.args(["--duration", &seconds.unwrap_or(SECONDS_MAX).to_string()]);
    // What is wrong with the capture, the program says on standard error.
    let output = program.stderr(std::process::Stdio::inherit()).output()?;
    if !output.status.success() {
        bail!("{}: cannot be put on a tape", capture.display());
    }
    check_length(tape)?;
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let packets = printed["packets"].as_u64().unwrap_or(0);
    eprintln!("firmware: {packets} packets of {} on the tape", capture.display());
    Ok(printed["digest"].as_str().context("the program printed no digest")?.to_owned())
}

/// The tape fits the board's memory.
pub fn check_length(tape: &Path) -> Result<()> {
    let length = std::fs::metadata(tape)?.len();
    if length > TAPE_BYTES_MAX {
        let memory = "the board's memory";
        bail!("the tape has {length} bytes, {memory} {TAPE_BYTES_MAX}: choose a shorter --duration");
    }
    Ok(())
}
