//! Installs the peers, lets ours and theirs run on the same inputs one after the other, and writes the table.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::table::{Row, Told, markdown};
use crate::shell;

/// Between these lines of BENCHMARKS.md the command writes; what stands around them is written by hand.
const BEGIN: &str = "<!-- written by cargo xtask bench --peers -->";
const END: &str = "<!-- end -->";

/// Everything.
pub fn run() -> Result<()> {
    let work = shell::root().join("target/peers");
    std::fs::create_dir_all(&work)?;
    let python = environment(&work)?;
    let inputs = work.join("inputs");
    let ours = shell::output(super::bench().arg("--peers").arg(&inputs)).context("our measurement failed")?;
    let data = shared();
    let mut measure = Command::new(&python);
    measure.arg(shell::root().join("tests/peers/measure.py")).arg(&inputs);
    measure.arg(data.join("data/models")).arg(data.join("bench"));
    println!("measuring the peers: a few minutes");
    let theirs = shell::output(&mut measure).context("the peers' measurement failed")?;
    // Ours once more, on the machine as it is now: the better half of a noisy pair is nobody's.
    let again =
        shell::output(super::bench().arg("--peers").arg(&inputs)).context("our measurement failed")?;
    let rows = Row::join(&[Told::read(&ours)?, Told::read(&again)?], &Told::read(&theirs)?);
    let text = markdown(&rows, &machine());
    println!("{text}");
    write(&shell::root().join("BENCHMARKS.md"), &text)
}

/// A virtual environment with whatever of the requirements can be installed.
fn environment(work: &Path) -> Result<PathBuf> {
    let (venv, python) = (work.join("venv"), work.join("venv/bin/python"));
    if !python.is_file() {
        let mut create = Command::new("python3");
        if !shell::succeeds(create.args(["-m", "venv"]).arg(&venv))? {
            bail!("python3 makes no virtual environment; install python3-venv, or leave out --peers");
        }
    }
    let listed = std::fs::read_to_string(shell::root().join("tests/peers/requirements.txt"))?;
    for package in listed.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let mut install = Command::new(&python);
        install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", package]);
        let is_there = shell::output(&mut install).is_some();
        println!(
            "  {package}: {}",
            if is_there { "installed" } else { "skipped: pip cannot install it here" }
        );
    }
    Ok(python)
}

/// Where recordings and benchmark inputs lie, beside the project.
fn shared() -> PathBuf {
    shell::root().join("../shared")
}

/// Processor, cores and how busy they are.
fn machine() -> String {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let processor = read("/proc/cpuinfo");
    let name = processor.lines().find(|line| line.starts_with("model name"));
    let name = name.and_then(|line| line.split(": ").nth(1)).unwrap_or("unknown processor").to_owned();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let load = read("/proc/loadavg").split(' ').next().unwrap_or("unknown").to_owned();
    format!("{name}, {cores} cores, load {load}, one thread each")
}

fn write(path: &Path, table: &str) -> Result<()> {
    let old = std::fs::read_to_string(path).unwrap_or_else(|_| format!("# Benchmarks\n\n{BEGIN}\n{END}\n"));
    let (before, rest) = old.split_once(BEGIN).context("BENCHMARKS.md has lost its first mark")?;
    let (_, after) = rest.split_once(END).context("BENCHMARKS.md has lost its second mark")?;
    std::fs::write(path, format!("{before}{BEGIN}\n\n{table}\n{END}{after}"))?;
    Ok(())
}
