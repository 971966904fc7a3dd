//! `cargo xtask test`: what CI runs, step by step, with a verdict at the end.

use std::io::{BufRead, BufReader};
use std::process::Stdio;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;

use crate::machine::TARGET;
use crate::{setup, shell};
use embedded_audit::sources;

/// Which part of the test run.
#[derive(Args)]
pub struct Options {
    /// Run only the steps whose name contains this word.
    #[arg(long)]
    only: Option<String>,
}

/// One step: a name, and the words behind `cargo`.
type Step = (&'static str, &'static str);

/// Stands in the words of a step for the target of the firmware.
const ON_TARGET: &str = "TARGET";
/// Stands in the words of a step for the crates of the core and the drivers.
const AUDITED: &str = "AUDITED";

const STEPS: &[Step] = &[
    ("format", "fmt --all --check"),
    ("clippy", "clippy --quiet --workspace --all-targets -- --deny warnings"),
    (
        "robot-program",
        "clippy --quiet --package floorguard --no-default-features --features foxglove,fleet -- --deny warnings",
    ),
    // The writer of the trained detector; the runtime of foreign models takes minutes to compile and is left out.
    ("detector", "clippy --quiet --package floorguard-laboratory --features detector -- --deny warnings"),
    ("no_std", "build --quiet AUDITED --package floorguard-runtime --target TARGET"),
    ("tests", "test --workspace --no-fail-fast"),
    ("firmware", "xtask firmware"),
    ("wired", "xtask firmware --wired --duration 5"),
    ("faults", "xtask firmware --faults few"),
    ("board", "xtask firmware --board stm32h743"),
    ("readers", "xtask check-recording --cuts 20"),
    ("firmware-faults", "xtask campaign firmware-faults --trials 4"),
    // After the firmware, whose figures it shows.
    ("audit", "xtask audit"),
];

/// What the test harnesses counted.
#[derive(Default)]
struct Count {
    passed: u64,
    failed: u64,
}

/// Runs the steps in order; a failed step does not hide the ones after it.
pub fn run(options: &Options) -> Result<bool> {
    if !setup::run()? {
        return Ok(false);
    }
    let mut failed_steps = Vec::new();
    let mut count = Count::default();
    let wanted = |step: &&Step| options.only.as_ref().is_none_or(|word| step.0.contains(word.as_str()));
    for &(name, words) in STEPS.iter().filter(wanted) {
        println!("\n== {name}: cargo {words}");
        let start = Instant::now();
        let succeeded = run_step(name, words, &mut count)?;
        println!(
            "== {name}: {} after {:.0} s",
            if succeeded { "good" } else { "FAILED" },
            start.elapsed().as_secs_f64()
        );
        if !succeeded {
            failed_steps.push(name);
        }
    }
    println!(
        "\nnot run here, because they play in real time or for long: cargo xtask vcan (SocketCAN in a little Linux),"
    );
    println!("cargo xtask firmware --wired (60 s), cargo xtask firmware --faults (all nine)");
    if failed_steps.is_empty() {
        println!("\nall steps are good");
    } else {
        println!("\nfailed: {}; repeat one with: cargo xtask test --only NAME", failed_steps.join(", "));
    }
    println!("{} passed, {} failed", count.passed, count.failed);
    Ok(failed_steps.is_empty())
}

/// Runs one step, shows its output as it comes, and adds up the harnesses' closing lines.
fn run_step(name: &str, words: &str, count: &mut Count) -> Result<bool> {
    let mut command = shell::cargo();
    command.args(arguments(words)).stdin(Stdio::null()).stdout(Stdio::piped());
    let mut child = command.spawn().with_context(|| format!("cannot start cargo for step {name}"))?;
    if let Some(output) = child.stdout.take() {
        for line in BufReader::new(output).lines() {
            let line = line.context("cannot read what cargo prints")?;
            if let Some(result) = line.strip_prefix("test result: ") {
                count.passed += number_before(result, " passed");
                count.failed += number_before(result, " failed");
            }
            println!("{line}");
        }
    }
    Ok(child.wait()?.success())
}

/// The arguments for cargo.
fn arguments(words: &str) -> Vec<&str> {
    let packages = || sources::crates().iter().flat_map(|one| ["--package", one.package.as_str()]).collect();
    let word = |word| match word {
        ON_TARGET => vec![TARGET],
        AUDITED => packages(),
        word => vec![word],
    };
    words.split(' ').flat_map(word).collect()
}

/// The number that stands before `word`, 0 if there is none.
fn number_before(text: &str, word: &str) -> u64 {
    text.find(word)
        .and_then(|end| text.get(..end))
        .and_then(|head| head.rsplit(|c: char| !c.is_ascii_digit()).next())
        .and_then(|digits| digits.parse().ok())
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::{STEPS, TARGET, arguments, number_before};

    #[test]
    fn no_std_step_builds_for_the_board() {
        let (_, words) = STEPS.iter().find(|(name, _)| *name == "no_std").expect("a step");
        assert_eq!(arguments(words).last(), Some(&TARGET));
        assert!(arguments(words).windows(2).any(|pair| pair == ["--package", "floorguard-guard"]));
    }

    #[test]
    fn reads_the_harness_line() {
        let line = "FAILED. 12 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s";
        assert_eq!((number_before(line, " passed"), number_before(line, " failed")), (12, 3));
        assert_eq!(number_before("nothing", " passed"), 0);
    }
}
