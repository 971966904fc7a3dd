//! What a cleaning mission came to: claimed-clean map, dirt before and after, progress over time.

use std::fmt::Write;

use super::document::{chart, escaped};
use super::grids::{self, Scale};
use super::history::History;
use crate::recording::topics;

/// The section; nothing for a run without a mission.
pub fn section(html: &mut String, history: &History) {
    let Some((_, last)) = history.mission.last() else { return };
    let value = |name: &str| last.iter().find(|(key, _)| key == name).map_or("", |(_, value)| value.as_str());
    let _ = write!(html, "<h2>Cleaning mission</h2><ul class=sum>");
    let share = |name: &str| format!("{} %", value(name));
    let dirt = |name: &str| value(name).parse::<f64>().unwrap_or(0.0);
    let gone = 100.0 * (1.0 - dirt("dirt_now_units") / dirt("dirt_before_units").max(1.0e-6));
    let tiles = [
        (share("completion_percent"), "of the dirty floor claimed clean"),
        (share("claimed_percent"), "of all floor claimed clean"),
        (format!("{} m²", value("remaining_m2")), "remaining"),
        (format!("{gone:.0} %"), "of the expected dirt gone"),
        (format!("{} s", value("waited_s")), "waited for people"),
        (value("uncertain_cells").to_owned(), "cells not claimed"),
    ];
    for (value, what) in tiles {
        let _ = write!(html, "<li><b>{}</b>{what}</li>", escaped(&value));
    }
    let _ = write!(html, "</ul>{}", chart(&progress(history)));
    html.push_str("<p class=legend>Line: dirty floor claimed clean, percent, over the time of the run.</p>");
    if let Some((_, claimed)) = history.grids.get(topics::CLAIMED) {
        html.push_str("<h3>Claimed clean</h3>");
        html.push_str(&grids::picture(claimed, Scale::Claimed));
        html.push_str(
            "<p class=legend>Green: claimed clean. Yellow: swept, but not surely enough. White: not cleaned. Grey: \
             not the mission's floor.</p>",
        );
    }
    if let Some((before, after)) = history.grids.get(topics::DIRT) {
        html.push_str("<h3>Dirt before and after</h3><div class=pair>");
        for (grid, when) in [(before, "before"), (after, "after")] {
            let _ = write!(
                html,
                "<figure>{}<figcaption>{when}</figcaption></figure>",
                grids::picture(grid, Scale::Dirt)
            );
        }
        html.push_str(
            "</div><p class=legend>Expected dirt; darkest: as much as the dirtiest place had before.</p>",
        );
    }
}

/// Completion over time.
fn progress(history: &History) -> String {
    const WIDTH: f64 = 960.0;
    const HEIGHT: f64 = 120.0;
    let last_s = history.duration_s.max(1.0);
    let mut line = String::new();
    for (at_s, values) in &history.mission {
        let done = values.iter().find(|(key, _)| key == "completion_percent");
        let Some(percent) = done.and_then(|(_, value)| value.parse::<f64>().ok()) else { continue };
        let word = if line.is_empty() { 'M' } else { 'L' };
        let (x, y) =
            (44.0 + at_s / last_s * (WIDTH - 54.0), HEIGHT - 10.0 - percent * (HEIGHT - 20.0) / 100.0);
        let _ = write!(line, "{word}{x:.1} {y:.1}");
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-size=\"12\" role=\"img\" \
         aria-label=\"progress of the mission\"><path d=\"M44 {b}H950M44 10H950\" stroke=\"#d8dee5\"/><text x=\"4\" \
         y=\"14\">100 %</text><text x=\"4\" y=\"{b}\">0 %</text><path d=\"{line}\" fill=\"none\" stroke=\"#2e7d32\" \
         stroke-width=\"2\"/></svg>",
        b = HEIGHT - 10.0
    )
}
