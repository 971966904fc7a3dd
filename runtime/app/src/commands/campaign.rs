//! `floorguard campaign`: many seeded runs on all cores, and what came of them.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::campaign_contacts::{ContactCampaign, Shard, merge};
use super::exit::{Unfinished, VerdictFailed};
use super::interrupt::end_at_ctrl_c;
use floorguard_host::executor::StopFlag;
use floorguard_laboratory::campaign::{
    CampaignSummary, Cell, DrivingPlace, cell_of, coverage, dead_end_drive, drive, encounter, fault_trial,
    rate95, run_seeds_until, single_fault,
};

/// Kinds of campaigns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CampaignKind {
    /// 1 to 10 people cross the robot's path without looking, 5 % of the lidar packets are lost.
    Encounters,
    /// One random fault on one line.
    SingleFaults,
    /// Twenty classes of faults × each source × each phase of a mission, with the table of what was covered.
    Faults,
    /// Worlds that hurt: boards, low boxes, forks, glass, edges, people behind shelves; turns, spins, reverse.
    Contacts,
    /// Drives of two minutes without people among furniture of every kind: stops without need an hour.
    Furniture,
    /// The same in empty halls.
    EmptyHalls,
    /// Drives to a goal through buildings with dead ends, trolleys that are left in aisles and doors that shut.
    DeadEnds,
    /// Adds up the files that `contacts --record` wrote on several machines.
    Merge,
}

/// How many of what.
#[derive(Clone, Debug, Args)]
pub struct CampaignArguments {
    /// What to repeat.
    pub kind: CampaignKind,
    /// Merge only: the files.
    pub files: Vec<PathBuf>,
    /// Runs.
    #[arg(long, default_value_t = 1_000, value_parser = clap::value_parser!(u64).range(1..))]
    pub trials: u64,
    /// Seed of the first run; each next one has the next number.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Faults and contacts only: number of the first trial, to repeat one.
    #[arg(long, default_value_t = 0)]
    pub first: u64,
    /// Contacts only: this machine's part of the trials, as 3/16.
    #[arg(long, default_value = "1/1")]
    pub shard: Shard,
    /// Contacts only: a file that keeps a row for each trial; trials that are in it are not played again.
    #[arg(long)]
    pub record: Option<PathBuf>,
    /// Contacts and dead-ends only: a folder for the worlds of failed trials, as scenario files.
    #[arg(long)]
    pub worlds: Option<PathBuf>,
    /// One object on standard output.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// A run failed.
pub fn run(arguments: &CampaignArguments) -> anyhow::Result<()> {
    let bar = ProgressBar::new(arguments.trials);
    if !std::io::stderr().is_terminal() || arguments.json {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    let style = ProgressStyle::with_template("  {bar:50} {pos}/{len} runs, {elapsed} passed, {eta} to go");
    bar.set_style(style.unwrap_or(ProgressStyle::default_bar()));
    match arguments.kind {
        CampaignKind::Contacts => return contacts(arguments).run(&bar),
        CampaignKind::Merge => return merge(&arguments.files, arguments.json),
        CampaignKind::Encounters
        | CampaignKind::SingleFaults
        | CampaignKind::Faults
        | CampaignKind::Furniture
        | CampaignKind::EmptyHalls
        | CampaignKind::DeadEnds => {}
    }
    let one = |seed| {
        let outcome = match arguments.kind {
            CampaignKind::Encounters => encounter(seed),
            CampaignKind::SingleFaults => single_fault(seed),
            CampaignKind::Furniture => drive(DrivingPlace::Furniture, seed),
            CampaignKind::EmptyHalls => drive(DrivingPlace::EmptyHall, seed),
            CampaignKind::DeadEnds => dead_end_drive(seed),
            _ => fault_trial(arguments.seed, seed).1,
        };
        bar.inc(1);
        outcome
    };
    let is_matrix = arguments.kind == CampaignKind::Faults;
    let first = if is_matrix { arguments.first } else { arguments.seed };
    let trials = first..first.saturating_add(arguments.trials);
    let ended = StopFlag::default();
    end_at_ctrl_c(&ended, "what is running is run to its end")?;
    let summary = run_seeds_until(trials.clone(), &ended, one)?;
    bar.finish_and_clear();
    if let Some(folder) = &arguments.worlds {
        write_worlds(folder, &summary)?;
    }
    if arguments.json {
        tell!("{}", serde_json::to_string(&summary)?)?;
    } else {
        show(&summary);
        if matches!(arguments.kind, CampaignKind::Furniture | CampaignKind::EmptyHalls) {
            show_rate(&summary);
        }
        if is_matrix && !is_cut(arguments, &summary) {
            show_coverage(trials);
        }
    }
    conclude(arguments, &summary)
}

/// Somebody ended it before all runs were played.
const fn is_cut(arguments: &CampaignArguments, summary: &CampaignSummary) -> bool {
    (summary.runs as u64) < arguments.trials
}

/// How the command ends.
fn conclude(arguments: &CampaignArguments, summary: &CampaignSummary) -> anyhow::Result<()> {
    if is_cut(arguments, summary) && summary.failures.is_empty() {
        let further = match arguments.kind {
            CampaignKind::Faults => "; `cargo xtask campaign faults` goes on where it was cut",
            _ => "",
        };
        let (runs, all) = (summary.runs, arguments.trials);
        return Err(Unfinished(format!("interrupted after {runs} of {all} runs{further}")).into());
    }
    if summary.failures.is_empty() {
        return Ok(());
    }
    Err(VerdictFailed(format!("{} of {} runs failed", summary.failures.len(), summary.runs)).into())
}

/// One scenario file for each run that failed, if the campaign draws worlds; its first line plays it.
fn write_worlds(folder: &Path, summary: &CampaignSummary) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
    for world in summary.failures.iter().filter_map(|failure| failure.world.as_ref()) {
        let path = folder.join(&world.name);
        std::fs::write(&path, &world.text)
            .with_context(|| format!("{}: cannot be written", path.display()))?;
    }
    Ok(())
}

fn contacts(arguments: &CampaignArguments) -> ContactCampaign<'_> {
    ContactCampaign {
        seed: arguments.seed,
        trials: arguments.first..arguments.first.saturating_add(arguments.trials),
        shard: arguments.shard,
        record: arguments.record.as_deref(),
        worlds: arguments.worlds.as_deref(),
        json: arguments.json,
    }
}

