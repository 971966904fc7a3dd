//! All mutants in one program, suite by suite; then one by one what cannot be a branch.

use std::collections::hash_map::DefaultHasher;
use std::hash::Hasher as _;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};

use super::alone;
use super::list::{self, Mutant};
use super::mutated_copy::{MutatedCopy, Refused};
use super::outcome::{Outcome, Outcomes};
use super::record::{self, Record};
use super::trial::Program;
use crate::facts::{Part, Suite, facts};
use crate::shell;

/// Runs the campaign of that name; `None` if there is none. False if too many mutants survive.
pub fn run(name: &str, fresh: bool) -> Result<Option<bool>> {
    let Some(part) = facts().mutants.iter().find(|part| part.name == name) else { return Ok(None) };
    let mutants = list::ask(&part.package, &part.files)?;
    let code = crate::sources::code_today()?;
    let (mutated, refused) = MutatedCopy::make(&part.package, &mutants)?;
    println!(
        "{name}: {} mutants, {} of which do not compile, {} are built by themselves, the others are in one program",
        mutants.len(),
        refused.unviable.len(),
        refused.alone.len()
    );
    let path = mutated.folder.join(format!("{name}.json"));
    if fresh {
        let _ = std::fs::remove_file(&path);
    }
    let first = part.suites.first().map(|suite| program(&mutated, part, suite)).transpose()?;
    let mut outcomes = Outcomes::load(&path, &fingerprint(first.as_slice())?);
    outcomes.code = code;
    for number in &refused.unviable {
        outcomes.book(&mutants[*number].name, Outcome::Unviable)?;
    }
    together(&mutated, part, (&mutants, &refused), &mut outcomes)?;
    conclude(part, &mutants, &outcomes)?;
    for number in &refused.alone {
        let mutant = &mutants[*number];
        if outcomes.of(&mutant.name).is_none() {
            outcomes.book(&mutant.name, alone::try_out(&mutated, mutant, part)?)?;
            // These take long: what is known is kept even if the rest is cut.
            record::keep(&shell::root(), result(part, &mutants, &outcomes, &shell::root())?)?;
        }
    }
    conclude(part, &mutants, &outcomes).map(Some)
}

fn program(mutated: &MutatedCopy, part: &Part, suite: &Suite) -> Result<Program> {
    Program::build(mutated, &part.package, suite)?
        .with_context(|| format!("{:?} does not build", suite.target))
}

/// Each suite sees what survived the ones before it.
fn together(
    mutated: &MutatedCopy,
    part: &Part,
    (mutants, refused): (&[Mutant], &Refused),
    outcomes: &mut Outcomes,
) -> Result<()> {
    for (number, suite) in part.suites.iter().enumerate() {
        let open = |mutant: &usize| {
            let known = outcomes.of(&mutants[*mutant].name);
            let done = match known {
                Some(Outcome::Unviable | Outcome::Caught) => true,
                Some(Outcome::Survived(suites)) => suites > number,
                None => false,
            };
            !done && !refused.alone.contains(mutant)
        };
        let open: Vec<usize> = (0..mutants.len()).filter(open).collect();
        if !open.is_empty() {
            try_all(&program(mutated, part, suite)?, number, (&open, mutants), outcomes)?;
        }
    }
    Ok(())
}

/// Asks those tests about each mutant that reach it.
fn try_all(
    program: &Program,
    suite: usize,
    (open, mutants): (&[usize], &[Mutant]),
    outcomes: &mut Outcomes,
) -> Result<()> {
    let note = std::env::temp_dir().join(format!("mutants-reached-{}", std::process::id()));
    let reached = program.reached(&note)?;
    let bar = ProgressBar::new(open.len() as u64);
    let style =
        ProgressStyle::with_template("  {bar:50} {human_pos}/{human_len}, {elapsed} passed, {eta} to go");
    bar.set_style(style.unwrap_or(ProgressStyle::default_bar()));
    let booked = Mutex::new(outcomes);
    open.par_iter().try_for_each(|number| -> Result<()> {
        let tests = reached.get(number);
        let noticed = tests.map(|tests| program.notices(&number.to_string(), tests)).transpose()?;
        let outcome = if noticed == Some(true) { Outcome::Caught } else { Outcome::Survived(suite + 1) };
        bar.inc(1);
        booked.lock().unwrap_or_else(PoisonError::into_inner).book(&mutants[*number].name, outcome)
    })?;
    bar.finish_and_clear();
    let touched = open.iter().filter(|number| reached.contains_key(number)).count();
    println!("  suite {}: {} mutants, {touched} of them reached", suite + 1, open.len());
    Ok(())
}

fn fingerprint(programs: &[Program]) -> Result<String> {
    let mut hasher = DefaultHasher::new();
    for program in programs {
        hasher.write(&program.bytes()?);
    }
    Ok(format!("{:016x}", hasher.finish()))
}

/// Tells what survived and keeps the record. False if too many did.
fn conclude(part: &Part, mutants: &[Mutant], outcomes: &Outcomes) -> Result<bool> {
    let root = shell::root();
    let record = result(part, mutants, outcomes, &root)?;
    let percent = record.percent();
    println!(
        "{}: {} viable mutants, {} caught, {} survive, {} not tried: {percent:.1} % caught or explained, {:.0} % wanted",
        part.name,
        record.viable,
        record.caught,
        record.survivors.len(),
        record.untried,
        part.wanted_percent
    );
    for survivor in record.survivors.iter().filter(|survivor| survivor.reason.is_empty()) {
        println!("  {}:{} {}", survivor.file, survivor.line, survivor.mutation);
    }
    record::keep(&root, record)?;
    println!("kept in {}", record::RECORD);
    Ok(percent >= part.wanted_percent)
}

fn result(part: &Part, mutants: &[Mutant], outcomes: &Outcomes, root: &Path) -> Result<Record> {
    let equivalents = record::equivalents(root)?;
    let with = |wanted: fn(Outcome) -> bool| {
        let found = mutants.iter().filter(move |mutant| outcomes.of(&mutant.name).is_some_and(wanted));
        found.map(|mutant| mutant.name.as_str())
    };
    let caught = with(|outcome| outcome == Outcome::Caught).count();
    let survivors =
        record::explained(with(|outcome| matches!(outcome, Outcome::Survived(_))), root, &equivalents);
    Ok(Record {
        name: part.name.clone(),
        command: format!("{} campaign {}", facts().command, part.name),
        wanted_percent: part.wanted_percent,
        viable: caught + survivors.len(),
        caught,
        unviable: with(|outcome| outcome == Outcome::Unviable).count(),
        untried: mutants.iter().filter(|mutant| outcomes.of(&mutant.name).is_none()).count(),
        code: outcomes.code.clone(),
        survivors,
    })
}
