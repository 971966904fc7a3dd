//! What the robot did on a day, as a PDF file for a customer.

use std::collections::BTreeMap;

use super::records::{Day, MissionRecord};
use crate::report::Sheet;

/// Rows of a table at most.
const ROWS_MAX: usize = 12;

/// The file.
pub fn pdf_of_day(date: &str, day: &Day, title: &str) -> Vec<u8> {
    let mut sheet = Sheet::new(&format!("Proof of cleaning, {date}"));
    let software = format!("floorguard {}", env!("CARGO_PKG_VERSION"));
    let (cleaned_m2, hours) = (f64::from(day.cleaned_m2()), day.on_s / 3_600.0);
    let done = format!("{cleaned_m2:.1} m² cleaned and claimed, {:.0} m driven", day.driven_m);
    let times = format!(
        "{:.2} h switched on, {:.2} h moving, {:.2} h held; {:.1} m²/h",
        hours,
        day.moving_s / 3_600.0,
        day.held_s / 3_600.0,
        if hours > 0.05 { cleaned_m2 / hours } else { 0.0 }
    );
    for (name, text) in
        [("robot", title), ("software", software.as_str()), ("done", &done), ("hours", &times)]
    {
        sheet.row(&[(0.0, name), (90.0, text)], false);
    }
    sheet.heading("Missions");
    if day.missions.is_empty() {
        sheet.row(&[(0.0, "No mission ran on this day.")], false);
    }
    day.missions.iter().for_each(|mission| one_mission(&mut sheet, mission));
    let seconds = |held: &BTreeMap<String, f64>| longest(held.iter().map(|(name, value)| (name, *value)));
    let stops = longest(day.stops.iter().map(|(name, count)| (name, f64::from(*count))));
    table(&mut sheet, ("Stops by cause", "times"), stops);
    table(&mut sheet, ("What held it", "s"), seconds(&day.held_by_s));
    table(&mut sheet, ("Where it was held, m in the map", "s"), seconds(&day.held_at_s));
    sheet.signatures(&["operator", "customer", "date"]);
    sheet.finish()
}

fn one_mission(sheet: &mut Sheet, mission: &MissionRecord) {
    let name = if mission.name.is_empty() { "whole floor" } else { &mission.name };
    let time = |iso: &str| iso.get(11..16).unwrap_or(iso).to_owned();
    let span = format!("{} to {}", time(&mission.began), time(&mission.ended));
    sheet.row(&[(0.0, &span), (90.0, name), (330.0, &mission.phase)], true);
    let claim = format!(
        "{:.1} m² cleaned: with {:.1} % confidence no more than {} units of dirt in each cell",
        mission.cleaned_m2, mission.confidence_percent, mission.tolerated_units
    );
    let assumed = format!("{:.1} m² assumed clean: no dirt was expected there", mission.assumed_m2);
    let rest = format!(
        "{:.1} m² not claimed; {} dirty cells out of reach; held {:.0} s by people and objects",
        mission.to_do_m2, mission.unreachable_cells, mission.waited_s
    );
    for text in [&claim, &assumed, &rest] {
        sheet.row(&[(90.0, text)], false);
    }
}

fn longest<'a>(values: impl Iterator<Item = (&'a String, f64)>) -> Vec<(String, f64)> {
    let mut values: Vec<_> = values.map(|(name, value)| (name.clone(), value)).collect();
    values.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    values.truncate(ROWS_MAX);
    values
}

fn table(sheet: &mut Sheet, (name, unit): (&str, &str), rows: Vec<(String, f64)>) {
    if rows.is_empty() {
        return;
    }
    sheet.heading(name);
    for (what, value) in rows {
        sheet.row(&[(0.0, &format!("{value:.0} {unit}")), (90.0, &what)], false);
    }
}
