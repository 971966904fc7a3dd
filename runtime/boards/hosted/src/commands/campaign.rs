//! `floorguard campaign`: many seeded runs on all cores, and what came of them.

use std::io::IsTerminal;

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::exit::VerdictFailed;
use crate::campaign::{CampaignSummary, encounter, run_seeds, single_fault};

/// Kinds of campaigns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CampaignKind {
    /// 1 to 10 people cross the robot's way without looking, 5 % of the lidar packets are lost.
    Encounters,
    /// One random fault on one line.
    SingleFaults,
}

/// How many of what.
#[derive(Clone, Debug, Args)]
pub struct CampaignArguments {
    /// What to repeat.
    pub kind: CampaignKind,
    /// Runs.
    #[arg(long, default_value_t = 1_000)]
    pub trials: u64,
    /// Seed of the first run; each next one has the next number.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
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
    let one = |seed| {
        let outcome = match arguments.kind {
            CampaignKind::Encounters => encounter(seed),
            CampaignKind::SingleFaults => single_fault(seed),
        };
        bar.inc(1);
        outcome
    };
    let summary = run_seeds(arguments.seed..arguments.seed.saturating_add(arguments.trials), one)?;
    bar.finish_and_clear();
    if arguments.json {
        anstream::println!("{}", serde_json::to_string(&summary)?);
    } else {
        show(&summary);
    }
    if summary.failures.is_empty() {
        return Ok(());
    }
    Err(VerdictFailed(format!("{} of {} runs failed", summary.failures.len(), summary.runs)).into())
}

fn show(summary: &CampaignSummary) {
    anstream::eprintln!(
        "{} runs, {:.0} s and {:.0} m of robot time: {} failed",
        summary.runs,
        summary.duration_s,
        summary.distance_m,
        summary.failures.len()
    );
    anstream::eprintln!(
        "contacts {} ({} avoidable), stops {} ({} without need), missed {}",
        summary.contacts,
        summary.avoidable_contacts,
        summary.stops,
        summary.nuisance_stops,
        summary.missed_stops
    );
    if summary.stop_latency_max_ms > 0.0 {
        anstream::eprintln!("slowest order to stop {:.0} ms", summary.stop_latency_max_ms);
    }
    for failure in &summary.failures {
        anstream::eprintln!(
            "failed: {}\n  {}",
            failure.failure.as_deref().unwrap_or_default(),
            failure.command
        );
    }
    anstream::eprintln!("digest of all runs {}", summary.digest);
}
