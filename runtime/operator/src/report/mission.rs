//! What a cleaning mission came to: claimed-clean map, dirt before and after, progress over time.

use std::fmt::Write;

use super::charts;
use super::grids::{self, Scale};
use super::history::History;
use super::proof::{self, ASSUMED, CLEANED, TO_DO};
use super::style::{chart, count_tile_in, tiles};
use crate::words::Language;
use floorguard_recording::decode::Grid;
use floorguard_recording::topics;

const STATE_LEGEND: &str = "Green: cleaned in this run. Blue: assumed clean. Yellow: swept, but not surely enough. \
White: to do. Grey: not the mission's floor.";

/// The section; nothing for a run without a mission.
pub fn section(html: &mut String, history: &History, language: Language) {
    let Some((_, last)) = history.mission.last() else { return };
    let value = |name: &str| last.iter().find(|(key, _)| key == name).map_or("", |(_, value)| value.as_str());
    let say = |words: &'static str| language.say(words);
    let _ = write!(html, "<h2>{}</h2>", say("Cleaning mission"));
    let share = |name: &str| format!("{} %", language.decimals(value(name)));
    let dirt = |name: &str| value(name).parse::<f64>().unwrap_or(0.0);
    let gone = 100.0 * (1.0 - dirt("dirt_now_units") / dirt("dirt_before_units").max(1.0e-6));
    html.push_str(&tiles([
        (share("completion_percent"), say("of the dirty floor claimed clean"), ""),
        (share("claimed_percent"), say("of all floor claimed clean"), ""),
        (format!("{} m²", language.decimals(value("remaining_m2"))), say("remaining"), ""),
        (format!("{gone:.0} %"), say("of the expected dirt gone"), ""),
        (format!("{} s", language.decimals(value("waited_s"))), say("waited for people"), ""),
        count_tile_in(
            language,
            value("uncertain_cells").parse().unwrap_or(0),
            ["cell not claimed", "cells not claimed"],
        ),
    ]));
    html.push_str(&chart(&charts::progress(history, language)));
    let line = say("Line: dirty floor claimed clean, percent, over the time of the run.");
    let _ = write!(html, "<p class=legend>{line}</p>");
    if let Some((_, claimed)) = history.grids.get(topics::CLAIMED) {
        let _ = write!(
            html,
            "<h3>{}</h3>{}<p class=legend>{} {}</p>",
            say("The floor"),
            grids::picture(&states(history, claimed), Scale::State, language),
            say(STATE_LEGEND),
            grids::size(claimed, language)
        );
    }
    if let Some((before, after)) = history.grids.get(topics::DIRT) {
        let _ = write!(html, "<h3>{}</h3><div class=pair>", say("Dirt before and after"));
        for (grid, when) in [(before, "before"), (after, "after")] {
            let _ = write!(
                html,
                "<figure>{}<figcaption>{}</figcaption></figure>",
                grids::picture(grid, Scale::Dirt, language),
                say(when)
            );
        }
        let legend = say("Expected dirt; darkest: as much as the dirtiest place had before.");
        let _ = write!(html, "</div><p class=legend>{legend}</p>");
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
        let svg = grids::picture(&shown, Scale::State, Language::English);
        assert!(svg.contains("M1 1h2v1h-2z\" fill=\"#8ab6d6\""), "{svg}");
        assert!(svg.contains("M3 1h1v1h-1z\" fill=\"#7fb77e\""), "{svg}");
    }
}
