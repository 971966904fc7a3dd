//! What a cleaning mission came to: claimed-clean map, dirt before and after, progress over time.

use std::fmt::Write;

use super::charts;
use super::grids::{self, Scale};
use super::history::History;
use super::style::{chart, count_tile, tiles};
use floorguard_recording::topics;

/// The section; nothing for a run without a mission.
pub fn section(html: &mut String, history: &History) {
    let Some((_, last)) = history.mission.last() else { return };
    let value = |name: &str| last.iter().find(|(key, _)| key == name).map_or("", |(_, value)| value.as_str());
    html.push_str("<h2>Cleaning mission</h2>");
    let share = |name: &str| format!("{} %", value(name));
    let dirt = |name: &str| value(name).parse::<f64>().unwrap_or(0.0);
    let gone = 100.0 * (1.0 - dirt("dirt_now_units") / dirt("dirt_before_units").max(1.0e-6));
    html.push_str(&tiles([
        (share("completion_percent"), "of the dirty floor claimed clean", ""),
        (share("claimed_percent"), "of all floor claimed clean", ""),
        (format!("{} m²", value("remaining_m2")), "remaining", ""),
        (format!("{gone:.0} %"), "of the expected dirt gone", ""),
        (format!("{} s", value("waited_s")), "waited for people", ""),
        count_tile(value("uncertain_cells").parse().unwrap_or(0), "cell not claimed", "cells not claimed"),
    ]));
    html.push_str(&chart(&charts::progress(history)));
    html.push_str("<p class=legend>Line: dirty floor claimed clean, percent, over the time of the run.</p>");
    if let Some((_, claimed)) = history.grids.get(topics::CLAIMED) {
        html.push_str("<h3>Claimed clean</h3>");
        html.push_str(&grids::picture(claimed, Scale::Claimed));
        let _ = write!(
            html,
            "<p class=legend>Green: claimed clean. Yellow: swept, but not surely enough. White: not cleaned. Grey: \
             not the mission's floor. {}</p>",
            grids::size(claimed)
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
