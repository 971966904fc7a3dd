//! The floor of a cleaning mission as pictures: the dirt before and after, and what the robot claims to be clean.

use std::fmt::Write;

use crate::judge::MissionOutcome;
use floorguard_robot::cleaner::CellState;

/// A colour and what it means.
pub(super) type Legend = (&'static str, &'static str);

/// Dirt in a cell, from nothing to much; the last one is without an upper end.
const DIRT: [Legend; 5] = [
    ("#ffffff", "clean floor"),
    ("#f3e3c0", "1 to 5 units: tolerated"),
    ("#e2a24c", "6 to 10"),
    ("#b85f1d", "11 to 20"),
    ("#6e2a0a", "more than 20"),
];
/// The status of a cell.
const CLAIMS: [Legend; 4] = [
    ("#bfe3c6", "claimed clean"),
    ("#e2a24c", "not claimed: dirty"),
    ("#9b6bd6", "not claimed: the brush may have missed it"),
    ("#c0392b", "claimed, but dirty in truth"),
];
/// Beyond the reach of the brush.
const OFF_LIMITS: &str = "#b8c4cf";
/// Cells around what the mission answers for.
const AROUND: usize = 5;

/// The three pictures with a table, as part of a page.
#[must_use]
pub fn section(mission: &MissionOutcome) -> String {
    let mut html = String::from("<h2>Cleaning</h2>");
    let cells = &mission.progress.cells;
    let dirt = |units: &[u32]| -> Vec<Option<usize>> {
        let shade = |units: u32| match units {
            0 => 0,
            1..=5 => 1,
            6..=10 => 2,
            11..=20 => 3,
            _ => 4,
        };
        let shown =
            |(units, state): (&u32, &CellState)| (*state != CellState::OffLimits).then(|| shade(*units));
        units.iter().zip(cells).map(shown).collect()
    };
    let tolerated = u32::from(mission.report.tolerated_units);
    let claim = |(state, left): (&CellState, &u32)| match state {
        CellState::OffLimits => None,
        CellState::Clean if *left > tolerated => Some(3),
        CellState::Clean => Some(0),
        CellState::Dirty => Some(1),
        CellState::Uncertain | CellState::Active => Some(2),
    };
    let claims: Vec<Option<usize>> = cells.iter().zip(&mission.after).map(claim).collect();
    let _ = write!(
        html,
        "<div class=pair><figure><h3>Dirt before: {} units</h3>{}</figure><figure><h3>Dirt after: {} units</h3>{}</figure></div><h3>Claimed clean: {} of {} dirty cells</h3>{}",
        mission.report.dirt_before_units,
        picture(mission, &dirt(&mission.before), &DIRT),
        mission.report.dirt_after_units,
        picture(mission, &dirt(&mission.after), &DIRT),
        mission.report.claimed_cells,
        mission.report.dirty_cells,
        picture(mission, &claims, &CLAIMS),
    );
    if !mission.report.uncertain_cells.is_empty() {
        html.push_str("<table><tr><th class=num>cells not claimed<th>why</tr>");
        for (reason, count) in &mission.report.uncertain_cells {
            let _ = write!(html, "<tr><td class=num>{count}<td>{reason}</tr>");
        }
        html.push_str("</table>");
    }
    html
}

fn picture(mission: &MissionOutcome, shades: &[Option<usize>], legend: &[Legend]) -> String {
    raster(mission.progress.geometry.width().into(), shades, legend)
}

/// A raster as SVG: cells of equal shade in a row become one rectangle.
pub(super) fn raster(width: usize, shades: &[Option<usize>], legend: &[Legend]) -> String {
    let rows: Vec<&[Option<usize>]> = shades.chunks(width.max(1)).collect();
    let used_rows =
        || rows.iter().enumerate().filter(|(_, row)| row.iter().any(Option::is_some)).map(|(at, _)| at);
    let used = |column: &usize| rows.iter().any(|row| row.get(*column).is_some_and(Option::is_some));
    let (Some(first_row), Some(last_row)) = (used_rows().min(), used_rows().max()) else {
        return String::new();
    };
    let columns = || (0..width).filter(used);
    let (Some(first), Some(last)) = (columns().min(), columns().max()) else { return String::new() };
    let (first, last) = (first.saturating_sub(AROUND), (last + AROUND).min(width - 1));
    let (wide, high) = (last - first + 1, last_row - first_row + 1);
    let words: Vec<&str> = legend.iter().map(|(_, words)| *words).collect();
    let words = words.join(", ").replace('"', "");
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {wide} {high}\" \
         shape-rendering=\"crispEdges\" role=\"img\" aria-label=\"floor in cells: {words}\"><rect width=\"100%\" height=\"100%\" fill=\"{OFF_LIMITS}\"/>"
    );
    for (shade, (colour, _)) in legend.iter().enumerate() {
        let mut path = String::new();
        for (row, cells) in rows.iter().enumerate().take(last_row + 1).skip(first_row) {
            let mut column = first;
            while column <= last {
                let run = cells[column..=last].iter().take_while(|cell| **cell == Some(shade)).count();
                if run > 0 {
                    let _ = write!(path, "M{} {}h{run}v1h-{run}z", column - first, last_row - row);
                }
                column += run.max(1);
            }
        }
        let _ = write!(svg, "<path d=\"{path}\" fill=\"{colour}\"/>");
    }
    svg.push_str("</svg><p class=legend>");
    for (colour, words) in legend {
        let _ = write!(svg, "<span class=key><i style=\"background:{colour}\"></i>{words}</span> ");
    }
    svg + "</p>"
}
