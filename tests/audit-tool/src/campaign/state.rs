//! How far a campaign is, kept in a file, so that it goes on where it was cut.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use super::block::Counts;
use crate::shell;

/// What is done.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct State {
    /// What was built from: another program's blocks prove nothing.
    pub program: String,
    /// First trial of each block that was run: to its end, unless `cut` has it.
    pub done: BTreeSet<u64>,
    /// Blocks that the end of a run cut short: their first trial, and the first one that is still to be run. Files from
    /// before it was kept have none.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cut: BTreeMap<u64, u64>,
    /// Sums over all trials that are done.
    pub counts: Counts,
    /// Trials finished.
    pub trials: u64,
}

impl State {
    /// Reads the file; begins anew where there is none or it belongs to another program.
    pub fn load(path: &Path, program: &str) -> Self {
        let kept = fs::read_to_string(path).ok().and_then(|text| serde_json::from_str::<Self>(&text).ok());
        kept.filter(|state| state.program == program)
            .unwrap_or_else(|| Self { program: program.to_owned(), ..Self::default() })
    }

    /// What is still to be run, the first trials first: whole blocks, the rest of those that were cut, and as much of the
    /// last one as is asked for.
    pub fn missing(&self, trials: u64, block: u64) -> Vec<Range<u64>> {
        let begin = |start: u64| match self.cut.get(&start) {
            Some(end) => *end,
            None if self.done.contains(&start) => start + block,
            None => start,
        };
        (0..trials)
            .step_by(block as usize)
            .map(|start| begin(start)..(start + block).min(trials))
            .filter(|part| !part.is_empty())
            .collect()
    }

    /// Books trials of one block and writes the file: whole, or not at all.
    pub fn book(&mut self, path: &Path, block: u64, trials: Range<u64>, counts: Counts) -> Result<()> {
        let start = trials.start - trials.start % block;
        self.done.insert(start);
        if trials.end < start + block {
            self.cut.insert(start, trials.end);
        } else {
            self.cut.remove(&start);
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs what is missing, one count for each trial, and keeps it: begin and end of each part.
    fn play(path: &Path, trials: u64) -> Vec<(u64, u64)> {
        let mut state = State::load(path, "program");
        let missing = state.missing(trials, 10);
        for part in missing.clone() {
            let counts = part.clone().map(|trial| (format!("trial {trial}"), 1)).collect();
            state.book(path, 10, part, counts).unwrap();
        }
        missing.into_iter().map(|part| (part.start, part.end)).collect()
    }

    #[test]
    fn longer_run_resumes_within_a_cut_block() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model-1.json");
        assert_eq!(play(&path, 4), [(0, 4)]);
        assert_eq!(play(&path, 4), []);
        assert_eq!(play(&path, 7), [(4, 7)]);
        assert_eq!(play(&path, 25), [(7, 10), (10, 20), (20, 25)]);
        assert_eq!(play(&path, 40), [(25, 30), (30, 40)]);
        assert_eq!(play(&path, 12), []);
        let state = State::load(&path, "program");
        assert_eq!((state.trials, state.counts.len(), state.cut.len()), (40, 40, 0));
        assert!(state.counts.values().all(|count| *count == 1), "no trial counts twice");
    }

    #[test]
    fn old_campaign_without_cuts_resumes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model-1.json");
        let old = r#"{"program": "program", "done": [0, 20], "counts": {"steps": 5}, "trials": 20}"#;
        fs::write(&path, old).unwrap();
        assert_eq!(State::load(&path, "program").missing(40, 10), [10..20, 30..40]);
        assert_eq!(State::load(&path, "another").missing(20, 10), [0..10, 10..20]);
    }
}
