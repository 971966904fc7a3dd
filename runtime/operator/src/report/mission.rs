//! What a cleaning mission came to: claimed-clean map, dirt before and after, progress over time.

use std::fmt::Write;

use super::charts;
use super::grids::{self, Scale};
use super::history::History;
use super::proof::{self, ASSUMED, CLEANED, TO_DO};
use super::style::{chart, count_tile, tiles};
use floorguard_recording::decode::Grid;
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
        html.push_str("<h3>The floor</h3>");
        html.push_str(&grids::picture(&states(history, claimed), Scale::State));
        let _ = write!(
            html,
            "<p class=legend>Green: cleaned in this run. Blue: assumed clean. Yellow: swept, but not surely enough. \
             White: to do. Grey: not the mission's floor. {}</p>",
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

/// What became of each cell, as the proof says it, in steps of [`Scale::State`].
fn states(history: &History, claimed: &Grid) -> Grid {
    let mut states = proof::cells(history).into_iter().map(|cell| match cell.state {
        CLEANED => 100,
        ASSUMED => 20,
        TO_DO => 0,
        _ => 50,
    });
    let cells = claimed.cells.iter().map(|cell| if *cell < 0 { -1 } else { states.next().unwrap_or(-1) });
    Grid { cells: cells.collect(), ..claimed.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_recording::decode::Header;
    use floorguard_types::geometry::Pose2;
    use floorguard_types::time::Stamp;

    fn grid(cells: &[i8]) -> Grid {
        let header = Header { stamp: Stamp::ZERO, frame: "map".to_owned() };
        let (width, cells) = (cells.len(), cells.to_vec());
        Grid { header, resolution_m: 0.1, width, height: 1, origin: Pose2::default(), cells }
    }

    /// What nobody has cleaned is not drawn as what was: of this floor a single cell was cleaned in the run.
    #[test]
    fn assumed_floor_has_a_colour_of_its_own() {
        let mut history = History::default();
        let (first, last) = (grid(&[100, 100, 0, 0, -1, 0]), grid(&[100, 100, 100, 50, -1, 0]));
        history.grids.insert(topics::CLAIMED.to_owned(), (first, last.clone()));
        let shown = states(&history, &last);
        assert_eq!(shown.cells, [20, 20, 100, 50, -1, 0]);
        let svg = grids::picture(&shown, Scale::State);
        assert!(svg.contains("M1 1h2v1h-2z\" fill=\"#8ab6d6\""), "{svg}");
        assert!(svg.contains("M3 1h1v1h-1z\" fill=\"#7fb77e\""), "{svg}");
    }
}
