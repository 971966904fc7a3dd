//! Keeps what came of a long campaign where the audit shows it.

use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::block::Counts;
use super::{kinds::Kind, matrix};
use crate::audit::sources;
use crate::shell;

const RECORD: &str = "docs/evidence/campaigns.json";

/// The fingerprint of core and drivers as they are now.
pub fn code_today() -> Result<String> {
    Ok(sources::fingerprint(&sources::read_layers(&shell::root())?))
}

/// Puts the result in the place of the last one of the same name and seed. The code is that which the trials ran.
pub fn keep(
    kind: &Kind,
    (seed, trials): (u64, u64),
    findings: usize,
    (counts, code): (&Counts, Option<&str>),
) -> Result<()> {
    let path = shell::root().join(RECORD);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|_| String::from("[]"));
    let records: Vec<Value> = serde_json::from_str(&text).with_context(|| format!("{RECORD} is broken"))?;
    let mut new = entry(kind, (seed, trials), findings, counts);
    new["code"] = json!(code);
    let records = with(records, new);
    std::fs::write(&path, serde_json::to_string_pretty(&records)? + "\n")
        .with_context(|| format!("cannot write {RECORD}"))?;
    println!("recorded in {RECORD}");
    Ok(())
}

fn entry(kind: &Kind, (seed, trials): (u64, u64), findings: usize, counts: &Counts) -> Value {
    let cells = counts.iter().filter(|(name, _)| matrix::is_cell(name));
    let (all, empty) = (cells.clone().count(), cells.filter(|(_, count)| **count == 0).count());
    let mut shown: serde_json::Map<String, Value> = counts
        .iter()
        .filter(|(name, _)| !matrix::is_cell(name))
        .map(|(name, count)| (name.clone(), json!(count)))
        .collect();
    if all > 0 {
        shown.insert(String::from("cells of the matrix"), json!(all));
        shown.insert(String::from("cells without a run"), json!(empty));
    }
    json!({
        "name": format!("{}, seed {seed}", kind.name),
        "what": kind.trial,
        "command": format!("cargo xtask campaign {} --trials {trials} --seed {seed}", kind.name),
        "trials": trials,
        "findings": findings,
        "counts": shown,
    })
}

fn with(mut records: Vec<Value>, new: Value) -> Vec<Value> {
    match records.iter_mut().find(|record| record["name"] == new["name"]) {
        Some(old) => *old = new,
        None => records.push(new),
    }
    records
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::kinds;

    #[test]
    fn a_record_replaces_its_predecessor_and_sums_the_matrix_up() {
        let kind = kinds::find("faults").expect("a campaign");
        let counts = [("cell | a | b | c", 3), ("cell | a | b | d", 0), ("stops", 7)];
        let counts: Counts = counts.into_iter().map(|(name, count)| (name.to_owned(), count)).collect();
        let first = entry(kind, (3, 100), 0, &counts);
        assert_eq!(first["counts"]["cells without a run"], 1);
        assert_eq!((&first["counts"]["stops"], &first["trials"]), (&json!(7), &json!(100)));
        let second = entry(kind, (3, 200), 1, &counts);
        let records = with(with(vec![json!({"name": "other"})], first), second.clone());
        assert_eq!(records, [json!({"name": "other"}), second]);
    }
}
