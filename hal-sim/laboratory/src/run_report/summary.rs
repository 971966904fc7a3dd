//! The run in a few lines.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::judge::{MissionReport, NavigationReport};
use crate::world::{Observation, Plan};
use floorguard_host::words::{beside, counted};

/// Entries of the history that are shown.
const HISTORY_MAX: usize = 20;

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
    let ready = observation.ready_s.map(|ready_s| format!("ready to move after {ready_s:.1} s"));
    let _ = writeln!(text, "  {}", ready.as_deref().unwrap_or("never ready to move"));
    text.push_str(&stop_lines(observation));
    let latency = &verdict.stop_latency_ms;
    if latency.count > 0 {
        let (median, most, times) = (latency.median, latency.p99, counted(latency.count as u64, "time"));
        let _ = writeln!(
            text,
            "  from measurement to the order to stop: median {median:.0} ms, 99 % within {most:.0} ms ({times})"
        );
    }
    if let (Some(mota), Some(idf1)) = (verdict.mota, verdict.idf1) {
        let _ = writeln!(
            text,
            "  people in sight within 12 m: MOTA {mota:.2}, IDF1 {idf1:.2}, {}, {:.2} m off",
            counted(verdict.id_switches, "identity switch"),
            verdict.localisation_error_m.unwrap_or(0.0)
        );
    }
    if let Some(mission) = &verdict.mission {
        text.push_str(&mission_lines(mission));
    }
    if let Some(drive) = &verdict.navigation {
        text.push_str(&drive_lines(drive));
    }
    if let Some(learned) = &verdict.learned {
        let _ = writeln!(text, "  learned: {}", learned.words());
    }
    let outside = verdict.bodies.counts.failing_no_run();
    if outside > 0 {
        let _ = writeln!(
            text,
            "  {} that no verdict counts: {}",
            counted(u64::from(outside), "contact"),
            verdict.bodies.counts.headline()
        );
    }
    if !verdict.faulty_sources.is_empty() {
        let _ = writeln!(text, "  sources that failed: {}", verdict.faulty_sources.join(", "));
    }
    if observation.resets > 0 {
        let _ = writeln!(text, "  the operator pressed reset {}", counted(observation.resets, "time"));
    }
    let (word, reason) = (verdict.verdict.words(), &verdict.reason);
    let _ = writeln!(text, "  verdict: {word}: {reason}   (digest {} of {})", verdict.digest, plan.name);
    text
}

/// Stops and contacts, what held the robot back and in which order.
fn stop_lines(observation: &Observation) -> String {
    let verdict = &observation.verdict;
    let mut text = String::new();
    let _ = writeln!(
        text,
        "  stops {} ({} without need), missed {} ({} more for what no sensor saw)",
        verdict.stops, verdict.nuisance_stops, verdict.missed_stops, verdict.bodies.missed_unseen
    );
    let _ = writeln!(text, "  contacts: {}", verdict.contacts_in_words());
    for contact in verdict.bodies.contacts.iter().filter(|contact| contact.while_moving()) {
        let _ = writeln!(text, "    {}", contact.line());
    }
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
    for event in verdict.history.iter().take(HISTORY_MAX) {
        let _ = writeln!(text, "    {:6.1} s {}. {}", event.at_s, event.text, event.remedy);
    }
    text
}

/// How the drive to a goal went, in plain words.
fn drive_lines(drive: &NavigationReport) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "  drive: {}", drive.words());
    let mut stood: Vec<_> = drive.standing_s.iter().collect();
    stood.sort_by(|a, b| b.1.total_cmp(a.1));
    let all_s: f64 = drive.standing_s.values().sum();
    let _ = writeln!(text, "    standing by cause, {all_s:.1} s in all:");
    for (cause, seconds) in stood {
        let _ = writeln!(text, "    {seconds:7.1} s {cause}");
    }
    let measures: Vec<String> =
        drive.measures.iter().map(|(words, count)| format!("{count} x {words}")).collect();
    let recovered = if measures.is_empty() { String::new() } else { format!("; {}", measures.join(", ")) };
    let _ = writeln!(
        text,
        "    {}{recovered}; its own place up to {:.2} m off",
        counted(u64::from(drive.plans), "plan"),
        drive.localisation_error_max_m
    );
    text
}

/// What was cleaned, in plain words.
fn mission_lines(mission: &MissionReport) -> String {
    let percent = |share: f32| 100.0 * f64::from(share);
    let mut text = String::new();
    let _ = writeln!(
        text,
        "  cleaning ({}): dirt {} -> {} units; {} of {} dirty cells claimed clean ({:.1} %), {} of them falsely",
        mission.strategy,
        mission.dirt_before_units,
        mission.dirt_after_units,
        mission.claimed_cells,
        mission.dirty_cells,
        percent(mission.completion),
        mission.falsely_claimed_cells
    );
    let end = mission.end_in_words();
    let _ = writeln!(
        text,
        "    {end}; people and objects on the path cost {:.0} s, {}; {:.2} m off the true place",
        mission.people_cost_s,
        counted(mission.detours, "detour"),
        mission.localisation_error_m.unwrap_or_default()
    );
    // Half a second and more: less is reported as none.
    for (reason, seconds) in mission.time_s.iter().filter(|(_, seconds)| **seconds >= 0.5) {
        let _ = writeln!(text, "    {seconds:6.0} s {reason}");
    }
    for (reason, count) in &mission.uncertain_cells {
        let _ = writeln!(text, "    {count:3} {} not claimed: {reason}", beside(*count, "cell", "cells"));
    }
    if mission.unreachable_cells > 0 {
        let count = mission.unreachable_cells;
        let cells = beside(count as u64, "cell", "cells");
        let _ = writeln!(text, "    {count:3} dirty {cells} cannot be reached");
    }
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
