//! The proof of cleaning as a PDF file, without a browser, in five languages.

use super::history::History;
use super::proof::{Cell, Cleaning, Proof, cells};
use super::proof_section::{claim, rest};
use super::sheet::Sheet;
use crate::words::Language;
use floorguard_recording::topics;

/// Stops that are listed; the page of the report lists all.
const STOPS_MAX: usize = 60;
/// Rows of what held the robot.
const HELD_MAX: usize = 40;

/// The file.
#[must_use]
pub fn pdf(proof: &Proof, history: &History, language: Language) -> Vec<u8> {
    let mut sheet = Sheet::new(language.say("Proof of cleaning"));
    for (name, text) in proof.facts() {
        sheet.row(&[(0.0, language.say(name)), (90.0, &text)], false);
    }
    let number = |value: f64, digits: usize| language.number(value, digits);
    let (lasted, driven) = (number(proof.duration_s, 0), number(proof.driven_m, 1));
    let run =
        language.fill("{} s, {} m driven, {} stops", &[&lasted, &driven, &proof.stops.len().to_string()]);
    sheet.row(&[(0.0, language.say("run")), (90.0, &run)], false);
    if let Some(cleaning) = &proof.cleaning {
        claims(&mut sheet, cleaning, language);
    }
    plan(&mut sheet, history, language);
    stops(&mut sheet, proof, language);
    if !history.held.is_empty() {
        sheet.heading(language.say("What held the robot, and resets"));
        for (at_s, words) in history.held.iter().take(HELD_MAX) {
            let words = language.cause(words.strip_prefix("held by: ").unwrap_or(words));
            sheet.row(&[(0.0, &format!("{} s", number(*at_s, 1))), (90.0, &words)], false);
        }
    }
    sheet.signatures(&["operator", "customer", "date"].map(|name| language.say(name)));
    sheet.finish()
}

fn stops(sheet: &mut Sheet, proof: &Proof, language: Language) {
    if proof.stops.is_empty() {
        return;
    }
    sheet.heading(language.say("Stops"));
    for stop in proof.stops.iter().take(STOPS_MAX) {
        let at = format!("{} s", language.number(stop.at_s, 1));
        sheet.row(&[(0.0, &at), (90.0, &language.begin(&stop.cause))], false);
    }
    if proof.stops.len() > STOPS_MAX {
        let more = (proof.stops.len() - STOPS_MAX).to_string();
        sheet.row(&[(90.0, &language.fill("{} more are in the recording.", &[&more]))], false);
    }
}

fn claims(sheet: &mut Sheet, cleaning: &Cleaning, language: Language) {
    sheet.heading(language.say("What is claimed"));
    let number = |value: f64, digits: usize| language.number(value, digits);
    let claim = claim(cleaning, language);
    let rows = [
        ("cleaned", cleaning.cleaned_m2, claim.as_str()),
        (
            "assumed clean",
            cleaning.assumed_m2,
            language.say("no dirt was expected there; not cleaned in this run"),
        ),
        ("not claimed", cleaning.to_do_m2, language.say("nothing; the reasons stand below")),
    ];
    let heads = ["floor", "area", "claim"].map(|head| language.say(head));
    let [floor, area, claim] = heads;
    sheet.row(&[(0.0, floor), (130.0, area), (200.0, claim)], true);
    sheet.rule();
    for (name, area_m2, claim) in rows {
        let area = format!("{} m²", number(area_m2, 1));
        sheet.row(&[(0.0, language.say(name)), (130.0, &area), (200.0, claim)], false);
    }
    for reason in &cleaning.not_claimed {
        let cells = language.fill("{} cells", &[&reason.cells.to_string()]);
        let why = language.say(&reason.reason);
        sheet.row(&[(0.0, language.say("not claimed")), (130.0, &cells), (200.0, why)], false);
    }
    sheet.row(&[(0.0, &rest(cleaning, language))], false);
}

/// The floor in three colours, as on the panel.
fn plan(sheet: &mut Sheet, history: &History, language: Language) {
    let Some((_, last)) = history.grids.get(topics::CLAIMED) else { return };
    let colour = |cell: &Cell| match cell.state {
        "cleaned" => [0.18, 0.49, 0.20],
        "assumed clean" => [0.16, 0.45, 0.65],
        _ => [0.79, 0.53, 0.08],
    };
    let index = |metres: f32, origin_m: f32| ((metres - origin_m) / last.resolution_m).max(0.0) as usize;
    let cells = cells(history);
    let squares = cells
        .iter()
        .map(|cell| (index(cell.x_m, last.origin.x_m), index(cell.y_m, last.origin.y_m), colour(cell)));
    sheet.heading(language.say("The floor"));
    sheet.plan((last.width, last.height), squares);
    let key = language.say("Green: cleaned in this run. Blue: assumed clean. Yellow: not claimed.");
    sheet.row(&[(0.0, key)], false);
}