fn show(summary: &CampaignSummary) {
    say!(
        "{} runs, {:.0} s and {:.0} m of robot time: {} failed",
        summary.runs,
        summary.duration_s,
        summary.distance_m,
        summary.failures.len()
    );
    let bodies = &summary.bodies;
    say!(
        "contacts while it moved {} ({} with people, {} with objects, {} over edges): {}",
        bodies.while_moving(),
        bodies.people_while_moving,
        bodies.drove_into_things,
        bodies.over_edges,
        bodies.headline()
    );
    say!(
        "missed stops {} ({} more for what no sensor saw), stops {} ({} without need)",
        summary.missed_stops,
        summary.missed_unseen,
        summary.stops,
        summary.nuisance_stops
    );
    if summary.stop_latency_max_ms > 0.0 {
        say!("slowest order to stop {:.0} ms", summary.stop_latency_max_ms);
    }
    for (ending, runs) in &summary.endings {
        say!("{runs} runs: {ending}");
    }
    for failure in &summary.failures {
        say!("failed: {}\n  {}", failure.failure.as_deref().unwrap_or_default(), failure.command);
    }
    for stop in &summary.without_need {
        say!("without need: {stop}");
    }
    say!("digest of all runs {}", summary.digest);
}

/// How often it stopped while nothing was near its path.
fn show_rate(summary: &CampaignSummary) {
    let hours = summary.moving_s / 3_600.0;
    if hours > 0.0 {
        let stops = summary.stops_without_need;
        let (low, high) = rate95(stops, hours);
        say!(
            "by true geometry {stops} stops without need in {hours:.2} h of driving: {:.2} an hour (95 %: {low:.2} to \
             {high:.2})",
            f64::from(stops) / hours
        );
    }
}

fn show_coverage(trials: std::ops::Range<u64>) {
    let mut counts = std::collections::BTreeMap::<Cell, u64>::new();
    for trial in trials {
        *counts.entry(cell_of(trial)).or_default() += 1;
    }
    let (table, share) = coverage(&counts);
    say!(
        "runs by class, source and phase (start/cruise/approach/hold/operator), - where it cannot be:\n{table}"
    );
    say!("{:.1} % of the possible cells have a run", share * 100.0);
}
