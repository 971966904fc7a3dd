//! Two rounds: every mutant against the quick tests, then what survived against all of them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};

use super::record::{self, Record, Survivor};
use crate::shell;

/// A part of the code, and the tests that watch over it.
struct Part {
    name: &'static str,
    package: &'static str,
    /// Files to spoil.
    files: &'static [&'static str],
    /// Words that choose tests of the package's library.
    tests: &'static [&'static str],
    /// Tests of more than a second: they see only what survived the others.
    slow: &'static [&'static str],
    wanted_percent: f64,
}

const PARTS: &[Part] = &[
    Part {
        name: "mutants-guard",
        package: "floorguard-core",
        files: &["core-nostd/src/guard/**", "core-nostd/src/protection/**"],
        tests: &["guard", "protection"],
        slow: &["reachable", "bit_flips"],
        wanted_percent: 100.0,
    },
    Part {
        name: "mutants-drivers",
        package: "floorguard-drivers",
        files: &["drivers/src/**"],
        tests: &[],
        slow: &[],
        wanted_percent: 85.0,
    },
];

/// What did not compile in any round.
const UNVIABLE: &str = "unviable.txt";
/// Seconds after which a mutant counts as endless, and so as noticed.
const ENDLESS_S: &str = "60";

/// Runs the campaign of that name; `None` if there is none. False if too many mutants survive.
pub fn run(name: &str, fresh: bool) -> Result<Option<bool>> {
    let Some(part) = PARTS.iter().find(|part| part.name == name) else { return Ok(None) };
    if !shell::is_installed("cargo-mutants") {
        bail!("cargo-mutants is missing: cargo install cargo-mutants --locked");
    }
    let folder = shell::target_folder().join("mutants").join(part.name);
    if fresh && folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    std::fs::create_dir_all(&folder)?;
    round(part, &folder, part.slow)?;
    if !part.slow.is_empty() {
        round(part, &folder, &[])?;
    }
    let record = result(part, &folder)?;
    let percent = record.percent();
    println!(
        "{}: {} viable mutants, {} caught, {} survive: {percent:.1} % caught or explained, {:.0} % wanted",
        part.name,
        record.viable,
        record.caught,
        record.survivors.len(),
        part.wanted_percent
    );
    for survivor in record.survivors.iter().filter(|survivor| survivor.reason.is_empty()) {
        println!("  {}:{} {}", survivor.file, survivor.line, survivor.mutation);
    }
    record::keep(&shell::root(), record)?;
    println!("kept in {}", record::RECORD);
    Ok(Some(percent >= part.wanted_percent))
}

/// Tries what was not caught before. That some survive is no failure of the command.
fn round(part: &Part, folder: &Path, skipped: &[&str]) -> Result<()> {
    let mut command: Command = shell::cargo();
    command.args(["mutants", "--no-shuffle", "--iterate", "--colors", "never", "--timeout", ENDLESS_S]);
    command.arg("--output").arg(folder).args(["--package", part.package]);
    if let Some(jobs) = std::env::var_os("RAYON_NUM_THREADS") {
        command.arg("--jobs").arg(jobs);
    }
    for files in part.files {
        command.args(["--file", files]);
    }
    command.args(["--", "--lib", "--"]).args(part.tests);
    for test in skipped {
        command.args(["--skip", test]);
    }
    // A small change compiles fastest so; a cache for whole crates would be in the way.
    command.env("CARGO_PROFILE_DEV_OPT_LEVEL", "1").env("CARGO_PROFILE_DEV_DEBUG", "0");
    command.env("CARGO_INCREMENTAL", "1").env_remove("RUSTC_WRAPPER").env_remove("CARGO_TARGET_DIR");
    let status = command.status()?;
    // 0: all caught; 2: some survive; 3: some never end.
    match status.code() {
        Some(0 | 2 | 3) => remember_unviable(folder),
        _ => bail!("cargo-mutants failed: {status}"),
    }
}

/// The next round lists what does not compile among what was caught.
fn remember_unviable(folder: &Path) -> Result<()> {
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap_or_default();
    std::fs::write(folder.join(UNVIABLE), read(UNVIABLE) + &read("mutants.out/unviable.txt"))?;
    Ok(())
}

/// Reads the lists of cargo-mutants.
fn result(part: &Part, folder: &Path) -> Result<Record> {
    let root = shell::root();
    let lines = |name: &str| -> Vec<String> {
        let path: PathBuf = folder.join("mutants.out").join(name);
        let text = std::fs::read_to_string(path).unwrap_or_default();
        text.lines().filter(|line| !line.trim().is_empty()).map(str::to_owned).collect()
    };
    let equivalents = record::equivalents(&root)?;
    let missed = lines("missed.txt");
    let survivors: Vec<Survivor> =
        missed.iter().filter_map(|line| Survivor::parse(line, &root, &equivalents)).collect();
    let kept = std::fs::read_to_string(folder.join(UNVIABLE)).unwrap_or_default();
    let unviable: BTreeSet<String> = kept.lines().map(str::to_owned).collect();
    let listed = ["caught.txt", "timeout.txt", "previously_caught.txt"].map(lines).concat();
    let caught: BTreeSet<String> = listed.into_iter().filter(|line| !unviable.contains(line)).collect();
    Ok(Record {
        name: part.name.to_owned(),
        command: format!("cargo xtask campaign {}", part.name),
        wanted_percent: part.wanted_percent,
        viable: caught.len() + survivors.len(),
        caught: caught.len(),
        unviable: unviable.len(),
        survivors,
    })
}
