//! Installs the peers, and lets ours and theirs run on the same inputs one after the other.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::documents;
use super::history::{self, Measurement};
use super::line::{Line, Reported};
use super::machine::Machine;
use super::table::markdown;
use crate::shell;

/// In the order of the table.
const TASKS: [&str; 13] = [
    "detector", "clusters", "ground", "plane", "floor", "dirt", "svm", "tracker", "joint", "filter",
    "pipeline", "graph", "odometry",
];

/// Ours and theirs in turn, task by task: whatever else the machine does, it does to both. With tasks, only those, and nothing
/// is written. False if the machine is too busy for the table.
pub fn run(json: bool, tasks: &[String]) -> Result<bool> {
    if let Some(unknown) = tasks.iter().find(|task| !TASKS.contains(&task.as_str())) {
        bail!("no task `{unknown}`; there are {}", TASKS.join(", "));
    }
    let for_table = tasks.is_empty();
    let mut machine = Machine::here();
    if let Some(refusal) = machine.refusal().filter(|_| for_table) {
        eprintln!("{refusal}");
        return Ok(false);
    }
    let peers = Peers::prepared()?;
    if for_table {
        eprintln!("  waiting until the load of the build is gone");
        machine.settle();
    }
    let mut lines = Vec::new();
    for task in TASKS.iter().filter(|task| for_table || tasks.iter().any(|wanted| wanted == *task)) {
        eprintln!("  {task}: ours, the peers, ours again");
        let before = peers.ours(task)?;
        let theirs = peers.theirs(task)?;
        lines.extend(Line::join(&[before, peers.ours(task)?], &theirs));
        machine.note_load();
    }
    finish(json, for_table, Measurement { machine, lines })
}

/// Prints what was measured, keeps it if it may go into the table, and writes the documents.
fn finish(json: bool, for_table: bool, measurement: Measurement) -> Result<bool> {
    if json {
        for line in &measurement.lines {
            let mut row = serde_json::to_value(line)?;
            row["ratios"] = serde_json::to_value(line.ratios())?;
            println!("{row}");
        }
    } else {
        println!("{}", markdown(&measurement));
    }
    if !for_table {
        return Ok(true);
    }
    if let Some(refusal) = measurement.machine.refusal() {
        eprintln!("{refusal}");
        return Ok(false);
    }
    history::add(&shell::root(), measurement)?;
    documents::render(&shell::root())?;
    Ok(true)
}

/// What both sides need.
struct Peers {
    python: PathBuf,
    inputs: PathBuf,
}

impl Peers {
    /// Installs the peers and builds ours.
    fn prepared() -> Result<Self> {
        let work = shell::root().join("target/peers");
        std::fs::create_dir_all(&work)?;
        let python = environment(&work)?;
        if !shell::succeeds(&mut super::build())? {
            bail!("our measurement cannot be built");
        }
        Ok(Self { python, inputs: work.join("inputs") })
    }

    fn ours(&self, task: &str) -> Result<Vec<Reported>> {
        let mut bench = super::bench();
        let reported = shell::output(bench.arg("--peers").arg(&self.inputs).arg(task));
        Reported::read(&reported.context("our measurement failed")?)
    }

    /// Recordings and benchmark inputs lie beside the project.
    fn theirs(&self, task: &str) -> Result<Vec<Reported>> {
        let data = shell::root().join("../shared");
        let mut measure = Command::new(&self.python);
        measure.arg(shell::root().join("tests/peers/measure.py")).arg(&self.inputs);
        measure.arg(data.join("data/models")).arg(data.join("bench")).arg(task);
        Reported::read(&shell::output(&mut measure).context("the peers' measurement failed")?)
    }
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
