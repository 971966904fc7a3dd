//! Which reader takes a file: its first bytes tell.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use floorguard_host::packing::{beginning, must_be_a_file};

use super::page::Page;
use super::{bag, capture, cloud, lines, serial};
use crate::recordings::replay::{MCAP_MAGIC, is_capture, is_log, not_for_us};
use floorguard_host::outcome::BadInput;

/// So much of a file tells what it is.
const SNIFF_BYTES: u64 = 65_536;

/// What to look at.
#[derive(Clone, Debug, Args)]
pub struct InspectArguments {
    /// A recording or bag (.mcap), a capture (.pcap, .pcapng), a laser log, tracks (.csv, .txt,
    /// .ndjson), a point cloud (.ply, .pcd), a candump, or the bytes
    /// of an MTi's, VectorNav's or S300's line; packed or not.
    pub file: PathBuf,
    /// One object on standard output instead of the page.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// Bad input: the file cannot be read, or is nothing that we know.
pub fn run(arguments: &InspectArguments) -> anyhow::Result<()> {
    let file = &arguments.file;
    let refuse = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", file.display()));
    must_be_a_file(file).map_err(|error| refuse(&error))?;
    let begins = beginning(file, SNIFF_BYTES).map_err(|error| refuse(&error))?;
    if let Some(what) = not_for_us(&begins) {
        return Err(refuse(&what).into());
    }
    let mut page = page(file, &begins)?;
    page.file = file.display().to_string();
    page.bytes = std::fs::metadata(file).map_or(0, |known| known.len());
    let text = if arguments.json { serde_json::to_string(&page)? } else { page.to_string() };
    Ok(writeln!(std::io::stdout().lock(), "{text}")?)
}

/// What a file that begins so is, and what can be done with it.
///
/// # Errors
/// It cannot be read, or is nothing that we know.
pub fn page(file: &Path, begins: &[u8]) -> anyhow::Result<Page> {
    if begins.starts_with(MCAP_MAGIC) {
        return bag::page(file);
    }
    if is_capture(begins) {
        return capture::page(file);
    }
    if is_log(begins) {
        return lines::laser_log(file);
    }
    if let Some(page) = serial::page(file, begins)? {
        return Ok(page);
    }
    if let Some(page) = lines::candump(file, begins)? {
        return Ok(page);
    }
    if let Some(page) = lines::pixel_tracks(file, begins)? {
        return Ok(page);
    }
    if let Some(page) = cloud::page(file, begins)? {
        return Ok(page);
    }
    if let Some(page) = lines::tracks(file) {
        return Ok(page);
    }
    let known = "recordings and bags (MCAP), captures (pcap), laser logs (CARMEN), tracks (ETH, UCY, L-CAS, HERMES, tables with a heading, JSON), \
                 point clouds (PLY, PCD), candump, and the bytes of an MTi, VectorNav or S300";
    Err(BadInput(format!("{}: nothing that we know; known are {known}", file.display())).into())
}
