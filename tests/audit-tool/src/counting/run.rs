//! Builds the counting copy, runs the tests in it, records the largest counts.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use super::tree::{Refused, Tree};
use crate::facts::{Stage, facts};
use crate::loops::{LoopSite, RECORD, Record};
use crate::{loops, shell, sources};

/// Rounds in which the compiler may refuse counters.
const ROUNDS: usize = 12;

/// The packages of a stage.
fn packages(stage: &Stage) -> Vec<&str> {
    if stage.packages.is_empty() {
        sources::crates().iter().map(|one| one.package.as_str()).collect()
    } else {
        stage.packages.iter().map(String::as_str).collect()
    }
}

/// Counts in so many stages, in all without a number, and keeps what earlier runs saw unless it is to begin afresh. False
/// if a loop turned more often than its bound.
pub fn run(seed: u64, stages: Option<u64>, fresh: bool) -> Result<bool> {
    let files = sources::read_audited(&shell::root())?;
    let sites: Vec<LoopSite> = files.iter().flat_map(|file| loops::list(file).0).collect();
    let tree = Tree::copy()?;
    let mut refused = Refused::default();
    for round in 0.. {
        tree.instrument(&files, &sites, &refused)?;
        let lines = mistakes(&tree)?;
        if lines.is_empty() {
            break;
        }
        if round == ROUNDS || !refuse(&lines, &sites, &mut refused) {
            bail!(
                "the counting copy does not compile: {lines:?}; see `cargo check` in {}",
                shown(&tree.sources())
            );
        }
    }
    let counters = sites.iter().filter(|site| !site.edits.is_empty()).count() - refused.loops.len();
    println!("loops: {counters} of {} loops count; running the tests", sites.len());
    let counts = tree.empty_counts()?;
    let mut over = 0;
    let before = if fresh { vec![] } else { kept()? };
    for stage in facts().counting.iter().take(stages.map_or(usize::MAX, |stages| stages as usize)) {
        if !test(&tree, (stage, &counts), seed)? {
            println!(
                "loops: some tests failed in the copy, which is slower; their counts stand all the same"
            );
        }
        let records = with(records(&sites, &refused, &read(&counts)?), &before);
        write(&records)?;
        over = reported(&records);
        let ran = records.iter().filter(|record| record.largest.is_some()).count();
        println!("loops: {ran} ran in {} and before; kept in {RECORD}", packages(stage).join(", "));
    }
    Ok(over == 0)
}

fn shown(path: &Path) -> String {
    path.strip_prefix(shell::root()).unwrap_or(path).display().to_string()
}

fn cargo(tree: &Tree) -> Command {
    let mut command = shell::cargo();
    command.current_dir(tree.sources()).env("CARGO_TARGET_DIR", tree.folder.join("target"));
    command
}

