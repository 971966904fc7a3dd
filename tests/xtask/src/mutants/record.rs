//! What the tests noticed of the mutants, as the audit shows it.

use std::path::Path;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

/// Where the results are kept.
pub const RECORD: &str = "docs/evidence/mutants.json";
/// Mutants that change nothing that anybody could notice, with the reason for each.
pub const EQUIVALENT: &str = "docs/evidence/equivalent-mutants.json";

/// The result for one part of the code.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Name of the campaign.
    pub name: String,
    /// What repeats it.
    pub command: String,
    /// Share of viable mutants that must be caught or explained, per cent.
    pub wanted_percent: f64,
    /// Mutants that compile.
    pub viable: usize,
    /// Mutants that a test noticed, those that never end included.
    pub caught: usize,
    /// Mutants that do not compile.
    pub unviable: usize,
    /// Mutants that were not tried when the campaign was cut.
    #[serde(default)]
    pub untried: usize,
    /// The fingerprint of core and drivers that were spoilt; empty: not recorded.
    #[serde(default)]
    pub code: String,
    /// Mutants that no test noticed.
    pub survivors: Vec<Survivor>,
}

/// A mutant that no test noticed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Survivor {
    /// File from the workspace root.
    pub file: String,
    /// Line when it was tried.
    pub line: usize,
    /// What was done to it.
    pub mutation: String,
    /// The line of the source.
    pub source: String,
    /// Why nobody can notice; empty: nobody knows yet.
    pub reason: String,
}

/// Why a mutant is equivalent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Equivalent {
    /// File from the workspace root.
    pub file: String,
    /// What is done, as cargo-mutants says it; a part of it is enough.
    pub mutation: String,
    /// A part of the line of the source.
    pub source: String,
    /// The reason.
    pub reason: String,
}

impl Record {
    /// Mutants that no test noticed and nobody can.
    pub fn explained(&self) -> usize {
        self.survivors.iter().filter(|survivor| !survivor.reason.is_empty()).count()
    }

    /// Mutants that are caught or explained, per cent of the viable ones and of those that were not tried: nobody knows
    /// whether a test would notice these.
    pub fn percent(&self) -> f64 {
        100.0 * (self.caught + self.explained()) as f64 / (self.viable + self.untried).max(1) as f64
    }
}

impl Survivor {
    /// From a line of cargo-mutants: `FILE:LINE:COLUMN: MUTATION`.
    pub fn parse(text: &str, root: &Path, equivalents: &[Equivalent]) -> Option<Self> {
        let (place, mutation) = text.split_once(": ")?;
        let mut parts = place.split(':');
        let (file, line) = (parts.next()?, parts.next()?.parse::<usize>().ok()?);
        let sources = std::fs::read_to_string(root.join(file)).unwrap_or_default();
        let source = sources.lines().nth(line.saturating_sub(1)).unwrap_or_default().trim().to_owned();
        let known = equivalents.iter().find(|known| {
            known.file == file && mutation.contains(&known.mutation) && source.contains(&known.source)
        });
        let reason = known.map(|known| known.reason.clone()).unwrap_or_default();
        Some(Self { file: file.to_owned(), line, mutation: mutation.to_owned(), source, reason })
    }
}

/// The explained mutants.
pub fn equivalents(root: &Path) -> Result<Vec<Equivalent>> {
    let Ok(text) = std::fs::read_to_string(root.join(EQUIVALENT)) else { return Ok(vec![]) };
    serde_json::from_str(&text).with_context(|| format!("{EQUIVALENT} is broken"))
}

/// Puts the result in the place of the last one of its name.
pub fn keep(root: &Path, record: Record) -> Result<()> {
    let path = root.join(RECORD);
    let kept = std::fs::read_to_string(&path).ok();
    let mut records: Vec<Record> =
        kept.map(|text| serde_json::from_str(&text)).transpose()?.unwrap_or_default();
    records.retain(|kept| kept.name != record.name);
    records.push(record);
    records.sort_by(|a, b| a.name.cmp(&b.name));
    std::fs::write(&path, serde_json::to_string_pretty(&records)? + "\n")
        .with_context(|| format!("cannot write {RECORD}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_survivor_finds_its_line_and_its_reason() {
        let root = crate::shell::root();
        let text = "tests/xtask/src/mutants/mod.rs:1:4: replace < with <= in f";
        let known = Equivalent {
            file: "tests/xtask/src/mutants/mod.rs".to_owned(),
            mutation: "replace < with <=".to_owned(),
            source: "the code is spoiled".to_owned(),
            reason: "it is a comment".to_owned(),
        };
        let found = Survivor::parse(text, &root, std::slice::from_ref(&known)).expect("a survivor");
        assert_eq!((found.line, found.reason.as_str()), (1, "it is a comment"));
        let other = Equivalent { source: "elsewhere".to_owned(), ..known };
        assert_eq!(Survivor::parse(text, &root, &[other]).expect("a survivor").reason, "");
    }

    #[test]
    fn explained_survivors_count_as_caught() {
        let survivor = |reason: &str| Survivor {
            file: String::new(),
            line: 1,
            mutation: String::new(),
            source: String::new(),
            reason: reason.to_owned(),
        };
        let survivors = vec![survivor("why"), survivor("")];
        let record = Record { viable: 10, caught: 8, survivors, ..Record::default() };
        assert!((record.percent() - 90.0).abs() < 1.0e-9);
        let cut = Record { untried: 8, ..record };
        assert!((cut.percent() - 50.0).abs() < 1.0e-9, "what was not tried is not caught");
    }
}
