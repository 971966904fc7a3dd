//! Runs a list of cases on all cores and adds up the verdicts in the order of the cases.

use std::collections::BTreeMap;

use floorguard_contact_judge::ContactCounts;
use rayon::prelude::*;
use serde::Serialize;

use crate::judge::{Digest, Verdict};

/// What one case came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RunOutcome {
    /// The command that repeats it.
    pub command: String,
    /// Why it counts as failed; none when it passed.
    pub failure: Option<String>,
    /// The verdict, unless the run itself broke.
    pub verdict: Option<Verdict>,
    /// Stops without need, in words, where the campaign asks for them.
    pub without_need: Vec<String>,
    /// How it ended, in a few words, where there are several good ends.
    pub ending: Option<&'static str>,
    /// Its world, if it failed, where the campaign draws worlds.
    #[serde(skip)]
    pub world: Option<WorldFile>,
}

/// A world as a scenario file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldFile {
    /// Its name, without a folder.
    pub name: String,
    /// Its text; comments say how to play it.
    pub text: String,
}

/// What all cases came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CampaignSummary {
    /// Cases run.
    pub runs: usize,
    /// Cases that failed, with the command that repeats each.
    pub failures: Vec<RunOutcome>,
    /// Stops without need, in words, each with the command that repeats its run, where the campaign asks for them.
    pub without_need: Vec<String>,
    /// How many runs ended in which way, where there are several good ends; failed ones are not among them.
    pub endings: BTreeMap<&'static str, u32>,
    /// Sum over all runs.
    pub contacts: u32,
    /// Sum over all runs.
    pub avoidable_contacts: u32,
    /// Sum over all runs, by kind.
    pub bodies: ContactCounts,
    /// Sum over all runs.
    pub missed_stops: u32,
    /// Sum over all runs: what no sensor had seen.
    pub missed_unseen: u32,
    /// Sum over all runs.
    pub nuisance_stops: u32,
    /// Sum over all runs.
    pub stops: u32,
    /// Largest of all runs, milliseconds.
    pub stop_latency_max_ms: f64,
    /// Sum over all runs, metres.
    pub distance_m: f64,
    /// Sum over all runs, seconds of robot time.
    pub duration_s: f64,
    /// Of them, those in which the robot moved.
    pub moving_s: f64,
    /// Sum over all runs: stops while nothing was near the path of the body, by true geometry.
    pub stops_without_need: u32,
    /// Fingerprint of all fingerprints.
    pub digest: String,
}

/// Runs every case on all cores. The order of the result does not depend on the number of cores.
pub fn run_all<C: Sync>(cases: &[C], run: impl Fn(&C) -> RunOutcome + Send + Sync) -> CampaignSummary {
    run_some(cases, |case| Some(run(case)))
}

/// The same, of those cases that give an outcome: others were left out.
pub fn run_some<C: Sync>(
    cases: &[C],
    run: impl Fn(&C) -> Option<RunOutcome> + Send + Sync,
) -> CampaignSummary {
    let outcomes: Vec<RunOutcome> = cases.par_iter().filter_map(run).collect();
    let mut summary = CampaignSummary { runs: outcomes.len(), ..CampaignSummary::default() };
    let mut digest = Digest::new();
    for outcome in outcomes {
        if let Some(verdict) = &outcome.verdict {
            summary.contacts += verdict.contacts;
            summary.avoidable_contacts += verdict.avoidable_contacts;
            summary.bodies.add(&verdict.bodies.counts);
            summary.missed_unseen += verdict.bodies.missed_unseen;
            summary.missed_stops += verdict.missed_stops;
            summary.nuisance_stops += verdict.nuisance_stops;
            summary.stops += verdict.stops;
            summary.stop_latency_max_ms = summary.stop_latency_max_ms.max(verdict.stop_latency_ms.max);
            summary.distance_m += verdict.distance_m;
            summary.duration_s += verdict.duration_s;
            summary.moving_s += verdict.bodies.duration_s * verdict.bodies.moving_share;
            summary.stops_without_need += verdict.bodies.nuisance_stops;
            digest.add(verdict.digest.as_bytes());
        }
        let repeat = |stop: &String| format!("{stop}; {}", outcome.command);
        summary.without_need.extend(outcome.without_need.iter().map(repeat));
        if outcome.failure.is_none() {
            outcome.ending.into_iter().for_each(|ending| *summary.endings.entry(ending).or_default() += 1);
        }
        if outcome.failure.is_some() {
            summary.failures.push(outcome);
        }
    }
    summary.digest = digest.hex();
    summary
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::run_seeds_until;
    use floorguard_host::executor::StopFlag;

    #[test]
    fn failures_keep_command_and_case_order() {
        let cases: Vec<u32> = (0..100).collect();
        let summary = run_all(&cases, |case| RunOutcome {
            command: format!("floorguard simulate --seed {case}"),
            failure: (case % 40 == 39).then(|| "contact".to_owned()),
            verdict: Some(Verdict { stops: *case, ..Verdict::default() }),
            without_need: vec![format!("at {case} s")],
            ending: Some(if case % 2 == 0 { "even" } else { "odd" }),
            world: None,
        });
        let commands: Vec<&str> = summary.failures.iter().map(|failure| failure.command.as_str()).collect();
        assert_eq!(commands, ["floorguard simulate --seed 39", "floorguard simulate --seed 79"]);
        assert_eq!((summary.runs, summary.stops), (100, 4_950));
        assert_eq!((summary.endings["even"], summary.endings["odd"]), (50, 48), "failed ones have no ending");
        assert_eq!(summary.without_need[39], "at 39 s; floorguard simulate --seed 39");
    }

    #[test]
    fn ended_campaign_starts_nothing() {
        let ended = StopFlag::default();
        let run = |seed: u64| {
            if seed == 0 {
                ended.stop();
            }
            RunOutcome { verdict: Some(Verdict::default()), ..RunOutcome::default() }
        };
        let one = run_seeds_until(0..1, &ended, run).unwrap();
        assert_eq!(one.runs, 1, "what was running is run to its end");
        assert_eq!(run_seeds_until(1..500, &ended, run).unwrap().runs, 0);
    }
}
