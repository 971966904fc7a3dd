//! Runs the tests of the requirements, and reads what came of each.

use std::collections::{BTreeMap, BTreeSet};
use std::process::{Child, Command, Stdio};

use anyhow::{Context, Result};
use serde::Serialize;

use crate::shell;

/// What came of the tests.
#[derive(Default)]
pub struct Results {
    /// By the name of the function. A name that stands in several places must pass in all.
    pub passed: BTreeMap<String, bool>,
    /// What the search over the guard's states prints.
    pub explored: Explored,
    /// What each cause demands and how it clears, as the guard's own table says.
    pub causes: Vec<CauseLine>,
}

/// What the search over all reachable states of the guard saw.
#[derive(Default, Serialize)]
pub struct Explored {
    /// States that differ in more than the clock.
    pub states: u64,
    /// Steps between them, each of which was judged.
    pub steps: u64,
    /// Each pair of a shown state and the one that followed.
    pub transitions: Vec<Transition>,
}

/// A shown state that followed another, or itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Transition {
    /// The state before.
    pub from: String,
    /// The state after.
    pub to: String,
    /// Steps of the search that went this way.
    pub steps: u64,
}

/// One cause of the guard.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct CauseLine {
    /// Its name in the code.
    pub cause: String,
    /// What it demands.
    pub action: String,
    /// How it may clear.
    pub clears: String,
    /// Where the robot may leave to meanwhile.
    pub escape: String,
    /// What people read.
    pub words: String,
}

/// Begins to build them: the safety image is linked as one piece meanwhile, which leaves all cores but one idle.
pub fn build(targets: &BTreeSet<String>) -> Result<Building> {
    let mut command = command(targets);
    command.arg("--no-run").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    Ok(Building(command.spawn().context("cannot start cargo test")?))
}

/// A compiler at work. It is stopped where nobody waits for it.
pub struct Building(Child);

impl Drop for Building {
    fn drop(&mut self) {
        // Where it has ended already there is nothing to stop.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn command(targets: &BTreeSet<String>) -> Command {
    let mut command = shell::cargo();
    // With the features of the workspace's tests: of some packages alone, most dependencies would be compiled once more.
    command.args(["test", "--quiet", "--no-fail-fast", "--workspace", "--lib"]);
    for target in targets {
        command.args(["--test", target]);
    }
    command
}

/// Runs them as soon as they are built, well or not: here the compiler speaks.
pub fn run(mut building: Building, targets: &BTreeSet<String>) -> Result<Results> {
    building.0.wait().context("cannot wait for cargo test")?;
    let mut command = command(targets);
    command
        .args(["--", "--format=pretty", "--show-output", "fg_req_"])
        .stdin(Stdio::null())
        .stderr(Stdio::inherit());
    let output = command.output().context("cannot start cargo test")?;
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(Results { passed: results_in(&text), explored: explored_in(&text), causes: causes_in(&text) })
}

/// Lines `campaign: states = NUMBER` and `campaign: FROM to TO = NUMBER`.
fn explored_in(text: &str) -> Explored {
    let mut explored = Explored::default();
    let counted = text.lines().filter_map(|line| line.strip_prefix("campaign: ")?.split_once(" = "));
    for (name, count) in counted {
        let steps = count.trim().parse().unwrap_or(0);
        if name == "states" {
            explored.states = steps;
        } else if let Some((from, to)) = name.split_once(" to ") {
            explored.steps += steps;
            let (from, to) = (from.to_owned(), to.to_owned());
            explored.transitions.push(Transition { from, to, steps });
        }
    }
    explored
}

/// Lines `cause: NAME | ACTION | CLEARS | ESCAPE | WORDS`. One of another form is left out; the claim on the causes misses it.
fn causes_in(text: &str) -> Vec<CauseLine> {
    let lines = text.lines().filter_map(|line| line.strip_prefix("cause: "));
    let cells = lines.filter_map(|line| {
        let cells: Vec<&str> = line.split(" | ").map(str::trim).collect();
        let &[cause, action, clears, escape, words] = cells.as_slice() else { return None };
        let [cause, action, clears, escape, words] =
            [cause, action, clears, escape, words].map(str::to_owned);
        Some(CauseLine { cause, action, clears, escape, words })
    });
    cells.collect()
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
    use super::{causes_in, explored_in, results_in};

    #[test]
    fn harness_lines_are_read() {
        let text = "running 3 tests\ntest a::fg_req_001_x ... ok\ntest b::fg_req_002_y ... FAILED\ntest c::fg_req_001_x ... FAILED\n";
        let results: Vec<_> = results_in(text).into_iter().collect();
        assert_eq!(results, [("fg_req_001_x".to_owned(), false), ("fg_req_002_y".to_owned(), false)]);
    }

    #[test]
    fn what_was_explored_is_read() {
        let text = "---- x stdout ----\ncampaign: states = 7\ncampaign: transitions = 4\ncampaign: Run to Run = 1\n\
                    campaign: Run to Stop = 3\n";
        let explored = explored_in(text);
        assert_eq!((explored.states, explored.steps, explored.transitions.len()), (7, 4, 2));
        assert_eq!((explored.transitions[1].to.as_str(), explored.transitions[1].steps), ("Stop", 3));
    }

    #[test]
    fn causes_are_read() {
        let text =
            "cause: Warning | limit | Quiet(500000) | Never | obstacle in the warning field\ncause: cut\n";
        let causes = causes_in(text);
        assert_eq!(causes.len(), 1);
        assert_eq!((causes[0].cause.as_str(), causes[0].clears.as_str()), ("Warning", "Quiet(500000)"));
        assert_eq!(causes[0].words, "obstacle in the warning field");
    }
}
