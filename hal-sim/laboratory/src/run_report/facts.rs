//! A simulated run in figures: the first glance as tiles, the rest as a list of name and value.

use std::fmt::Write;

use super::summary::kinds;
use crate::judge::{MissionReport, Outcome};
use crate::world::{Observation, Plan};
use floorguard_host::words::counted;
use floorguard_operator::report::made_now;
use floorguard_operator::report::style::{Tile, count_tile, escaped, tiles};

/// Causes that held the robot back, the longest first, no more than this.
const HELD_MAX: usize = 5;

/// The figures of the page.
pub fn facts(plan: &Plan, observation: &Observation) -> String {
    let rows = rows(plan, observation).into_iter().fold(String::new(), |mut list, (name, text)| {
        let _ = write!(list, "<dt>{name}<dd>{}", escaped(&text));
        list
    });
    format!("{}<dl class=facts>{rows}</dl>", tiles(glance(observation)))
}

fn glance(observation: &Observation) -> Vec<Tile> {
    let verdict = &observation.verdict;
    let none_is_good = |count: u32, one, many| {
        let (value, what, _) = count_tile(u64::from(count), one, many);
        (value, what, if count == 0 { "good" } else { "bad" })
    };
    let class = if verdict.verdict == Outcome::Good { "good" } else { "bad" };
    let word = verdict.verdict.words();
    let mut tiles = vec![
        (word.to_owned(), "verdict by ground truth", class),
        none_is_good(
            verdict.bodies.counts.while_moving(),
            "contact while it moved",
            "contacts while it moved",
        ),
        none_is_good(verdict.avoidable_contacts, "of these seen in time", "of these seen in time"),
        none_is_good(verdict.bodies.counts.unseen(), "of these unseen", "of these unseen"),
        none_is_good(
            verdict.bodies.counts.walked_into_standing,
            "person walked into it as it stood",
            "people walked into it as it stood",
        ),
        none_is_good(verdict.missed_stops, "missed stop", "missed stops"),
        count_tile(u64::from(verdict.stops), "stop", "stops"),
        (format!("{:.1} m", verdict.distance_m), "driven", ""),
        (format!("{:.0} s", verdict.duration_s), "robot's time", ""),
    ];
    if let Some(mission) = &verdict.mission {
        let percent = 100.0 * f64::from(mission.completion);
        tiles.push((format!("{percent:.0} %"), "of the dirty floor claimed clean", ""));
    }
    tiles
}

fn rows(plan: &Plan, observation: &Observation) -> Vec<(&'static str, String)> {
    let verdict = &observation.verdict;
    let mut rows = made_now(Some(&plan.robot_toml));
    rows.push(("run", format!("scenario {}, seed {}", verdict.scenario, verdict.seed)));
    rows.push(("verdict", format!("{}: {}", verdict.verdict.words(), verdict.reason)));
    if let Some(ready_s) = observation.ready_s {
        rows.push(("ready to move", format!("after {ready_s:.1} s")));
    }
    let unneeded = format!("{} of {} without need", verdict.nuisance_stops, verdict.stops);
    let kinds = kinds(observation).into_iter().map(|(kind, count)| format!("; {count} × {kind}"));
    rows.push(("stops", unneeded + &kinds.collect::<String>()));
    let mut held: Vec<_> = observation.under_cause_s.iter().collect();
    held.sort_by(|a, b| b.1.total_cmp(a.1));
    let held: Vec<_> = held.iter().take(HELD_MAX).map(|(kind, s)| format!("{s:.0} s {kind}")).collect();
    if !held.is_empty() {
        rows.push(("held back by", held.join("; ")));
    }
    let latency = &verdict.stop_latency_ms;
    if latency.count > 0 {
        let (median, most) = (latency.median, latency.p99);
        let times = counted(latency.count as u64, "time");
        let text = format!("median {median:.0} ms, 99 % within {most:.0} ms ({times})");
        rows.push(("measurement to order to stop", text));
    }
    let lines = verdict.bodies.contacts.iter().filter(|contact| contact.while_moving());
    let lines: String = lines.map(|contact| format!("; {}", contact.line())).collect();
    rows.push(("contacts", verdict.contacts_in_words() + &lines));
    if let (Some(mota), Some(idf1)) = (verdict.mota, verdict.idf1) {
        let off_m = verdict.localisation_error_m.unwrap_or(0.0);
        let switches = counted(verdict.id_switches, "identity switch");
        let text = format!("within 12 m: MOTA {mota:.2}, IDF1 {idf1:.2}, {switches}, {off_m:.2} m off");
        rows.push(("people in sight", text));
    }
    if let Some(mission) = &verdict.mission {
        rows.extend(cleaning(mission, observation.cleaned_m2));
    }
    if let Some(learned) = &verdict.learned {
        rows.push(("learned", learned.words()));
    }
    if !verdict.faulty_sources.is_empty() {
        rows.push(("sources that failed", verdict.faulty_sources.join(", ")));
    }
    if observation.resets > 0 {
        rows.push(("operator", format!("pressed reset {}", counted(observation.resets, "time"))));
    }
    rows.push(("fingerprint", format!("{} of {}", verdict.digest, plan.name)));
    rows
}

fn cleaning(mission: &MissionReport, brushed_m2: f64) -> Vec<(&'static str, String)> {
    let (strategy, before, after) = (&mission.strategy, mission.dirt_before_units, mission.dirt_after_units);
    let end = mission.end_in_words();
    let off_m = mission.localisation_error_m.unwrap_or_default();
    vec![
        ("cleaning", format!("{strategy}, {end}; {brushed_m2:.1} m² brushed; dirt {before} → {after} units")),
        (
            "claims",
            format!(
                "{} of {} claimed clean, {} of them falsely",
                mission.claimed_cells,
                counted(mission.dirty_cells as u64, "dirty cell"),
                mission.falsely_claimed_cells
            ),
        ),
        (
            "in the way",
            format!(
                "people and objects cost {:.0} s and {}; {off_m:.2} m off the true place",
                mission.people_cost_s,
                counted(mission.detours, "detour")
            ),
        ),
    ]
}
