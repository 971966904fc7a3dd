//! How often each loop was seen to turn at most, beside its bound.
//!
//! `cargo xtask campaign loops` counts and records; the audit compares. A record names a loop by its function, its kind
//! and its number among those of that kind there, so that it outlives a change elsewhere in the file.

use std::path::Path;

use serde::Serialize;

use super::matched::matched;
use super::record::Record;
use crate::claim::{Claim, Finding};
use crate::facts::facts;
use crate::loops::LoopSite;

/// Where the counts are kept.
pub const RECORD: &str = "docs/evidence/loops.json";

/// What is known of one loop from running it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Seen {
    /// Most turns of one run through it. `None`: no test reached it, or it cannot be counted.
    pub largest_seen: Option<u64>,
    /// The bound as a number, as the program computed it where the largest count was seen.
    pub bound_value: Option<u64>,
    /// Counters were compiled into it.
    pub counted: bool,
    /// Why there is no count.
    pub why_not: String,
}

/// Why a loop is in no record.
fn why_not(site: &LoopSite) -> String {
    let why = match site.kind.as_str() {
        _ if !site.edits.is_empty() => "new since loops were counted, or no counter compiles there",
        "fill" | "comparison" => "the compiler writes it: as many turns as the array is long",
        "own iterator" => "each of its turns is one of the loop that asks it",
        _ => "the compiler may compute it, or its source has no name that a counter could be put to",
    };
    why.to_owned()
}

/// The tests that are to reach what the counted tests did not.
fn expected(file: &str) -> Option<String> {
    let entry = facts().not_counted.iter().find(|entry| file.starts_with(&entry.path))?;
    let first = format!("{}/{}", facts().trace.tests_folder, entry.tests.first()?);
    Some([vec![first], entry.tests[1..].to_vec()].concat().join(", "))
}

/// Puts what was recorded beside the loops.
pub fn compare(root: &Path, sites: &mut [LoopSite]) -> Claim {
    let text = std::fs::read_to_string(root.join(RECORD)).map_err(|error| format!("cannot be read: {error}"));
    judge(text.and_then(|text| records_in(&text)), sites)
}

fn records_in(text: &str) -> Result<Vec<Record>, String> {
    serde_json::from_str(text).map_err(|error| format!("is broken: {error}"))
}

/// What the record as a whole lacks.
fn of_record(why: &str) -> Finding {
    let message = format!("{why}; `{} campaign loops` counts again", facts().command);
    Finding { place: RECORD.to_owned(), line: 0, message }
}

/// How many loops there are of which kind.
#[derive(Default)]
struct Counts {
    countable: usize,
    ran: usize,
    never: usize,
    unknown: usize,
    /// Compared with a number.
    compared: usize,
}

fn judge(records: Result<Vec<Record>, String>, sites: &mut [LoopSite]) -> Claim {
    let unreadable = records.as_ref().err().map(|why| of_record(why));
    let (found, gone) = matched(records.unwrap_or_default(), sites);
    let has_records = found.iter().any(Option::is_some);
    let mut findings = Vec::new();
    let mut counts = Counts::default();
    for (site, record) in sites.iter_mut().zip(found) {
        counts.countable += usize::from(!site.edits.is_empty());
        match record {
            Some(record) => findings.extend(take(site, &record, &mut counts)),
            None => {
                site.seen.why_not = why_not(site);
                counts.unknown += usize::from(!site.edits.is_empty());
            }
        }
    }
    match unreadable {
        Some(finding) => findings.push(finding),
        None if !has_records => findings.push(of_record("has no count of any loop that there is")),
        None => {}
    }
    let Counts { countable, ran, never, unknown, compared } = counts;
    Claim {
        id: "loops-within-bounds",
        text: "No loop was ever seen to turn more often than its bound.",
        evidence: format!(
            "{ran} of {countable} countable loops ran in the tests and were counted: {compared} of them are compared with a number, {} \
             walk a slice, whose own length ends them and is no number in the sources; {never} never ran meanwhile: the table \
             names the tests that are to reach them; {unknown} cannot be counted or are new since; {gone} records are of loops that \
             are gone; `{} campaign loops` counts again",
            ran - compared,
            facts().command
        ),
        findings,
    }
}

