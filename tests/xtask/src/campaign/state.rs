//! How far a campaign is, kept in a file, so that it goes on where it was cut.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use super::block::Counts;
use crate::shell;

/// What is done.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct State {
    /// What was built from: another program's blocks prove nothing.
    pub program: String,
    /// First trial of each finished block.
    pub done: BTreeSet<u64>,
    /// Sums over the finished blocks.
    pub counts: Counts,
    /// Trials finished.
    pub trials: u64,
}

impl State {
    /// Reads the file; begins anew where there is none or it belongs to another program.
    pub fn load(path: &PathBuf, program: &str) -> Self {
        let kept = fs::read_to_string(path).ok().and_then(|text| serde_json::from_str::<Self>(&text).ok());
        kept.filter(|state| state.program == program)
            .unwrap_or_else(|| Self { program: program.to_owned(), ..Self::default() })
    }

    /// First trials of the blocks that are still to be run.
    pub fn missing(&self, trials: u64, block: u64) -> Vec<u64> {
        (0..trials).step_by(block as usize).filter(|at| !self.done.contains(at)).collect()
    }

    /// Books a block and writes the file: whole, or not at all.
    pub fn book(&mut self, path: &PathBuf, trials: std::ops::Range<u64>, counts: Counts) -> Result<()> {
        self.done.insert(trials.start);
        self.trials += trials.end - trials.start;
        for (name, count) in counts {
            *self.counts.entry(name).or_default() += count;
        }
        let beside = path.with_extension("new");
        fs::write(&beside, serde_json::to_string_pretty(self)?)
            .and_then(|()| fs::rename(&beside, path))
            .with_context(|| format!("cannot write {}", path.display()))
    }
}

/// `target/campaign/NAME-SEED.json`; the folder exists afterwards.
pub fn path(name: &str, seed: u64) -> Result<PathBuf> {
    let folder = shell::root().join("target/campaign");
    fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
    Ok(folder.join(format!("{name}-{seed}.json")))
}
