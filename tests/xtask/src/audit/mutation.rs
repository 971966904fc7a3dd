//! What the last mutation runs left alive, and whether each survivor has its reason.

use std::path::Path;

use super::claim::{Claim, Finding};
use crate::mutants::{RECORD, Record};

/// Reads the records and judges them.
pub fn read(root: &Path) -> (Vec<Record>, Claim) {
    let text = std::fs::read_to_string(root.join(RECORD)).unwrap_or_default();
    let records: Vec<Record> = serde_json::from_str(&text).unwrap_or_default();
    let claim = judge(&records);
    (records, claim)
}

fn judge(records: &[Record]) -> Claim {
    let too_few = records.iter().filter(|record| record.percent() < record.wanted_percent);
    let findings = too_few.flat_map(|record| {
        record.survivors.iter().filter(|survivor| survivor.reason.is_empty()).map(|survivor| Finding {
            place: survivor.file.clone(),
            line: survivor.line,
            message: format!("no test notices: {}", survivor.mutation),
        })
    });
    let told = records.iter().map(|record| {
        format!(
            "{}: {} of {} viable caught, {} survive, {} not tried, {:.1} % caught or explained",
            record.name,
            record.caught,
            record.viable,
            record.survivors.len(),
            record.untried,
            record.percent()
        )
    });
    Claim {
        id: "mutants-caught",
        text: "The tests notice a spoilt guard or driver; what they cannot notice is explained.",
        evidence: if records.is_empty() {
            String::from("no record; `cargo xtask campaign mutants-guard` makes one")
        } else {
            told.collect::<Vec<_>>().join("; ")
        },
        findings: findings.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mutants::record::Survivor;

    #[test]
    fn an_unexplained_survivor_fails_where_all_are_wanted() {
        let survivor = Survivor {
            file: "core-nostd/src/guard/decide.rs".to_owned(),
            line: 7,
            mutation: "replace < with <=".to_owned(),
            source: "a < b".to_owned(),
            reason: String::new(),
        };
        let survivors = vec![survivor];
        let record = Record { viable: 10, caught: 9, wanted_percent: 100.0, survivors, ..Record::default() };
        let findings = judge(std::slice::from_ref(&record)).findings;
        assert_eq!(findings.iter().map(|finding| finding.line).collect::<Vec<_>>(), [7]);
        let mut explained = record.clone();
        explained.survivors[0].reason = "equal values cannot be".to_owned();
        assert!(judge(&[explained]).holds());
        assert!(judge(&[Record { wanted_percent: 85.0, ..record }]).holds());
    }
}
