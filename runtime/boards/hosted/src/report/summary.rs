//! The run in a few lines.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::world::{Observation, Plan};

/// Plain words, ending with the verdict.
#[must_use]
pub fn summary(plan: &Plan, observation: &Observation) -> String {
    let verdict = &observation.verdict;
    let mut text = String::new();
    let _ = writeln!(
        text,
        "  {}: {:.0} s, {:.1} m driven, {:.1} m² brushed, seed {}",
        verdict.scenario, verdict.duration_s, verdict.distance_m, observation.cleaned_m2, verdict.seed
    );
    if let Some(ready_s) = observation.ready_s {
        let _ = writeln!(text, "  ready to move after {ready_s:.1} s");
    }
    let _ = writeln!(
        text,
        "  stops {} ({} without need), missed {}; contacts {} ({} avoidable)",
        verdict.stops,
        verdict.nuisance_stops,
        verdict.missed_stops,
        verdict.contacts,
        verdict.avoidable_contacts
    );
    for (kind, count) in kinds(observation) {
        let _ = writeln!(text, "    {count:3} x {kind}");
    }
    let mut held: Vec<_> = observation.under_cause_s.iter().collect();
    held.sort_by(|a, b| b.1.total_cmp(a.1));
    let held: Vec<String> =
        held.iter().take(5).map(|(kind, seconds)| format!("{kind} {seconds:.1} s")).collect();
    if !held.is_empty() {
        let _ = writeln!(text, "  held back by: {}", held.join(", "));
    }
    let latency = &verdict.stop_latency_ms;
    if latency.count > 0 {
        let _ = writeln!(
            text,
            "  from measurement to the order to stop: median {:.0} ms, 99 % within {:.0} ms ({} times)",
            latency.median, latency.p99, latency.count
        );
    }
    if let (Some(mota), Some(idf1)) = (verdict.mota, verdict.idf1) {
        let _ = writeln!(
            text,
            "  people in sight within 12 m: MOTA {mota:.2}, IDF1 {idf1:.2}, {} identity switches, {:.2} m off",
            verdict.id_switches,
            verdict.localisation_error_m.unwrap_or(0.0)
        );
    }
    if !verdict.faulty_sources.is_empty() {
        let _ = writeln!(text, "  sources that failed: {}", verdict.faulty_sources.join(", "));
    }
    if observation.resets > 0 {
        let _ = writeln!(text, "  the operator pressed reset {} times", observation.resets);
    }
    let word = if verdict.passed { "good" } else { "FAILED" };
    let _ = writeln!(text, "  verdict: {word}   (digest {} of {})", verdict.digest, plan.name);
    text
}

/// How often each cause stopped the robot, most frequent first.
#[must_use]
pub fn kinds(observation: &Observation) -> Vec<(String, usize)> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for stop in &observation.stops {
        *counts.entry(&stop.kind).or_default() += 1;
    }
    let mut kinds: Vec<(String, usize)> =
        counts.into_iter().map(|(kind, count)| (kind.to_owned(), count)).collect();
    kinds.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    kinds
}
