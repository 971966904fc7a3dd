//! `cargo xtask test`: what CI runs, step by step, with a verdict at the end.

use std::io::{self, BufRead, BufReader};
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow};
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
/// Steps that run side by side: of an image that is linked as one piece, the compiler keeps one core busy and leaves the others idle.
type Group = &'static [Step];

/// Stands in the words of a step for the target of the firmware.
const ON_TARGET: &str = "TARGET";
/// Stands in the words of a step for the crates of the core and the drivers.
const AUDITED: &str = "AUDITED";

const GROUPS: &[Group] = &[
    &[("format", "fmt --all --check")],
    // With the writer of the trained detector; the runtime of foreign models takes minutes to compile and is left out.
    &[(
        "clippy",
        "clippy --quiet --workspace --all-targets --features floorguard-laboratory/detector -- --deny warnings",
    )],
    &[(
        "robot-program",
        "clippy --quiet --package floorguard --no-default-features --features foxglove,fleet,ros2 -- --deny warnings",
    )],
    &[("no_std", "build --quiet AUDITED --package floorguard-runtime --target TARGET")],
    &[("tests", "test --workspace --no-fail-fast")],
    &[("firmware", "xtask firmware"), ("board", "xtask firmware --board stm32h743")],
    &[("wired", "xtask firmware --wired --duration 5")],
    &[("faults", "xtask firmware --faults few")],
    &[("readers", "xtask check-recording --cuts 20")],
    &[("ros2", "xtask check-ros2")],
    // The audit after the firmware, whose figures it shows.
    &[("firmware-faults", "xtask campaign firmware-faults --trials 4"), ("audit", "xtask audit")],
];

/// What the test harnesses counted.
#[derive(Default)]
struct Count {
    passed: u64,
    failed: u64,
}

/// Runs the groups in order; a failed step does not hide the ones after it.
pub fn run(options: &Options) -> Result<bool> {
    if !setup::run()? {
        return Ok(false);
    }
    let mut failed_steps = Vec::new();
    let mut count = Count::default();
    for group in GROUPS {
        for step in run_group(group, options.only.as_deref())? {
            count.passed += step.count.passed;
            count.failed += step.count.failed;
            if !step.succeeded {
                failed_steps.push(step.name);
            }
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

/// What a step did.
struct Ended {
    name: &'static str,
    succeeded: bool,
    count: Count,
    duration: Duration,
    /// Output that was not shown as it came.
    kept: String,
}

/// Runs the wanted steps of a group side by side. The first shows its output as it comes, the others theirs when their turn comes.
fn run_group(group: Group, only: Option<&str>) -> Result<Vec<Ended>> {
    let wanted = group.iter().filter(|(name, _)| only.is_none_or(|word| name.contains(word)));
    thread::scope(|scope| {
        let begun: Vec<_> = wanted
            .enumerate()
            .map(|(place, step)| (step, scope.spawn(move || run_step(step, place == 0))))
            .collect();
        let ended = begun.into_iter().map(|(&(name, words), step)| {
            let step = step.join().map_err(|_| anyhow!("step {name} was cut off"))??;
            if !step.kept.is_empty() {
                println!("\n== {name}: cargo {words}\n{}", step.kept);
            }
            let verdict = if step.succeeded { "good" } else { "FAILED" };
            println!("== {name}: {verdict} after {:.0} s", step.duration.as_secs_f64());
            Ok(step)
        });
        ended.collect()
    })
}

/// Runs one step, shows or keeps its output, and adds up the harnesses' closing lines.
fn run_step(&(name, words): &Step, is_shown: bool) -> Result<Ended> {
    let start = Instant::now();
    let mut command = shell::cargo();
    command.args(arguments(words)).stdin(Stdio::null()).stdout(Stdio::piped());
    if is_shown {
        println!("\n== {name}: cargo {words}");
    } else {
        command.stderr(Stdio::piped());
    }
    let mut child = command.spawn().with_context(|| format!("cannot start cargo for step {name}"))?;
    let errors = child.stderr.take().map(|errors| thread::spawn(move || io::read_to_string(errors)));
    let (mut count, mut kept) = (Count::default(), String::new());
    for line in child.stdout.take().into_iter().flat_map(|output| BufReader::new(output).lines()) {
        let line = line.context("cannot read what cargo prints")?;
        if let Some(result) = line.strip_prefix("test result: ") {
            count.passed += number_before(result, " passed");
            count.failed += number_before(result, " failed");
        }
        if is_shown {
            println!("{line}");
        } else {
            kept.extend([&line, "\n"]);
        }
    }
    if let Some(errors) = errors {
        kept += &errors.join().map_err(|_| anyhow!("the errors of step {name} were cut off"))??;
    }
    let succeeded = child.wait()?.success();
    Ok(Ended { name, succeeded, count, duration: start.elapsed(), kept })
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
    use super::{GROUPS, TARGET, arguments, number_before, run_group, run_step};

    #[test]
    fn no_std_step_builds_for_the_board() {
        let (_, words) = GROUPS.concat().into_iter().find(|(name, _)| *name == "no_std").expect("a step");
        assert_eq!(arguments(words).last(), Some(&TARGET));
        assert!(arguments(words).windows(2).any(|pair| pair == ["--package", "floorguard-guard"]));
    }

    /// Cargo itself is what the steps run: one that ends well, and one that there is not.
    #[test]
    fn failed_step_does_not_hide_its_neighbour() {
        let ended =
            run_group(&[("wrong", "no-such-command"), ("right", "--version")], None).expect("both run");
        let verdicts: Vec<_> = ended.iter().map(|step| (step.name, step.succeeded)).collect();
        assert_eq!(verdicts, [("wrong", false), ("right", true)]);
        let kept = run_step(&("wrong", "no-such-command"), false).expect("it runs").kept;
        assert!(kept.contains("no-such-command"), "{kept}");
        let only = run_group(&[("wrong", "no-such-command"), ("right", "--version")], Some("ght"));
        assert_eq!(only.expect("it runs").len(), 1);
    }

    #[test]
    fn reads_the_harness_line() {
        let line = "FAILED. 12 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s";
        assert_eq!((number_before(line, " passed"), number_before(line, " failed")), (12, 3));
        assert_eq!(number_before("nothing", " passed"), 0);
    }
}
