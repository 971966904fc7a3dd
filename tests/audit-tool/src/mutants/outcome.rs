//! What is known of each mutant, kept in a file, so that a campaign goes on where it was cut.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

/// What came of a mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// It does not compile.
    Unviable,
    /// A test failed.
    Caught,
    /// So many suites did not notice it.
    Survived(usize),
}

/// All of them by name.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Outcomes {
    /// What was built: with other tests or another code nothing is known.
    program: String,
    known: BTreeMap<String, Outcome>,
    /// The fingerprint of core and drivers when the copy was made.
    #[serde(skip)]
    pub code: String,
    #[serde(skip)]
    path: PathBuf,
}

impl Outcomes {
    /// Reads the file; begins anew where there is none or it belongs to another program.
    pub fn load(path: &Path, program: &str) -> Self {
        let kept = fs::read_to_string(path).ok().and_then(|text| serde_json::from_str::<Self>(&text).ok());
        let kept = kept.filter(|kept| kept.program == program);
        let known = kept.map(|kept| kept.known).unwrap_or_default();
        Self { program: program.to_owned(), known, path: path.to_owned(), ..Self::default() }
    }

    /// What is known of a mutant.
    pub fn of(&self, name: &str) -> Option<Outcome> {
        self.known.get(name).copied()
    }

    /// Books and keeps it: whole, or not at all.
    pub fn book(&mut self, name: &str, outcome: Outcome) -> Result<()> {
        self.known.insert(name.to_owned(), outcome);
        let beside = self.path.with_extension("new");
        fs::write(&beside, serde_json::to_string_pretty(self)?)
            .and_then(|()| fs::rename(&beside, &self.path))
            .with_context(|| format!("cannot write {}", self.path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_outlive_a_cut_but_not_another_program() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("outcomes.json");
        let mut outcomes = Outcomes::load(&path, "a");
        outcomes.book("m", Outcome::Survived(2)).expect("it is written");
        assert_eq!(Outcomes::load(&path, "a").of("m"), Some(Outcome::Survived(2)));
        assert_eq!(Outcomes::load(&path, "b").of("m"), None);
    }
}
