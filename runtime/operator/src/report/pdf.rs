//! The proof of cleaning as a PDF file, without a browser.

use super::history::History;
use super::proof::{Cell, Proof, cells};
use super::sheet::Sheet;
use floorguard_recording::topics;

/// Stops that are listed; the page of the report lists all.
const STOPS_MAX: usize = 60;
/// Rows of what held the robot.
const HELD_MAX: usize = 40;

/// The file.
#[must_use]
pub fn pdf(proof: &Proof, history: &History) -> Vec<u8> {
    let mut sheet = Sheet::new("Proof of cleaning");
    let facts = [
        ("date", proof.date.as_str()),
        ("robot", proof.robot.as_str()),
        ("operator", proof.operator.as_str()),
        ("software", proof.software.as_str()),
        ("map", proof.map.as_str()),
        ("recording", proof.recording.as_str()),
    ];
    for (name, text) in facts.into_iter().filter(|(_, text)| !text.is_empty()) {
        sheet.row(&[(0.0, name), (90.0, text)], false);
    }
    let run =
        format!("{:.0} s, {:.1} m driven, {} stops", proof.duration_s, proof.driven_m, proof.stops.len());
    sheet.row(&[(0.0, "run"), (90.0, &run)], false);
    if let Some(cleaning) = &proof.cleaning {
        claims(&mut sheet, cleaning);
    }
    plan(&mut sheet, history);
    if !proof.stops.is_empty() {
        sheet.heading("Stops");
        for stop in proof.stops.iter().take(STOPS_MAX) {
            sheet.row(&[(0.0, &format!("{:.1} s", stop.at_s)), (90.0, &stop.cause)], false);
        }
        if proof.stops.len() > STOPS_MAX {
            let more = format!("{} more are in the recording.", proof.stops.len() - STOPS_MAX);
            sheet.row(&[(90.0, &more)], false);
        }
    }
    if !history.held.is_empty() {
        sheet.heading("What held the robot, and resets");
        for (at_s, words) in history.held.iter().take(HELD_MAX) {
            sheet.row(&[(0.0, &format!("{at_s:.1} s")), (90.0, words)], false);
        }
    }
    sheet.signatures(&["operator", "customer", "date"]);
    sheet.finish()
}

fn claims(sheet: &mut Sheet, cleaning: &super::proof::Cleaning) {
    sheet.heading("What is claimed");
    let claim = match (cleaning.confidence_percent, cleaning.tolerated_units) {
        (Some(percent), Some(units)) => {
            format!("with {percent:.1} % confidence no more than {units} units of dirt in each cell")
        }
        _ => "clean".to_owned(),
    };
    let rows = [
        ("cleaned", cleaning.cleaned_m2, claim.as_str()),
        ("assumed clean", cleaning.assumed_m2, "no dirt was expected there; not cleaned in this run"),
        ("not claimed", cleaning.to_do_m2, "nothing; the reasons stand below"),
    ];
    sheet.row(&[(0.0, "floor"), (110.0, "area"), (180.0, "claim")], true);
    sheet.rule();
    for (name, area_m2, claim) in rows {
        sheet.row(&[(0.0, name), (110.0, &format!("{area_m2:.1} m²")), (180.0, claim)], false);
    }
    for reason in &cleaning.not_claimed {
        let cells = format!("{} cells", reason.cells);
        sheet.row(&[(0.0, "not claimed:"), (110.0, &cells), (180.0, &reason.reason)], false);
    }
    let rest = format!(
        "{:.0} % of the expected dirt is gone; the robot waited {:.0} s for people. At the end the mission was: {}.",
        cleaning.dirt_gone_percent, cleaning.waited_s, cleaning.phase
    );
    sheet.row(&[(0.0, &rest)], false);
}

/// The floor in three colours, as on the panel.
fn plan(sheet: &mut Sheet, history: &History) {
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
    sheet.heading("The floor");
    sheet.plan((last.width, last.height), squares);
    sheet.row(&[(0.0, "Green: cleaned in this run. Blue: assumed clean. Yellow: not claimed.")], false);
}
