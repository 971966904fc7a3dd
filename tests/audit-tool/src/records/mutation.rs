//! What the last mutation runs left alive, and whether each survivor has its reason.

use std::path::Path;

use crate::claim::{Claim, Finding};
use crate::facts::{Part, facts};
use crate::mutants::{RECORD, Record};

/// Reads the records and judges them, beside the fingerprint of the code as it is.
pub fn read(root: &Path, code_today: &str) -> (Vec<Record>, Claim) {
    let text = std::fs::read_to_string(root.join(RECORD)).map_err(|error| format!("cannot be read: {error}"));
    let records = text.and_then(|text| records_in(&text));
    let claim = judge(records.as_deref().map_err(String::as_str), code_today);
    (records.unwrap_or_default(), claim)
}

fn records_in(text: &str) -> Result<Vec<Record>, String> {
    serde_json::from_str(text).map_err(|error| format!("is broken: {error}"))
}

fn judge(records: Result<&[Record], &str>, code_today: &str) -> Claim {
    let mut findings = Vec::new();
    let mut reported = Vec::new();
    if let Err(why) = records {
        findings.push(of_record(format!("{why}; nothing is known of any mutant")));
        reported.push(String::from("no record"));
    }
    for part in records.is_ok().then_some(&facts().mutants).into_iter().flatten() {
        let mut of_it = records.unwrap_or_default().iter().filter(|record| record.name == part.name);
        match (of_it.next(), of_it.next()) {
            (Some(record), None) => {
                findings.extend(judge_record(part, record));
                reported.push(tell(part, record, code_today));
            }
            (None, _) => {
                let message =
                    format!("{0} has no record; `{1} campaign {0}` makes one", part.name, facts().command);
                findings.push(of_record(message));
            }
            (Some(_), Some(_)) => findings.push(of_record(format!("{} has two records", part.name))),
        }
    }
    Claim {
        id: "mutants-caught",
        text: "The tests notice a mutated guard or driver; what they cannot notice is explained.",
        evidence: reported.join("; "),
        findings,
    }
}

fn of_record(message: String) -> Finding {
    Finding { place: RECORD.to_owned(), line: 0, message }
}

/// What one part lacks: its share, and then each mutant that costs it.
fn judge_record(part: &Part, record: &Record) -> Vec<Finding> {
    let mut findings = Vec::new();
    if record.viable != record.caught + record.survivors.len() {
        let (viable, caught, survive) = (record.viable, record.caught, record.survivors.len());
        let message = format!(
            "{}: {viable} viable mutants are not {caught} caught and {survive} that survive",
            part.name
        );
        findings.push(of_record(message));
    }
    if record.percent() < part.wanted_percent {
        let command = &facts().command;
        findings.push(of_record(format!(
            "{}: {:.1} % caught or explained, {:.0} % wanted; {} survive without a reason, {} were not tried; \
             `{command} campaign {0}` goes on",
            part.name,
            record.percent(),
            part.wanted_percent,
            record.survivors.len() - record.explained(),
            record.untried
        )));
        let unexplained = record.survivors.iter().filter(|survivor| survivor.reason.is_empty());
        findings.extend(unexplained.map(|survivor| Finding {
            place: survivor.file.clone(),
            line: survivor.line,
            message: format!("no test notices: {}", survivor.mutation),
        }));
    }
    findings
}

