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
    /// The fingerprint of core and drivers that were mutated; empty: not recorded.
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
    /// Column of the change, in characters from 1; none: not recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column: Option<usize>,
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
    /// A part of the line of the source, in which the change lies: what is changed beside it has another reason, or none.
    pub source: String,
    /// The reason.
    pub reason: String,
    /// How many mutants it is the reason of; one if it does not say.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub count: usize,
}

const fn one() -> usize {
    1
}

const fn is_one(count: &usize) -> bool {
    *count == 1
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
    /// From a line of cargo-mutants, `FILE:LINE:COLUMN: MUTATION`, with the line of the source as it stands. One that cannot be
    /// read is kept as it is: it survives all the same.
    fn parse(text: &str, root: &Path) -> (Self, String) {
        let (place, mutation) = text.split_once(": ").unwrap_or((text, ""));
        let mut parts = place.split(':');
        let file = parts.next().unwrap_or(place);
        let mut number = || parts.next()?.parse::<usize>().ok();
        let (line, column) = (number().unwrap_or(0), number());
        let sources = std::fs::read_to_string(root.join(file)).unwrap_or_default();
        let whole = line.checked_sub(1).and_then(|index| sources.lines().nth(index)).unwrap_or_default();
        let (file, mutation, source) = (file.to_owned(), mutation.to_owned(), whole.trim().to_owned());
        (Self { file, line, column, mutation, source, reason: String::new() }, whole.to_owned())
    }
}

impl Equivalent {
    /// It speaks of this mutant: the change lies within the part of the line that it names.
    fn explains(&self, survivor: &Survivor, line: &str) -> bool {
        let within = |(start, part): (usize, &str)| {
            let before = line[..start].chars().count();
            survivor
                .column
                .is_some_and(|column| (before + 1..=before + part.chars().count()).contains(&column))
        };
        self.file == survivor.file
            && survivor.mutation.contains(&self.mutation)
            && line.match_indices(&self.source).any(within)
    }
}

/// The mutants of these names, each with its reason if there is one. A reason explains no more of them than it says.
pub fn explained<'a>(
    names: impl Iterator<Item = &'a str>,
    root: &Path,
    equivalents: &[Equivalent],
) -> Vec<Survivor> {
    let mut left: Vec<usize> = equivalents.iter().map(|known| known.count).collect();
    let explain = |name| {
        let (mut survivor, line) = Survivor::parse(name, root);
        let mut free = equivalents.iter().zip(&mut left).filter(|(_, left)| **left > 0);
        if let Some((known, left)) = free.find(|(known, _)| known.explains(&survivor, &line)) {
            *left -= 1;
            survivor.reason.clone_from(&known.reason);
        }
        survivor
    };
    names.map(explain).collect()
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

    const FILE: &str = "core-nostd/guard/src/example.rs";

    /// The reasons that survivors of these columns get, of a line with two `>`.
    fn reasons(columns: &[usize], equivalents: &[Equivalent]) -> Vec<String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(FILE);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        std::fs::write(&path, "fn f() {\n    µ > 1 && 10 > last\n}\n").expect("it is written");
        let names: Vec<String> =
            columns.iter().map(|column| format!("{FILE}:2:{column}: replace > with >= in f")).collect();
        let found = explained(names.iter().map(String::as_str), folder.path(), equivalents);
        assert!(found.iter().all(|survivor| survivor.source == "µ > 1 && 10 > last" && survivor.line == 2));
        found.into_iter().map(|survivor| survivor.reason).collect()
    }

    fn equivalent(source: &str, count: usize) -> Equivalent {
        let [file, mutation, source, reason] = [FILE, "replace > with >=", source, source].map(str::to_owned);
        Equivalent { file, mutation, source, reason, count }
    }

    #[test]
    fn a_survivor_finds_its_line_and_its_reason() {
        assert_eq!(reasons(&[7], &[equivalent("µ > 1", 1)]), ["µ > 1"]);
        assert_eq!(reasons(&[7], &[equivalent("elsewhere", 1)]), [""]);
    }

    #[test]
    fn reason_matches_exactly_one_change() {
        let [first, second] = [equivalent("µ > 1", 1), equivalent("> last", 1)];
        assert_eq!(reasons(&[17], std::slice::from_ref(&first)), [""], "the other `>` of the line");
        assert_eq!(reasons(&[7, 17], std::slice::from_ref(&first)), ["µ > 1", ""]);
        assert_eq!(reasons(&[7, 17], &[second, first]), ["µ > 1", "> last"]);
        let both = "> 1 && 10 >";
        assert_eq!(reasons(&[7, 17], &[equivalent(both, 1)]), [both, ""]);
        assert_eq!(reasons(&[7, 17], &[equivalent(both, 2)]), [both, both]);
    }

    #[test]
    fn what_cannot_be_read_survives_without_a_reason() {
        let found = explained(["something else"].into_iter(), Path::new("."), &[equivalent("", 1)]);
        assert_eq!((found.len(), found[0].reason.as_str()), (1, ""));
    }

    #[test]
    fn kept_reasons_find_their_lines() {
        let root = crate::shell::root();
        let known = equivalents(&root).expect("the reasons");
        let stale = known.iter().filter(|known| {
            let text = std::fs::read_to_string(root.join(&known.file)).unwrap_or_default();
            !text.lines().any(|line| line.contains(&known.source))
        });
        let stale: Vec<_> = stale.map(|known| (&known.file, &known.source)).collect();
        assert!(!known.is_empty() && stale.is_empty(), "{stale:?}");
        for known in &known {
            // Of one operator the part that is quoted has as many as the reason is for.
            let operator =
                known.mutation.trim_start_matches("replace ").split(' ').next().unwrap_or_default();
            let quoted = known.source.split([' ', '(']).filter(|word| *word == operator).count();
            let is_operator = !operator.contains(char::is_alphanumeric);
            assert!(!is_operator || quoted == known.count, "{}: {}", known.file, known.source);
        }
        let text = std::fs::read_to_string(root.join(RECORD)).expect("the record");
        assert!(serde_json::from_str::<Vec<Record>>(&text).is_ok_and(|records| !records.is_empty()));
    }

    #[test]
    fn explained_survivors_count_as_caught() {
        let survivor = |reason: &str| Survivor {
            file: String::new(),
            line: 1,
            column: None,
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
