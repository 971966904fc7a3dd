//! The folder: one self-contained page, the pictures alone, and the verdict for machines.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::facts::facts;
use super::view::top_view;
use crate::world::{Observation, Plan};
use floorguard_operator::report::style::{self, chart, escaped, map};
use floorguard_operator::report::{charts, make_folder};
use floorguard_operator::words::Language;

const MAP_LEGEND: &str = "Blue: the robot's path, its start as an outline and its end filled; light blue: what the brush \
passed over. Coloured lines: people, the dot where each was last. Discs: stops, numbered as below. Dark: walls; grey: \
furniture. This is the true world, which the robot never sees.";
const SPEED_LEGEND: &str =
    "Line: measured speed in m/s, once a second. Area: what the guard permits. Red ticks: stops.";

/// Writes `index.html`, `top-view.svg`, `speed.svg` and `verdict.json`. Gives the path of the page.
///
/// # Errors
/// The folder cannot be made or written.
pub fn write_report(folder: &Path, plan: &Plan, observation: &Observation) -> anyhow::Result<PathBuf> {
    make_folder(folder)?;
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).with_context(|| format!("{}: cannot be written", path.display()))?;
        anyhow::Ok(path)
    };
    let picture = top_view(plan, observation);
    let stops_s = observation.stops.iter().map(|stop| stop.at_s);
    let speed =
        charts::speeds((observation.verdict.duration_s, Language::English), &observation.speeds, stops_s);
    write("top-view.svg", &picture.to_svg())?;
    write("speed.svg", &speed)?;
    write("verdict.json", &serde_json::to_string_pretty(&observation.verdict)?)?;
    write("index.html", &page(plan, observation, (&picture.map_svg(), &speed)))
}

fn page(plan: &Plan, observation: &Observation, (picture, speed): (&str, &str)) -> String {
    let mut html = style::head(&plan.scenario.title);
    let mut cleaning = observation.mission.as_ref().map(super::cleaning::section).unwrap_or_default();
    cleaning.extend(observation.seen_dirt.as_ref().map(super::seen_dirt::section));
    let _ = write!(
        html,
        "{}<h2>Path, people and stops</h2>{}<p class=legend>{MAP_LEGEND}</p>{cleaning}<h2>Speed and limit</h2>{}\
         <p class=legend>{SPEED_LEGEND}</p><h2>Stops ({})</h2>",
        facts(plan, observation),
        map(picture),
        chart(speed),
        observation.stops.len()
    );
    stops(&mut html, observation);
    held(&mut html, observation);
    html.push_str("</main></html>\n");
    html
}

fn stops(html: &mut String, observation: &Observation) {
    if observation.stops.is_empty() {
        html.push_str("<p>The robot never had to stop.</p>");
        return;
    }
    html.push_str("<table><tr><th>stop<th class=num>time<th class=num>speed<th>why</tr>");
    let causes =
        floorguard_operator::picture::cause_colours(observation.stops.iter().map(|stop| stop.kind.as_str()));
    for ((number, stop), colour) in (1..).zip(&observation.stops).zip(causes) {
        let _ = write!(
            html,
            "<tr><td><span class=disc style=\"background:{colour}\">{number}</span><td class=num>{:.1} s<td \
             class=num>{:.2} m/s<td>{}</tr>",
            stop.at_s,
            // No −0.
            (stop.speed_mps * 100.0).round() / 100.0 + 0.0,
            escaped(&stop.cause)
        );
    }
    html.push_str("</table>");
}

/// What else held the robot, and what came of the resets.
fn held(html: &mut String, observation: &Observation) {
    if observation.held.is_empty() {
        return;
    }
    html.push_str("<h3>What else held the robot, and resets</h3><table><tr><th class=num>time<th>what<th>what helps</tr>");
    for event in &observation.held {
        let _ = write!(
            html,
            "<tr><td class=num>{:.1} s<td>{}<td>{}</tr>",
            event.at_s,
            escaped(&event.text),
            event.remedy
        );
    }
    html.push_str("</table>");
}