/// The figures of a part, and whether the code is still the one that was mutated.
fn tell(part: &Part, record: &Record, code_today: &str) -> String {
    let since = match record.code.as_str() {
        "" => ", by code that is not recorded",
        code if code == code_today => "",
        _ => ", by earlier code: core or drivers changed since",
    };
    format!(
        "{}: {} of {} viable caught, {} explained, {} survive without a reason, {} not tried: {:.1} % of {:.0} % wanted{since}",
        part.name,
        record.caught,
        record.viable,
        record.explained(),
        record.survivors.len() - record.explained(),
        record.untried,
        record.percent(),
        part.wanted_percent
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mutants::record::Survivor;

    /// A record of every part with nothing left alive.
    fn good() -> Vec<Record> {
        let record = |part: &Part| Record {
            name: part.name.clone(),
            wanted_percent: part.wanted_percent,
            viable: 100,
            caught: 100,
            code: "today".to_owned(),
            ..Record::default()
        };
        facts().mutants.iter().map(record).collect()
    }

    /// All records good but that of the part, which is changed.
    fn with(part: &str, change: impl Fn(&mut Record)) -> Claim {
        let mut records = good();
        records.iter_mut().filter(|record| record.name == part).for_each(change);
        judge(Ok(&records), "today")
    }

    fn survivor(line: usize, reason: &str) -> Survivor {
        Survivor {
            file: "core-nostd/guard/src/decide.rs".to_owned(),
            line,
            column: None,
            mutation: "replace < with <=".to_owned(),
            source: "a < b".to_owned(),
            reason: reason.to_owned(),
        }
    }

    fn lines(claim: &Claim) -> Vec<usize> {
        claim.findings.iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn an_unexplained_survivor_fails_where_all_are_wanted() {
        let alive = |reason: &'static str| {
            move |record: &mut Record| {
                record.caught -= 1;
                record.survivors = vec![survivor(7, reason)];
            }
        };
        assert!(judge(Ok(&good()), "today").holds());
        let claim = with("mutants-guard", alive(""));
        assert_eq!(lines(&claim), [0, 7]);
        let words =
            "99 of 100 viable caught, 0 explained, 1 survive without a reason, 0 not tried: 99.0 % of 100 %";
        assert!(claim.evidence.contains(words), "{}", claim.evidence);
        assert!(with("mutants-guard", alive("equal values cannot be")).holds());
        assert!(with("mutants-drivers", alive("")).holds());
    }

    #[test]
    fn a_record_below_its_share_fails() {
        let claim = with("mutants-guard", |record| record.untried = 1);
        assert_eq!(lines(&claim), [0], "what was not tried is not caught");
        assert!(claim.findings[0].message.contains("1 were not tried"), "{:?}", claim.findings);
        assert!(with("mutants-drivers", |record| record.untried = 17).holds());
        assert_eq!(lines(&with("mutants-drivers", |record| record.untried = 18)), [0]);
        let empty = with("mutants-guard", |record| (record.viable, record.caught) = (0, 0));
        assert_eq!(lines(&empty), [0], "of no mutant none is caught");
        let modest = with("mutants-guard", |record| (record.wanted_percent, record.untried) = (1.0, 1));
        assert_eq!(lines(&modest), [0], "the share is the code's, not the record's");
        assert_eq!(lines(&with("mutants-guard", |record| record.caught = 200)), [0]);
    }

    #[test]
    fn a_part_without_a_record_fails() {
        assert_eq!(judge(Ok(&[]), "today").findings.len(), facts().mutants.len());
        let claim = judge(Ok(&good()[1..]), "today");
        assert_eq!(claim.findings.len(), 1);
        assert!(claim.findings[0].message.starts_with(&facts().mutants[0].name), "{:?}", claim.findings);
        assert_eq!(lines(&judge(Ok(&[good(), good()].concat()), "today")).len(), facts().mutants.len());
    }

    #[test]
    fn a_record_that_cannot_be_read_fails() {
        let folder = tempfile::tempdir().expect("a folder");
        let (_, absent) = read(folder.path(), "today");
        assert_eq!(
            absent.findings.iter().map(|finding| finding.place.as_str()).collect::<Vec<_>>(),
            [RECORD]
        );
        let why = records_in("[{]").expect_err("this is no JSON");
        assert!(why.starts_with("is broken"), "{why}");
        assert_eq!(lines(&judge(Err(&why), "today")), [0]);
    }

    #[test]
    fn figures_of_other_code_say_so() {
        assert!(!judge(Ok(&good()), "today").evidence.contains("by "));
        assert!(judge(Ok(&good()), "tomorrow").evidence.contains("core or drivers changed since"));
        let claim = with("mutants-guard", |record| record.code.clear());
        assert!(claim.evidence.contains("code that is not recorded"), "{}", claim.evidence);
    }
}
