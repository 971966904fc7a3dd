//! Every measurement that was ever printed, with date, machine and load: `docs/evidence/benchmarks.json`, the last one last.

use std::path::Path;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use super::line::Line;
use super::machine::Machine;

/// From the root of the workspace.
const FILE: &str = "docs/evidence/benchmarks.json";

/// One measurement of all tasks.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Measurement {
    /// Where and when.
    pub machine: Machine,
    /// What came of it.
    pub lines: Vec<Line>,
}

/// All of them.
///
/// # Errors
/// The file is absent or broken.
pub fn read(root: &Path) -> Result<Vec<Measurement>> {
    let text = std::fs::read_to_string(root.join(FILE)).with_context(|| format!("cannot read {FILE}"))?;
    serde_json::from_str(&text).with_context(|| format!("{FILE} is broken"))
}

/// Adds one: what was printed before stays.
///
/// # Errors
/// The file cannot be read or written.
pub fn add(root: &Path, new: Measurement) -> Result<()> {
    let mut all = read(root)?;
    all.push(new);
    std::fs::write(root.join(FILE), written(&all)?).with_context(|| format!("cannot write {FILE}"))
}

/// One row of a table a line.
fn written(all: &[Measurement]) -> Result<String> {
    let mut blocks = Vec::new();
    for measurement in all {
        let lines: Vec<String> =
            measurement.lines.iter().map(serde_json::to_string).collect::<Result<_, _>>()?;
        let machine = serde_json::to_string(&measurement.machine)?;
        blocks.push(format!("{{\"machine\": {machine},\n\"lines\": [\n{}\n]}}", lines.join(",\n")));
    }
    Ok(format!("[{}]\n", blocks.join(",\n")))
}
