//! Installs the peers, lets ours and theirs run on the same inputs one after the other, and writes the table.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::history::{self, Measurement};
use super::machine::Machine;
use super::table::{Line, Told, best_peers, markdown};
use crate::shell;

/// Between these lines of BENCHMARKS.md the command writes; what stands around them is written by hand.
const BEGIN: &str = "<!-- written by cargo xtask bench --peers -->";
const END: &str = "<!-- end -->";
/// The same of the README, which names the best peer of each task.
const BEGIN_BEST: &str = "<!-- best peers, written by cargo xtask bench --peers -->";
const END_BEST: &str = "<!-- end of the best peers -->";

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
    let mut machine = Machine::here();
    if tasks.is_empty() {
        machine.need_quiet()?;
    }
    let work = shell::root().join("target/peers");
    std::fs::create_dir_all(&work)?;
    let python = environment(&work)?;
    let inputs = work.join("inputs");
    let data = shared();
    let mut lines = Vec::new();
    for task in TASKS.iter().filter(|task| tasks.is_empty() || tasks.iter().any(|wanted| wanted == *task)) {
        eprintln!("  {task}: ours, the peers, ours again");
        let ours = || -> Result<Vec<Told>> {
            let mut bench = super::bench();
            let told = shell::output(bench.arg("--peers").arg(&inputs).arg(task));
            Told::read(&told.context("our measurement failed")?)
        };
        let mut measure = Command::new(&python);
        measure.arg(shell::root().join("tests/peers/measure.py")).arg(&inputs);
        measure.arg(data.join("data/models")).arg(data.join("bench")).arg(task);
        let before = ours()?;
        let theirs = shell::output(&mut measure).context("the peers' measurement failed")?;
        lines.extend(Line::join(&[before, ours()?], &Told::read(&theirs)?));
        machine.look_again();
    }
    if json {
        for line in &lines {
            println!("{}", serde_json::to_string(line)?);
        }
    } else {
        println!("{}", markdown(&lines, &machine.words()));
    }
    if !tasks.is_empty() {
        return Ok(());
    }
    machine.need_quiet()?;
    history::add(&shell::root(), Measurement { machine, lines })?;
    render(&shell::root())
}

/// Writes the last measurement into BENCHMARKS.md and its best peers into the README.
///
/// # Errors
/// There is none, or a document has lost its marks.
pub fn render(root: &Path) -> Result<()> {
    let all = history::read(root)?;
    let Measurement { machine, lines } = all.last().context("nothing was measured yet")?;
    let table = markdown(lines, &machine.words());
    write(&root.join("BENCHMARKS.md"), (BEGIN, END), &table)?;
    write(&root.join("README.md"), (BEGIN_BEST, END_BEST), &best(machine, lines))
}

/// What the README says.
fn best(machine: &Machine, lines: &[Line]) -> String {
    let warning = if machine.is_busy() {
        " The machine was busy, which flatters us where a peer runs longer than ours; to be measured again."
    } else {
        ""
    };
    format!("{}\nMeasured: {}.{warning}\n", best_peers(lines), machine.words())
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

fn write(path: &Path, (begin, end): (&str, &str), table: &str) -> Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let old = std::fs::read_to_string(path).with_context(|| format!("cannot read {name}"))?;
    let new = replaced(&old, (begin, end), table).with_context(|| format!("{name} has lost its marks"))?;
    std::fs::write(path, new).with_context(|| format!("cannot write {name}"))
}

fn replaced(document: &str, (begin, end): (&str, &str), table: &str) -> Option<String> {
    let (before, rest) = document.split_once(begin)?;
    let (_, after) = rest.split_once(end)?;
    Some(format!("{before}{begin}\n\n{table}\n{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No figure is written by hand, and none is left behind.
    #[test]
    fn the_documents_show_the_last_measurement() {
        let root = shell::root();
        let all = history::read(&root).expect("measurements");
        let Measurement { machine, lines } = all.last().expect("one at least");
        for (name, marks, text) in [
            ("BENCHMARKS.md", (BEGIN, END), markdown(lines, &machine.words())),
            ("README.md", (BEGIN_BEST, END_BEST), best(machine, lines)),
        ] {
            let document = std::fs::read_to_string(root.join(name)).expect(name);
            let wanted = replaced(&document, marks, &text).expect("its marks");
            assert!(document == wanted, "{name}: run `cargo xtask bench --render`");
        }
    }
}
