//! The long runs: what was aimed at, what has been reached.

use serde::Serialize;
use serde_json::Value;

use super::table::{Table, aside, code, escape, grouped, verdict};
use crate::facts::{Goal, facts};
use crate::records::since::{CodeToday, Since};

/// How far an aim has been reached.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct Reached {
    /// What is counted.
    pub what: &'static str,
    /// The campaign.
    pub campaign: &'static str,
    /// Of one recorded run without a finding: runs of an older state of the code do not add up with those of a newer
    /// one, and a run that found something is reported beside it.
    pub reached: u64,
    /// What is aimed at.
    pub aim: u64,
    /// Whether the code is still the one of that run.
    pub code: Since,
    /// Findings of the other recorded runs, each of which was mended since.
    pub findings_of_other_runs: u64,
    /// Recorded runs that do not say how many findings they had: nothing of them counts.
    pub without_findings_reported: u64,
}

/// What the records say of one campaign.
#[derive(Debug, Default, PartialEq, Eq)]
struct Sum {
    /// The run that counts, and its code: one that reaches the aim with the code of today, or else the longest.
    best: Option<(u64, Since)>,
    findings: u64,
    unreported: u64,
}

fn sum(records: &[Value], (campaign, count, aim): (&str, &str, u64), today: &CodeToday) -> Sum {
    let of_it = records.iter().filter(|record| {
        record["name"].as_str().is_some_and(|name| name.split(", seed").next() == Some(campaign))
    });
    let mut sum = Sum::default();
    for record in of_it {
        let counted = if count == "trials" { &record["trials"] } else { &record["counts"][count] };
        match record["findings"].as_u64() {
            Some(0) => {
                let run = (counted.as_u64().unwrap_or(0), Since::of_campaign(record, today));
                let rank = |(reached, code): (u64, Since)| (reached >= aim && code == Since::Same, reached);
                sum.best = sum.best.into_iter().chain([run]).max_by_key(|run| rank(*run));
            }
            Some(findings) => sum.findings += findings,
            None => sum.unreported += 1,
        }
    }
    sum
}

/// Every aim with what was reached.
pub fn list(records: Option<&Value>, today: &CodeToday) -> Vec<Reached> {
    let none = vec![];
    let records = records.and_then(Value::as_array).unwrap_or(&none);
    let entry = |goal: &'static Goal| {
        let Goal { what, campaign, count, aim } = goal;
        let Sum { best, findings, unreported } = sum(records, (campaign, count, *aim), today);
        let (reached, code) = best.unwrap_or((0, Since::NotRecorded));
        let (findings_of_other_runs, without_findings_reported) = (findings, unreported);
        Reached {
            what,
            campaign,
            reached,
            aim: *aim,
            code,
            findings_of_other_runs,
            without_findings_reported,
        }
    };
    facts().goal.iter().map(entry).collect()
}

/// In colour only what says something of the code as it is.
fn judged(line: &Reached) -> String {
    if line.reached == 0 {
        return verdict(false, "not run at length without a finding");
    }
    if line.reached < line.aim {
        let share = (100.0 * line.reached as f64 / line.aim as f64).min(99.9);
        return verdict(false, &format!("{share:.1} %"));
    }
    match line.code {
        Since::Same => verdict(true, "reached, by the code of today"),
        Since::Changed => aside("reached, by earlier code"),
        Since::NotRecorded => aside("reached, code not recorded"),
    }
}

