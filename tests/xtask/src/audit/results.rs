//! Runs the tests of the requirements, and reads what came of each.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Stdio;

use anyhow::{Context, Result};

use crate::shell;

/// Result of each test by the name of its function. A name that stands in several places must pass in all.
pub fn run(targets: &BTreeSet<String>) -> Result<BTreeMap<String, bool>> {
    let mut command = shell::cargo();
    command.args(["test", "--quiet", "--no-fail-fast", "--package", "floorguard-core"]);
    command.args(["--package", "floorguard-drivers", "--package", "floorguard-tests", "--lib"]);
    for target in targets {
        command.args(["--test", target]);
    }
    command.args(["--", "--format=pretty", "fg_req_"]).stdin(Stdio::null()).stderr(Stdio::inherit());
    let output = command.output().context("cannot start cargo test")?;
    Ok(results_in(&String::from_utf8_lossy(&output.stdout)))
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
    use super::results_in;

    #[test]
    fn harness_lines_are_read() {
        let text = "running 3 tests\ntest a::fg_req_001_x ... ok\ntest b::fg_req_002_y ... FAILED\ntest c::fg_req_001_x ... FAILED\n";
        let results: Vec<_> = results_in(text).into_iter().collect();
        assert_eq!(results, [("fg_req_001_x".to_owned(), false), ("fg_req_002_y".to_owned(), false)]);
    }
}
