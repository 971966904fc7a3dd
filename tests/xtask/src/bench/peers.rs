//! Installs the peers, lets ours and theirs run on the same inputs one after the other, and writes the table.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::table::{Reported, Row, markdown};
use crate::shell;

/// Between these lines of BENCHMARKS.md the command writes; what stands around them is written by hand.
const BEGIN: &str = "<!-- written by cargo xtask bench --peers -->";
const END: &str = "<!-- end -->";

/// In the order of the table.
const TASKS: [&str; 11] = [
    "detector", "clusters", "ground", "plane", "floor", "dirt", "svm", "tracker", "joint", "filter",
    "pipeline",
];

/// Ours and theirs in turn, task by task: whatever else the machine does, it does to both. With tasks, only those.
pub fn run(json: bool, tasks: &[String]) -> Result<()> {
    if let Some(unknown) = tasks.iter().find(|task| !TASKS.contains(&task.as_str())) {
        bail!("no task `{unknown}`; there are {}", TASKS.join(", "));
    }
    let work = shell::root().join("target/peers");
    std::fs::create_dir_all(&work)?;
    let python = environment(&work)?;
    let inputs = work.join("inputs");
    let data = shared();
    let mut rows = Vec::new();
    for task in TASKS.iter().filter(|task| tasks.is_empty() || tasks.iter().any(|wanted| wanted == *task)) {
        eprintln!("  {task}: ours, the peers, ours again");
        let ours = || -> Result<Vec<Reported>> {
            let mut bench = super::bench();
            let reported = shell::output(bench.arg("--peers").arg(&inputs).arg(task));
            Reported::read(&reported.context("our measurement failed")?)
        };
        let mut measure = Command::new(&python);
        measure.arg(shell::root().join("tests/peers/measure.py")).arg(&inputs);
        measure.arg(data.join("data/models")).arg(data.join("bench")).arg(task);
        let before = ours()?;
        let theirs = shell::output(&mut measure).context("the peers' measurement failed")?;
        rows.extend(Row::join(&[before, ours()?], &Reported::read(&theirs)?));
    }
    let text = markdown(&rows, &machine());
    if json {
        rows.iter().for_each(|row| println!("{}", row.to_json()));
    } else {
        println!("{text}");
    }
    if tasks.is_empty() { write(&shell::root().join("BENCHMARKS.md"), &text) } else { Ok(()) }
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
        if !is_there {
            eprintln!("  {package}: pip cannot install it here");
        }
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
