//! The long runs: what was aimed at, what has been reached.

use serde::Serialize;
use serde_json::Value;

use super::table::{Table, code, escape, grouped, verdict};

/// What is counted towards an aim: name, campaign, its count (`trials` or one of its counts), the aim.
const GOALS: &[(&str, &str, &str, u64)] = &[
    ("steps on which two models of the guard agree", "model", "steps", 100_000_000),
    ("moments at which every bit of the state was flipped", "flips", "moments", 1_000),
    ("hosted runs with a fault", "faults", "trials", 100_000),
    ("runs with a fault on the emulated Cortex-M7", "firmware-faults", "runs", 1_000),
    ("damaged Velodyne packets", "fuzz-velodyne", "executions", 100_000_000),
    ("damaged position packets", "fuzz-position", "executions", 100_000_000),
    ("damaged S300 telegrams", "fuzz-s300", "executions", 100_000_000),
    ("damaged microScan3 messages", "fuzz-microscan3", "executions", 100_000_000),
    ("damaged Xsens messages", "fuzz-xsens", "executions", 100_000_000),
    ("damaged SLCAN lines", "fuzz-slcan", "executions", 100_000_000),
    ("damaged frames to the base", "fuzz-base", "executions", 100_000_000),
    ("damaged configurations", "fuzz-configuration", "executions", 100_000_000),
    ("damaged recordings", "fuzz-recording", "executions", 1_000_000),
    ("worlds with many faults at once", "fuzz-runtime", "trials", 100_000),
];

/// How far an aim has been reached.
#[derive(Debug, Default, PartialEq, Eq, Serialize)]
pub struct Reached {
    /// What is counted.
    pub what: &'static str,
    /// The campaign.
    pub campaign: &'static str,
    /// Of the longest recorded run without a finding: runs of an older state of the code do not add up with those of a
    /// newer one, and a run that found something is told beside it.
    pub reached: u64,
    /// What is aimed at.
    pub aim: u64,
    /// Findings of the other recorded runs, each of which was mended since.
    pub findings_of_other_runs: u64,
}

fn reached(records: &[Value], campaign: &str, count: &str) -> (u64, u64) {
    let of_it = records.iter().filter(|record| {
        record["name"].as_str().is_some_and(|name| name.split(", seed").next() == Some(campaign))
    });
    of_it.fold((0, 0), |(most, all_findings), record| {
        let counted = if count == "trials" { &record["trials"] } else { &record["counts"][count] };
        let findings = record["findings"].as_u64().unwrap_or(0);
        let counted = if findings == 0 { counted.as_u64().unwrap_or(0) } else { 0 };
        (most.max(counted), all_findings + findings)
    })
}

/// Every aim with what was reached.
pub fn list(records: Option<&Value>) -> Vec<Reached> {
    let none = vec![];
    let records = records.and_then(Value::as_array).unwrap_or(&none);
    let entry = |(what, campaign, count, aim): &(&'static str, &'static str, &str, u64)| {
        let (reached, findings_of_other_runs) = reached(records, campaign, count);
        Reached { what, campaign, reached, aim: *aim, findings_of_other_runs }
    };
    GOALS.iter().map(entry).collect()
}

/// Aims beside what was reached.
pub fn section(records: Option<&Value>) -> String {
    let mut table = Table::new(&["what", "reached", "aim", "", "campaign"]);
    for line in list(records) {
        let words = match line.reached {
            0 => String::from("not run at length without a finding"),
            reached if reached >= line.aim => String::from("reached"),
            reached => format!("{:.1} %", (100.0 * reached as f64 / line.aim as f64).min(99.9)),
        };
        let told = match line.findings_of_other_runs {
            0 => String::new(),
            1 => String::from("; 1 finding of another run, told below"),
            findings => format!("; {findings} findings of other runs, told below"),
        };
        table.row(&[
            escape(line.what),
            format!("{}{told}", grouped(line.reached)),
            grouped(line.aim),
            verdict(line.reached >= line.aim, &words),
            code(line.campaign),
        ]);
    }
    format!(
        "<p>Counted is the longest recorded run without a finding, never the sum of several. Aims are no claims: the verdict of \
         this page does not wait for them. A row in red is work that is still to be run; the command is in the table below, and \
         goes on where it was cut. The last two aims are our own: the messages of a decoder are the wires', recordings and whole \
         worlds are read a hundred to ten thousand times as slowly.</p>{}",
        table.finish()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_run_without_a_finding_counts() {
        let records = serde_json::json!([
            {"name": "faults, seed 1", "trials": 50, "findings": 1, "counts": {}},
            {"name": "faults, seed 2", "trials": 20, "findings": 0, "counts": {}},
            {"name": "faults, seed 3", "trials": 30, "findings": 0, "counts": {}},
            {"name": "model, seed 1", "trials": 5, "findings": 0, "counts": {"steps": 100}},
        ]);
        let list_of = list(Some(&records));
        let records = records.as_array().expect("a list");
        assert_eq!(reached(records, "faults", "trials"), (30, 1));
        assert_eq!(reached(records, "model", "steps"), (100, 0));
        assert_eq!(list_of.len(), GOALS.len());
        assert_eq!((list_of[0].reached, list_of[0].aim), (100, 100_000_000));
    }
}
