//! One block of a campaign: the test in a process of its own, so that a crash is a finding and not an end.

use std::collections::BTreeMap;
use std::os::unix::process::ExitStatusExt as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::facts::{Kind, facts};
use crate::shell;

/// Builds the test, optimised but with overflow checks, and tells where it is.
///
/// Cargo unites the features of the packages that are selected: of one package alone, most dependencies would be compiled once more
/// than for the tests of the workspace.
pub fn build(kind: &Kind) -> Result<PathBuf> {
    let mut command = shell::cargo();
    command.args(["test", "--quiet", "--no-run", "--message-format=json", "--workspace"]);
    command.args(&kind.target).stderr(Stdio::inherit());
    let output = command.output().context("cannot start cargo")?;
    if !output.status.success() {
        bail!("the test of campaign {} does not build", kind.name);
    }
    let messages = String::from_utf8_lossy(&output.stdout);
    let found = shell::test_executable(&messages, &kind.package);
    found.with_context(|| format!("cargo names no test executable of {}", kind.package))
}

/// What every block of a campaign runs.
pub struct Program {
    /// The test.
    pub test: PathBuf,
    /// The firmware that it plays tapes on, where it does.
    pub firmware: Option<PathBuf>,
}

/// Runs the trials; what was counted, or the output of the run that failed. Nothing was counted when somebody ended the
/// block: Ctrl-C at a terminal reaches it, too.
pub fn run(
    program: &Program,
    kind: &Kind,
    seed: u64,
    trials: std::ops::Range<u64>,
) -> Result<Option<Counts>, String> {
    let test = &program.test;
    let mut command = Command::new(test);
    if let Some(firmware) = &program.firmware {
        command.env(facts().variable("TAPE_IMAGE"), firmware);
    }
    let output = command
        .args(["--exact", &kind.test, "--nocapture", "--test-threads=1"])
        .env(facts().variable("CAMPAIGN_SEED"), seed.to_string())
        .env(facts().variable("CAMPAIGN_FROM"), trials.start.to_string())
        .env(facts().variable("CAMPAIGN_TO"), trials.end.to_string())
        .env("RUST_BACKTRACE", "0")
        .env("RUST_MIN_STACK", "33554432")
        .current_dir(shell::root().join("tests"))
        .output()
        .map_err(|error| format!("cannot start {}: {error}", test.display()))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let counts = counts_in(&text);
    if output.status.success() && !counts.is_empty() {
        return Ok(Some(counts));
    }
    if output.status.signal().is_some_and(|signal| [SIGINT, SIGTERM, SIGHUP].contains(&signal)) {
        return Ok(None);
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    Err(format!("{}: {text}{errors}", output.status))
}

/// What a run counted, by name.
pub type Counts = BTreeMap<String, u64>;

/// Lines `campaign: NAME = NUMBER`. The harness writes its own words before the first.
fn counts_in(text: &str) -> Counts {
    let counted = text.lines().filter_map(|line| line.split_once("campaign: "));
    let pairs = counted.filter_map(|(_, pair)| pair.split_once(" = "));
    pairs.filter_map(|(name, number)| Some((name.to_owned(), number.trim().parse().ok()?))).collect()
}

#[cfg(test)]
mod tests {
    use super::{Program, counts_in, run};
    use crate::facts::facts;

    #[test]
    fn crashed_block_is_a_finding_ended_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let ends_by = |what: &str| {
            let test = folder.path().join("block");
            // Started in the background, a test inherits that an interrupt is ignored.
            let default = "env --default-signal=INT,TERM,HUP";
            std::fs::write(&test, format!("#!/bin/sh\nexec {default} sh -c '{what}'\n")).unwrap();
            let executable = std::os::unix::fs::PermissionsExt::from_mode(0o755);
            std::fs::set_permissions(&test, executable).unwrap();
            run(&Program { test, firmware: None }, &facts().campaign[0], 1, 0..2)
        };
        let counted = ends_by("echo campaign: steps = 3").unwrap().unwrap();
        assert_eq!(counted["steps"], 3);
        for signal in ["INT", "TERM", "HUP"] {
            assert_eq!(ends_by(&format!("kill -{signal} $$")), Ok(None), "{signal}");
        }
        for crash in ["kill -SEGV $$", "kill -ABRT $$", "kill -KILL $$", "exit 101"] {
            assert!(ends_by(crash).is_err(), "{crash}");
        }
    }

    #[test]
    fn counts_are_read_after_harness_output() {
        let counts = counts_in("running 1 test\ntest f ... campaign: steps = 12\ncampaign: stops = 3\nok\n");
        assert_eq!(counts.into_iter().collect::<Vec<_>>(), [("steps".into(), 12), ("stops".into(), 3)]);
    }
}
