//! The long runs: what was aimed at, what has been reached.

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
    ("damaged recordings", "fuzz-recording", "executions", 100_000_000),
    ("worlds with many faults at once", "fuzz-runtime", "trials", 100_000),
];

/// Sum over the records of a campaign, and their findings.
fn reached(records: &[Value], campaign: &str, count: &str) -> (u64, u64) {
    let of_it = records.iter().filter(|record| {
        record["name"].as_str().is_some_and(|name| name.split(", seed").next() == Some(campaign))
    });
    of_it.fold((0, 0), |(sum, findings), record| {
        let counted = if count == "trials" { &record["trials"] } else { &record["counts"][count] };
        (sum + counted.as_u64().unwrap_or(0), findings + record["findings"].as_u64().unwrap_or(0))
    })
}

/// Aims beside what was reached.
pub fn section(records: Option<&Value>) -> String {
    let none = vec![];
    let records = records.and_then(Value::as_array).unwrap_or(&none);
    let mut table = Table::new(&["what", "reached", "aim", "", "campaign"]);
    for (what, campaign, count, aim) in GOALS {
        let (sum, findings) = reached(records, campaign, count);
        let words = match sum {
            0 => String::from("not run at length"),
            sum if sum >= *aim => String::from("reached"),
            sum => format!("{:.1} %", (100.0 * sum as f64 / *aim as f64).min(99.9)),
        };
        let told = if findings > 0 { format!("; {findings} findings, told below") } else { String::new() };
        table.row(&[
            escape(what),
            format!("{}{told}", grouped(sum)),
            grouped(*aim),
            verdict(sum >= *aim, &words),
            code(campaign),
        ]);
    }
    format!(
        "<p>Aims are no claims: the verdict of this page does not wait for them. A row in red is work that is still to be \
         run; the command is in the table below, and goes on where it was cut.</p>{}",
        table.finish()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_a_campaign_are_added_up() {
        let records = serde_json::json!([
            {"name": "faults, seed 1", "trials": 10, "findings": 1, "counts": {}},
            {"name": "faults, seed 2", "trials": 20, "findings": 0, "counts": {}},
            {"name": "model, seed 1", "trials": 5, "findings": 0, "counts": {"steps": 100}},
        ]);
        let records = records.as_array().expect("a list");
        assert_eq!(reached(records, "faults", "trials"), (30, 1));
        assert_eq!(reached(records, "model", "steps"), (100, 0));
    }
}
