//! Runs the tests of the requirements, and reads what came of each.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Stdio;

use anyhow::{Context, Result};

use crate::shell;

/// What came of the tests.
#[derive(Default)]
pub struct Results {
    /// By the name of the function. A name that stands in several places must pass in all.
    pub passed: BTreeMap<String, bool>,
    /// State and following state, as the search over the guard's states prints them.
    pub transitions: BTreeSet<(String, String)>,
}

/// Runs them.
pub fn run(targets: &BTreeSet<String>) -> Result<Results> {
    let mut command = shell::cargo();
    command.args(["test", "--quiet", "--no-fail-fast", "--package", "floorguard-core"]);
    command.args(["--package", "floorguard-drivers", "--package", "floorguard-tests", "--lib"]);
    for target in targets {
        command.args(["--test", target]);
    }
    command
        .args(["--", "--format=pretty", "--show-output", "fg_req_"])
        .stdin(Stdio::null())
        .stderr(Stdio::inherit());
    let output = command.output().context("cannot start cargo test")?;
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(Results { passed: results_in(&text), transitions: transitions_in(&text) })
}

/// Lines `campaign: FROM to TO = NUMBER`.
fn transitions_in(text: &str) -> BTreeSet<(String, String)> {
    let counted = text.lines().filter_map(|line| line.strip_prefix("campaign: ")?.split_once(" = "));
    let pairs = counted.filter_map(|(name, _)| name.split_once(" to "));
    pairs.map(|(from, to)| (from.to_owned(), to.to_owned())).collect()
}

/// Lines `test PATH ... ok`. A test that prints has its result on a later line, which counts for nothing.
fn results_in(text: &str) -> BTreeMap<String, bool> {
    let mut results = BTreeMap::new();
    for line in text.lines() {
        let Some((name, result)) = line.strip_prefix("test ").and_then(|rest| rest.split_once(" ... "))
        else {
            continue;
        };
        let name = name.rsplit("::").next().unwrap_or(name).to_owned();
        let passed = result.trim() == "ok";
        results.entry(name).and_modify(|all: &mut bool| *all &= passed).or_insert(passed);
    }
    results
}

#[cfg(test)]
mod tests {
    use super::{results_in, transitions_in};

    #[test]
    fn harness_lines_are_read() {
        let text = "running 3 tests\ntest a::fg_req_001_x ... ok\ntest b::fg_req_002_y ... FAILED\ntest c::fg_req_001_x ... FAILED\n";
        let results: Vec<_> = results_in(text).into_iter().collect();
        assert_eq!(results, [("fg_req_001_x".to_owned(), false), ("fg_req_002_y".to_owned(), false)]);
    }

    #[test]
    fn transitions_are_read() {
        let text = "---- x stdout ----\ncampaign: states = 7\ncampaign: Run to Stop = 3\n";
        assert_eq!(
            transitions_in(text).into_iter().collect::<Vec<_>>(),
            [("Run".to_owned(), "Stop".to_owned())]
        );
    }
}
