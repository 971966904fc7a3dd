//! `floorguard decode` of a candump: every frame as a row, with what CANopen uses its identifier for.

use std::io::Write;
use std::path::Path;

use floorguard_host::packing;

use super::inspect::{can_frame, can_service};
use floorguard_host::outcome::BadInput;

/// Prints the frames of a candump.
///
/// # Errors
/// The file cannot be read, or `out` takes no more.
pub fn decode_can(file: &Path, csv: bool, mut out: impl Write) -> anyhow::Result<()> {
    let text = packing::text(file).map_err(|error| BadInput(format!("{}: {error}", file.display())))?;
    if csv {
        writeln!(out, "time_us,identifier,service,bytes")?;
    }
    let (mut frames, mut others) = (0_u64, 0_u64);
    for line in text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')) {
        let Some(frame) = can_frame(line) else {
            others += 1;
            continue;
        };
        frames += 1;
        if csv {
            let time = frame.time_us.map_or_else(String::new, |time_us| time_us.to_string());
            let bytes: String = frame.bytes.iter().map(|byte| format!("{byte:02X}")).collect();
            writeln!(out, "{time},{:03X},{},{bytes}", frame.identifier, can_service(frame.identifier))?;
        }
    }
    out.flush()?;
    say!("candump: {frames} frames, {others} other lines");
    Ok(())
}