/// Places of the copy that the compiler refuses: file and line.
fn mistakes(tree: &Tree) -> Result<BTreeSet<(String, usize)>> {
    let mut check = cargo(tree);
    check.args(["check", "--quiet", "--message-format=json"]);
    check.args(sources::crates().iter().flat_map(|one| ["--package", &one.package]));
    check.args(facts().sources.features.iter().flat_map(|feature| ["--features", feature]));
    let output = check.stderr(Stdio::null()).output().context("cannot start cargo check")?;
    if output.status.success() {
        return Ok(BTreeSet::new());
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let messages = text.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let mut lines = BTreeSet::new();
    for message in messages.filter(|message| message["message"]["level"] == "error") {
        for span in message["message"]["spans"].as_array().into_iter().flatten() {
            let file = span["file_name"].as_str().unwrap_or_default().to_owned();
            let (first, last) = (span["line_start"].as_u64(), span["line_end"].as_u64());
            for line in first.unwrap_or(0)..=last.unwrap_or(0) {
                lines.insert((file.clone(), line as usize));
            }
        }
    }
    if lines.is_empty() {
        bail!("the counting copy does not compile, and the compiler names no line");
    }
    Ok(lines)
}

/// Leaves out the bounds at these lines, or the counters whose bounds are out already. False if nothing is left to do.
fn refuse(lines: &BTreeSet<(String, usize)>, sites: &[LoopSite], refused: &mut Refused) -> bool {
    let mut changed = false;
    for (number, site) in sites.iter().enumerate() {
        let hit =
            |(file, line): &(String, usize)| *file == site.file && (site.line..=site.end_line).contains(line);
        // A long loop holds lines that are not its own: its head is where its counter stands.
        let head = |(file, line): &(String, usize)| {
            *file == site.file && (site.line..=site.end_line.min(site.line + 3)).contains(line)
        };
        let named = if site.kind == "for" { lines.iter().any(head) } else { lines.iter().any(hit) };
        if named && !site.edits.is_empty() {
            changed |= if refused.bounds.insert(number) { true } else { refused.loops.insert(number) };
        }
    }
    changed
}

/// Runs the tests of some packages. False if one failed.
fn test(tree: &Tree, (stage, counts): (&Stage, &Path), seed: u64) -> Result<bool> {
    let mut command = cargo(tree);
    command.args(["test", "--quiet", "--no-fail-fast"]);
    command.args(packages(stage).into_iter().flat_map(|package| ["--package", package]));
    command.args(stage.programs.iter().flat_map(|program| ["--test", program]));
    command.arg("--").args(stage.modules.iter().map(|module| format!("{module}::")));
    command
        .env(facts().variable("LOOP_COUNTS"), counts)
        .env(facts().variable("CAMPAIGN_SEED"), seed.to_string());
    command.stdout(Stdio::null());
    shell::succeeds(&mut command)
}

/// Largest count of each loop with its bound; a count above its bound goes before all others.
fn read(folder: &Path) -> Result<BTreeMap<usize, (u64, u64)>> {
    let mut largest = BTreeMap::new();
    for entry in fs::read_dir(folder).context("nothing was counted")? {
        merge(&fs::read_to_string(entry?.path())?, &mut largest);
    }
    Ok(largest)
}

fn merge(text: &str, largest: &mut BTreeMap<usize, (u64, u64)>) {
    for line in text.lines() {
        let numbers: Vec<u64> = line.split(' ').filter_map(|number| number.parse().ok()).collect();
        let &[site, count, bound] = numbers.as_slice() else { continue };
        let over = |(count, bound): (u64, u64)| bound > 0 && count > bound;
        let new = (count, bound);
        let known = largest.entry(site as usize).or_insert(new);
        if (over(new), count) > (over(*known), known.0) {
            *known = new;
        }
    }
}

fn records(sites: &[LoopSite], refused: &Refused, seen: &BTreeMap<usize, (u64, u64)>) -> Vec<Record> {
    let numbers = loops::numbers(sites);
    let counted = sites
        .iter()
        .zip(numbers)
        .enumerate()
        .filter(|(at, (site, _))| !site.edits.is_empty() && !refused.loops.contains(at));
    counted
        .map(|(at, (site, number))| Record {
            file: site.file.clone(),
            function: site.function.clone(),
            kind: site.kind.clone(),
            number,
            bound: site.bound.clone(),
            largest: seen.get(&at).map(|(count, _)| *count),
            bound_value: seen.get(&at).map_or(0, |(_, bound)| *bound),
        })
        .collect()
}

fn kept() -> Result<Vec<Record>> {
    let Ok(text) = fs::read_to_string(shell::root().join(RECORD)) else { return Ok(vec![]) };
    serde_json::from_str(&text).with_context(|| format!("{RECORD} is broken"))
}

/// The larger count of now and before for each loop that still has its name and its bound.
fn with(mut records: Vec<Record>, before: &[Record]) -> Vec<Record> {
    let before: BTreeMap<_, _> = before.iter().map(|record| (record.name(), record)).collect();
    for record in &mut records {
        if let Some(old) = before.get(&record.name()).filter(|old| old.largest > record.largest) {
            record.largest = old.largest;
            record.bound_value = old.bound_value.max(record.bound_value);
        }
    }
    records
}

fn write(records: &[Record]) -> Result<()> {
    fs::write(shell::root().join(RECORD), loops::written(records)?)
        .with_context(|| format!("cannot write {RECORD}"))
}

/// Names what turned too often.
fn reported(records: &[Record]) -> usize {
    let over = records.iter().filter(|record| {
        record.bound_value > 0 && record.largest.is_some_and(|largest| largest > record.bound_value)
    });
    over.inspect(|record| {
        println!(
            "{} in {}: a `{}` turned {:?} times; its bound `{}` is {}",
            record.file, record.function, record.kind, record.largest, record.bound, record.bound_value
        );
    })
    .count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_seen_before_stays() {
        let record = |largest, bound: &str| Record {
            file: "a.rs".to_owned(),
            function: "f".to_owned(),
            kind: "for".to_owned(),
            number: 0,
            bound: bound.to_owned(),
            largest,
            bound_value: 0,
        };
        let largest = |now, bound, before| with(vec![record(now, bound)], &[record(before, "N")])[0].largest;
        assert_eq!(largest(None, "N", Some(4)), Some(4));
        assert_eq!(largest(Some(3), "N", Some(4)), Some(4));
        assert_eq!(largest(Some(5), "N", Some(4)), Some(5));
        assert_eq!(largest(None, "M", Some(4)), None, "another bound is another loop");
    }

    #[test]
    fn largest_count_and_bound_violation_are_kept() {
        let mut largest = BTreeMap::new();
        merge("3 5 8\n3 9 0\n4 0 0\n", &mut largest);
        assert_eq!(largest, BTreeMap::from([(3, (9, 0)), (4, (0, 0))]));
        merge("3 7 6\nbroken\n3 10 64\n", &mut largest);
        assert_eq!(largest[&3], (7, 6));
    }
}
