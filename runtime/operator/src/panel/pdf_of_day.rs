//! What the robot did on a day, as a PDF file for a customer.

use std::collections::BTreeMap;

use super::records::{Day, MissionRecord};
use crate::report::Sheet;
use crate::words::Language;

/// Rows of a table at most.
const ROWS_MAX: usize = 12;

/// The file.
pub fn pdf_of_day(date: &str, day: &Day, (title, language): (&str, Language)) -> Vec<u8> {
    let mut sheet = Sheet::new(&format!("{}, {date}", language.say("Proof of cleaning")));
    let software = format!("floorguard {}", env!("CARGO_PKG_VERSION"));
    let (cleaned_m2, hours) = (f64::from(day.cleaned_m2()), day.on_s / 3_600.0);
    let number = |value: f64, digits: usize| language.number(value, digits);
    let done = [number(cleaned_m2, 1), number(day.driven_m, 0)];
    let done = language.fill("{} m² cleaned and claimed, {} m driven", &[&done[0], &done[1]]);
    let rate = if hours > 0.05 { cleaned_m2 / hours } else { 0.0 };
    let times = [hours, day.moving_s / 3_600.0, day.held_s / 3_600.0].map(|hours| number(hours, 2));
    let times = language.fill(
        "{} h switched on, {} h moving, {} h held; {} m²/h",
        &[&times[0], &times[1], &times[2], &number(rate, 1)],
    );
    for (name, text) in
        [("robot", title), ("software", software.as_str()), ("result", &done), ("hours", &times)]
    {
        sheet.row(&[(0.0, language.say(name)), (90.0, text)], false);
    }
    sheet.heading(language.say("Missions"));
    if day.missions.is_empty() {
        sheet.row(&[(0.0, language.say("No mission ran on this day."))], false);
    }
    day.missions.iter().for_each(|mission| one_mission(&mut sheet, mission, language));
    let seconds = |held: &BTreeMap<String, f64>| longest(held.iter().map(|(name, value)| (name, *value)));
    let stops = longest(day.stops.iter().map(|(name, count)| (name, f64::from(*count))));
    let spoken = |rows: Vec<(String, f64)>| -> Vec<(String, f64)> {
        rows.into_iter().map(|(name, value)| (language.begin(&name), value)).collect()
    };
    table(&mut sheet, (language.say("Stops by cause"), "×"), spoken(stops));
    table(&mut sheet, (language.say("What held it"), "s"), spoken(seconds(&day.held_by_s)));
    table(&mut sheet, (language.say("Where it was held, m in the map"), "s"), seconds(&day.held_at_s));
    sheet.signatures(&["operator", "customer", "date"].map(|name| language.say(name)));
    sheet.finish()
}

fn one_mission(sheet: &mut Sheet, mission: &MissionRecord, language: Language) {
    let name = if mission.name.is_empty() { language.say("whole floor") } else { &mission.name };
    let time = |iso: &str| iso.get(11..16).unwrap_or(iso).to_owned();
    let span = format!("{} – {}", time(&mission.began), time(&mission.ended));
    sheet.row(&[(0.0, &span), (90.0, name), (330.0, language.say(&mission.phase))], true);
    let number = |value: f32, digits: usize| language.number(f64::from(value), digits);
    let claim = language.fill(
        "{} m² cleaned: with {} % confidence no more than {} units of dirt in each cell",
        &[
            &number(mission.cleaned_m2, 1),
            &language.number(mission.confidence_percent, 1),
            &mission.tolerated_units.to_string(),
        ],
    );
    let assumed =
        language.fill("{} m² assumed clean: no dirt was expected there", &[&number(mission.assumed_m2, 1)]);
    let rest = language.fill(
        "{} m² not claimed; {} dirty cells out of reach; held {} s by people and objects",
        &[&number(mission.to_do_m2, 1), &mission.unreachable_cells.to_string(), &number(mission.waited_s, 0)],
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
