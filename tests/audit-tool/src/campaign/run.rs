//! Cuts a campaign into blocks, runs them on all cores and adds up.

use std::collections::hash_map::DefaultHasher;
use std::hash::Hasher as _;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::in_order::{self, held};
use super::state::State;
use super::{block, interrupt, kinds, matrix, program, record, state};
use crate::facts::Kind;
use crate::{counting, mutants};

/// Which campaign and how much of it.
#[derive(Args)]
pub struct Options {
    /// model, fuzz-velodyne, fuzz-s300 …: a wrong name lists them.
    pub name: String,
    /// Trials; without it as many as the campaign asks for. For `loops` stages: 1 is core and
    /// drivers, 2 also recordings and simulated worlds, 3 all tests.
    #[arg(long)]
    pub trials: Option<u64>,
    /// Seed: the same seed repeats the same trials.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Forget what was done before.
    #[arg(long)]
    fresh: bool,
    /// Go on with the program that the campaign began with, without building: for runs of days, and beside other work.
    #[arg(long, conflicts_with = "fresh")]
    same_program: bool,
    /// Keep the result in docs/evidence, where the audit shows it.
    #[arg(long)]
    record: bool,
}

/// Runs to the end or to the first finding. True if there is none.
pub fn run(options: &Options) -> Result<bool> {
    if options.name == "loops" {
        return counting::run(options.seed, options.trials, options.fresh);
    }
    if let Some(caught) = mutants::run(&options.name, options.fresh)? {
        return Ok(caught);
    }
    let kind = kinds::find(&options.name).map_err(anyhow::Error::msg)?;
    let trials = options.trials.unwrap_or(kind.trials);
    let path = state::path(&kind.name, options.seed)?;
    if options.fresh {
        let _ = std::fs::remove_file(&path);
    }
    let program = program::programs(kind, &path, options.same_program)?;
    let state = State::load(&path, &fingerprint(&program.test, program.firmware.as_deref())?);
    println!("{}: {trials} {}, seed {}; {} done before", kind.name, kind.trial, options.seed, state.trials);
    let stop = interrupt::flag()?;
    let (state, findings) = play(&program, (kind, options.seed), (state, &path), (trials, &stop))?;
    show(&state);
    for (part, output) in &findings {
        println!("FINDING in trials {}..{} of seed {}:\n{output}", part.start, part.end, options.seed);
    }
    let came = record::Outcome::of((kind, options.seed), &state, trials, findings.len());
    let ended = came.findings == 0 && !state.missing(trials, kind.block).is_empty();
    if ended {
        println!("{}", interrupt::words((&kind.name, options.seed), state.trials, trials));
    } else {
        let kept = shown(&path);
        println!("{}: {} trials, {} findings; kept in {kept}", kind.name, state.trials, came.findings);
    }
    if options.record {
        record::keep(&came, program::code(&path).as_deref())?;
    }
    if ended {
        std::process::exit(interrupt::INTERRUPTED);
    }
    Ok(came.findings == 0)
}

/// A part of the trials that failed, and the test's message.
type Finding = (Range<u64>, String);

/// Runs what is missing, the first trials first, to the end, to the first finding or until somebody ends it.
fn play(
    program: &block::Program,
    (kind, seed): (&Kind, u64),
    (state, path): (State, &Path),
    (trials, stop): (u64, &AtomicBool),
) -> Result<(State, Vec<Finding>)> {
    let (bar, parts) = (bar(trials, state.trials), state.missing(trials, kind.block));
    let (state, findings) = (Mutex::new(state), Mutex::new(Vec::new()));
    in_order::run(parts, stop, |part| {
        match block::run(program, kind, seed, part.clone()) {
            Ok(Some(counts)) => {
                bar.inc(part.end - part.start);
                held(&state).book(path, kind.block, part, counts)?;
            }
            Ok(None) => stop.store(true, Ordering::Relaxed),
            Err(output) => {
                stop.store(true, Ordering::Relaxed);
                held(&findings).push((part, output));
            }
        }
        Ok(())
    })?;
    bar.finish_and_clear();
    let findings = std::mem::take(&mut *held(&findings));
    Ok((state.into_inner().unwrap_or_else(PoisonError::into_inner), findings))
}

fn bar(trials: u64, done: u64) -> ProgressBar {
    let bar = ProgressBar::new(trials);
    let style =
        ProgressStyle::with_template("  {bar:50} {human_pos}/{human_len}, {elapsed} passed, {eta} to go");
    bar.set_style(style.unwrap_or(ProgressStyle::default_bar()));
    bar.set_position(done);
    bar
}

/// What was counted, and the table of those campaigns that have one.
fn show(state: &State) {
    for (name, count) in state.counts.iter().filter(|(name, _)| !matrix::is_cell(name)) {
        println!("  {name:>20} {count}");
    }
    if let Some(table) = matrix::table(&state.counts) {
        println!("{table}");
    }
}

fn shown(path: &Path) -> String {
    path.strip_prefix(crate::shell::root()).unwrap_or(path).display().to_string()
}

/// Of the test's executable, and of the firmware that it plays on: the same sources give the same ones.
fn fingerprint(test: &Path, firmware: Option<&Path>) -> Result<String> {
    let mut hasher = DefaultHasher::new();
    for path in [Some(test), firmware].into_iter().flatten() {
        hasher.write(&std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?);
    }
    Ok(format!("{:016x}", hasher.finish()))
}