/// Aims beside what was reached.
pub fn section(records: Option<&Value>, today: &CodeToday) -> String {
    let mut table = Table::new(&["what", "reached", "aim", "", "campaign"]);
    for line in list(records, today) {
        let reported = match line.findings_of_other_runs {
            0 => String::new(),
            1 => String::from("; 1 finding of another run, reported below"),
            findings => format!("; {findings} findings of other runs, reported below"),
        };
        let unreported = match line.without_findings_reported {
            0 => String::new(),
            records => format!("; {records} recorded without a number of findings, not counted"),
        };
        table.row(&[
            escape(line.what),
            format!("{}{reported}{unreported}", grouped(line.reached)),
            grouped(line.aim),
            judged(&line),
            code(line.campaign),
        ]);
    }
    format!(
        "<p>Counted is the longest recorded run without a finding, or one that reached the aim with the code of today; never the sum \
         of several. Aims are no claims: the verdict of \
         this page does not wait for them. A row in red is work that is still to be run; the command is in the table below, and \
         goes on where it was cut. A row in grey was reached with the code as it was, or by a record that does not \
         keep its fingerprint. The last two aims are our own: the messages of a decoder are the wires', recordings and whole \
         worlds are read a hundred to ten thousand times as slowly.</p>{}",
        table.finish()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn today() -> CodeToday {
        CodeToday { code: "today".to_owned(), whole: "all of today".to_owned() }
    }

    #[test]
    fn the_longest_run_without_a_finding_counts() {
        let records = serde_json::json!([
            {"name": "faults, seed 1", "trials": 50, "findings": 1, "counts": {}},
            {"name": "faults, seed 2", "trials": 20, "findings": 0, "counts": {}},
            {"name": "faults, seed 3", "trials": 30, "findings": 0, "counts": {}},
            {"name": "model, seed 1", "trials": 5, "findings": 0, "counts": {"steps": 100}},
        ]);
        let list_of = list(Some(&records), &today());
        let records = records.as_array().expect("a list");
        let faults = sum(records, ("faults", "trials", 100), &today());
        assert_eq!((faults.best, faults.findings), (Some((30, Since::NotRecorded)), 1));
        assert_eq!(list_of.len(), facts().goal.len());
        assert_eq!((list_of[0].reached, list_of[0].aim), (100, 100_000_000));
        assert_eq!(list_of[1].reached, 0, "no record of it");
    }

    fn flips(record: &Value) -> String {
        let listed = list(Some(&Value::Array(vec![record.clone()])), &today());
        judged(listed.iter().find(|line| line.campaign == "flips").expect("an aim"))
    }

    #[test]
    fn only_the_code_of_today_is_green() {
        let mut record =
            serde_json::json!({"name": "flips, seed 1", "findings": 0, "counts": {"moments": 1_000}});
        assert_eq!(flips(&record), aside("reached, code not recorded"));
        record["code"] = "yesterday".into();
        assert_eq!(flips(&record), aside("reached, by earlier code"));
        record["code"] = "today".into();
        assert_eq!(flips(&record), verdict(true, "reached, by the code of today"));
        record["counts"]["moments"] = 999.into();
        assert_eq!(flips(&record), verdict(false, "99.9 %"));
        let run = |moments: u64, code: &str| serde_json::json!({"name": "flips, seed 1", "findings": 0, "code": code, "counts": {"moments": moments}});
        let best = |runs: &[Value]| sum(runs, ("flips", "moments", 1_000), &today()).best;
        assert_eq!(best(&[run(1_000, "today"), run(9_000, "old")]), Some((1_000, Since::Same)));
        assert_eq!(best(&[run(900, "today"), run(9_000, "old")]), Some((9_000, Since::Changed)));
    }

    #[test]
    fn run_without_findings_counts_for_nothing() {
        for findings in [Value::Null, "0".into()] {
            let record = serde_json::json!([{"name": "flips, seed 1", "findings": findings, "counts": {"moments": 2_000}}]);
            let line = &list(Some(&record), &today())[1];
            assert_eq!((line.campaign, line.reached, line.without_findings_reported), ("flips", 0, 1));
            assert!(section(Some(&record), &today()).contains("1 recorded without a number of findings"));
        }
    }

    /// Where the whole robot ran, another runtime or simulator is another code.
    #[test]
    fn whole_robot_code_counts_where_it_ran() {
        let since = |whole: Value| {
            let record = serde_json::json!({"code": "today", "whole": whole});
            Since::of_campaign(&record, &today())
        };
        assert_eq!(since(Value::Null), Since::Same, "core and drivers alone ran");
        assert_eq!(since("all of today".into()), Since::Same);
        assert_eq!(since("all of yesterday".into()), Since::Changed);
    }
}