/// Puts a record beside its loop; what is wrong with it.
fn take(site: &mut LoopSite, record: &Record, counts: &mut Counts) -> Option<Finding> {
    // A literal is a number even where its type did not tell.
    let literal = || site.bound.replace('_', "").parse().ok();
    let bound_value = Some(record.bound_value).filter(|value| *value > 0).or_else(literal);
    let expected = expected(&site.file);
    let why_not = if record.largest.is_none() { expected.clone().unwrap_or_default() } else { String::new() };
    site.seen = Seen { largest_seen: record.largest, bound_value, counted: true, why_not };
    let finding = |message| Some(Finding { place: site.file.clone(), line: site.line, message });
    let Some(largest) = record.largest else {
        counts.never += 1;
        let message = "never ran while it was counted; write a test, or name the one that reaches it in tests/audit.toml";
        return if expected.is_none() { finding(message.to_owned()) } else { None };
    };
    counts.ran += 1;
    counts.compared += usize::from(bound_value.is_some());
    let bound = bound_value.filter(|bound| largest > *bound)?;
    finding(format!("was seen to turn {largest} times; its bound `{}` is {bound}", site.bound))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loops;
    use crate::sources;

    fn sites() -> Vec<LoopSite> {
        let text = "fn f() {\n for i in 0..4 {}\n for i in 0..4 {}\n}";
        loops::list(&sources::parse("core-nostd/guard/src/example.rs", text.to_owned()).expect("it parses")).0
    }

    fn record(number: usize, largest: Option<u64>) -> Record {
        let text = str::to_owned;
        let (file, function) = (text("core-nostd/guard/src/example.rs"), text("f"));
        Record { file, function, kind: text("for"), number, bound: text("4"), largest, bound_value: 4 }
    }

    #[test]
    fn tests_for_the_rest_exist() {
        for name in facts().not_counted.iter().flat_map(|entry| &entry.tests) {
            assert!(crate::shell::root().join(&facts().trace.tests_folder).join(name).is_file(), "{name}");
        }
        for path in facts().not_counted.iter().map(|entry| &entry.path) {
            assert!(crate::shell::root().join(path).exists(), "{path}");
        }
    }

    #[test]
    fn a_count_above_its_bound_is_named() {
        let mut sites = sites();
        let claim = judge(Ok(vec![record(0, Some(4)), record(1, Some(5))]), &mut sites);
        assert_eq!(claim.findings.iter().map(|finding| finding.line).collect::<Vec<_>>(), [3]);
        assert_eq!(sites[0].seen.largest_seen, Some(4));
        assert_eq!(sites[1].seen.bound_value, Some(4));
    }

    #[test]
    fn unrun_or_unrecorded_loops_are_reported() {
        let mut sites = sites();
        let claim = judge(Ok(vec![record(1, None)]), &mut sites);
        assert!(claim.evidence.starts_with("0 of 2 countable"), "{}", claim.evidence);
        assert_eq!(claim.findings.iter().map(|finding| finding.line).collect::<Vec<_>>(), [3], "no reason");
        assert!(claim.evidence.contains("1 cannot"), "{}", claim.evidence);
        assert_eq!((sites[0].seen.counted, sites[1].seen.counted), (false, true));
        assert!(sites[0].seen.why_not.starts_with("new since"), "{}", sites[0].seen.why_not);
    }

    #[test]
    fn unreadable_or_empty_record_fails() {
        let places =
            |claim: &Claim| claim.findings.iter().map(|f| (f.place.clone(), f.line)).collect::<Vec<_>>();
        let named = [(RECORD.to_owned(), 0)];
        let folder = tempfile::tempdir().expect("a folder");
        let absent = compare(folder.path(), &mut sites());
        assert_eq!(places(&absent), named);
        assert!(absent.findings[0].message.starts_with("cannot be read"), "{:?}", absent.findings);
        assert_eq!(places(&judge(records_in("[{]"), &mut sites())), named);
        assert_eq!(places(&judge(records_in("[]"), &mut sites())), named);
        assert_eq!(places(&judge(Ok(vec![record(7, Some(1))]), &mut sites())), named, "of another loop");
    }

    #[test]
    fn records_of_removed_loops_are_reported() {
        let renamed = Record { function: "g".to_owned(), ..record(0, Some(4)) };
        let records = vec![record(0, Some(4)), record(1, Some(4)), record(2, Some(4)), renamed];
        let claim = judge(Ok(records), &mut sites());
        assert!(
            claim.holds() && claim.evidence.contains("2 records are of loops that are gone"),
            "{}",
            claim.evidence
        );
    }
}
