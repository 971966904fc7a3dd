//! Keeps what came of a long campaign where the audit shows it.

use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::block::Counts;
use super::state::State;
use super::{matrix, shares};
use crate::facts::{Kind, facts};
use crate::{shell, sources};

const RECORD: &str = "docs/evidence/campaigns.json";

/// What a record tells of the code: the fingerprint of core and drivers and, of a campaign that runs the whole robot, in a
/// second line that of core, drivers, runtime and simulator.
pub fn code_of(kind: &Kind) -> Result<String> {
    let code = sources::code_today()?;
    if !kind.whole_robot {
        return Ok(code);
    }
    let files = sources::read_robot(&shell::root())?;
    Ok(format!("{code}\n{}", sources::fingerprint(&files)))
}

/// What a campaign came to.
pub struct Outcome<'a> {
    kind: &'a Kind,
    seed: u64,
    /// Trials that are done.
    done: u64,
    /// Trials that were asked for, now or before.
    of: u64,
    /// First trial that is not done.
    until: u64,
    /// Blocks that failed, and shares beyond their limits.
    pub findings: usize,
    counts: &'a Counts,
}

impl<'a> Outcome<'a> {
    /// Judges the shares of the campaign: one beyond its limit is a finding as a block that failed is.
    pub fn of((kind, seed): (&'a Kind, u64), state: &'a State, asked: u64, failed: usize) -> Self {
        let of = asked.max(state.trials);
        let until = state.missing(of, kind.block).first().map_or(of, |part| part.start);
        let findings = failed + shares::missed(&kind.name, &state.counts);
        Self { kind, seed, done: state.trials, of, until, findings, counts: &state.counts }
    }

    /// What a trial is; where the campaign did not come to its end, how far it came.
    fn what(&self) -> String {
        let (trial, done, of) = (&self.kind.trial, self.done, self.of);
        if done == of {
            trial.clone()
        } else if self.until == done {
            format!("{trial}; the first {done} trials of {of}")
        } else {
            format!("{trial}; {done} trials of {of}, among them the first {}", self.until.min(done))
        }
    }

    fn entry(&self) -> Value {
        let cells = self.counts.iter().filter(|(name, _)| matrix::is_cell(name));
        let (all, empty) = (cells.clone().count(), cells.filter(|(_, count)| **count == 0).count());
        let others = self.counts.iter().filter(|(name, _)| !matrix::is_cell(name));
        let mut shown: serde_json::Map<String, Value> =
            others.map(|(name, count)| (name.clone(), json!(count))).collect();
        if all > 0 {
            shown.insert(String::from("cells of the matrix"), json!(all));
            shown.insert(String::from("cells without a run"), json!(empty));
        }
        let (name, seed) = (&self.kind.name, self.seed);
        let mut entry = json!({
            "name": format!("{name}, seed {seed}"),
            "what": self.what(),
            "command": format!("{} campaign {name} --trials {} --seed {seed}", facts().command, self.of),
            "trials": self.done,
            "findings": self.findings,
            "counts": shown,
        });
        if self.done < self.of {
            entry["of"] = json!(self.of);
        }
        entry
    }
}

/// Puts the result in the place of the last one of the same name and seed. The code is that which the trials ran.
pub fn keep(came: &Outcome<'_>, code: Option<&str>) -> Result<()> {
    if came.done == 0 {
        println!("no trial is done: nothing is recorded");
        return Ok(());
    }
    let path = shell::root().join(RECORD);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|_| String::from("[]"));
    let records: Vec<Value> = serde_json::from_str(&text).with_context(|| format!("{RECORD} is broken"))?;
    let mut new = came.entry();
    report_code(&mut new, code);
    let records = with(records, new);
    std::fs::write(&path, serde_json::to_string_pretty(&records)? + "\n")
        .with_context(|| format!("cannot write {RECORD}"))?;
    println!("recorded in {RECORD}");
    Ok(())
}

/// `code`: core and drivers, `null` where it is not known. `whole`: runtime and simulator, too, where it was kept.
fn report_code(record: &mut Value, code: Option<&str>) {
    let mut lines = code.into_iter().flat_map(str::lines);
    record["code"] = json!(lines.next());
    if let Some(whole) = lines.next() {
        record["whole"] = json!(whole);
    }
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

    /// Blocks of a campaign that are done, and their counts.
    fn state(kind: &Kind, blocks: &[u64], counts: &[(&str, u64)]) -> State {
        let mut state = State::default();
        state.done.extend(blocks.iter().map(|block| block * kind.block));
        state.trials = blocks.len() as u64 * kind.block;
        state.counts.extend(counts.iter().map(|(name, count)| ((*name).to_owned(), *count)));
        state
    }

    #[test]
    fn record_replaces_predecessor_and_sums_matrix() {
        let kind = kinds::find("faults").expect("a campaign");
        let counts = [("cell | a | b | c", 3), ("cell | a | b | d", 0), ("stops", 7)];
        let entry = |blocks: &[u64], failed| {
            let state = state(kind, blocks, &counts);
            Outcome::of((kind, 3), &state, state.trials, failed).entry()
        };
        let first = entry(&[0], 0);
        assert_eq!(first["counts"]["cells without a run"], 1);
        assert_eq!((&first["counts"]["stops"], &first["trials"]), (&json!(7), &json!(kind.block)));
        let second = entry(&[0, 1], 1);
        let records = with(with(vec![json!({"name": "other"})], first), second.clone());
        assert_eq!(records, [json!({"name": "other"}), second]);
    }

    #[test]
    fn ended_campaign_is_recorded_partially() {
        let kind = kinds::find("claims").expect("a campaign");
        let entry = |blocks: &[u64]| Outcome::of((kind, 1), &state(kind, blocks, &[]), 100, 0).entry();
        let whole = entry(&[0, 1, 2, 3, 4]);
        assert_eq!((&whole["what"], whole.get("of")), (&json!(kind.trial), None));
        let begun = entry(&[0, 1, 2]);
        assert_eq!((&begun["trials"], &begun["of"]), (&json!(60), &json!(100)));
        assert_eq!(begun["command"], "cargo xtask campaign claims --trials 100 --seed 1");
        let what = |entry: &Value| entry["what"].as_str().map(str::to_owned).unwrap_or_default();
        assert!(what(&begun).ends_with("; the first 60 trials of 100"), "{}", what(&begun));
        let gap = entry(&[0, 2, 3]);
        assert!(what(&gap).ends_with("; 60 trials of 100, among them the first 20"), "{}", what(&gap));
    }

    #[test]
    fn record_has_robot_code_where_it_ran() {
        let reported = |code| {
            let mut record = json!({});
            report_code(&mut record, code);
            record
        };
        assert_eq!(reported(None), json!({ "code": null }));
        assert_eq!(reported(Some("12ab")), json!({ "code": "12ab" }));
        assert_eq!(reported(Some("12ab\n34cd")), json!({ "code": "12ab", "whole": "34cd" }));
        let lines =
            |name| code_of(kinds::find(name).expect("a campaign")).expect("the sources").lines().count();
        assert_eq!((lines("model"), lines("faults")), (1, 2));
    }

    #[test]
    fn missed_share_is_recorded_as_finding() {
        let kind = kinds::find("claims").expect("a campaign");
        let findings = |falsely| {
            let counts = [("falsely with faults", falsely), ("claimed with faults", 10_000)];
            Outcome::of((kind, 1), &state(kind, &[0], &counts), 20, 0).entry()["findings"].clone()
        };
        assert_eq!((findings(20), findings(200)), (json!(0), json!(1)));
    }
}
