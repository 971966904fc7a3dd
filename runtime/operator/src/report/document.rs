//! The report of a recording: one HTML file that needs nothing else, for a phone, a screen and a printer.

use std::collections::BTreeMap;
use std::fmt::Write;

use floorguard_types::geometry::Point2;

use super::charts;
use super::grids::{self, Scale};
use super::history::{History, Stop};
use super::mission;
use super::proof::{self, Circumstances};
use super::sketch;
use super::slider;
use super::style::{self, chart, count_tile, escaped, map, tiles};
use floorguard_recording::topics;

/// The page.
#[must_use]
pub fn document(history: &History, circumstances: &Circumstances) -> String {
    let name = circumstances.recording.as_str();
    let title = history.texts.get("title").cloned().unwrap_or_else(|| name.to_owned());
    let mut html = style::head(&title);
    head(&mut html, history, name);
    html.push_str(&proof::section(&proof::proof(history, circumstances)));
    let picture = map(&sketch::overview(history)) + &slider::slider(history);
    section(&mut html, "Map, path and stops", &picture, OVERVIEW_LEGEND);
    mission::section(&mut html, history);
    let speeds: Vec<_> =
        history.speeds.iter().map(|s| (s.at_s, s.speed_mps, s.limit_mps.unwrap_or(0.0))).collect();
    let speeds = charts::speeds(history.duration_s, &speeds, history.stops.iter().map(|stop| stop.at_s));
    // A bag of somebody else's robot knows of no guard: its stops are unknown.
    if history.speeds.iter().any(|speed| speed.limit_mps.is_some()) || !history.stops.is_empty() {
        section(&mut html, "Speed and limit", &chart(&speeds), SPEED_LEGEND);
        stops(&mut html, history);
    } else {
        section(&mut html, "Speed", &chart(&speeds), "Line: measured speed in m/s.");
    }
    if !history.heat.is_empty() {
        let legend = "Darker: people were there longer, each step four times as long.";
        section(&mut html, "Where people were", &map(&sketch::heat(history)), legend);
    }
    // The map is drawn above, and the mission has a section of its own.
    let drawn = [topics::MAP, topics::CLAIMED, topics::DIRT];
    for (topic, (first, last)) in history.grids.iter().filter(|(topic, _)| !drawn.contains(&topic.as_str())) {
        let picture = |grid| grids::picture(grid, Scale::Occupied);
        let both = if first.cells == last.cells {
            picture(last)
        } else {
            format!("<p>before:</p>{}<p>after:</p>{}", picture(first), picture(last))
        };
        let legend = format!("{GRID_LEGEND} {}", grids::size(last));
        section(&mut html, &format!("Map {}", escaped(topic)), &both, &legend);
    }
    if !history.sources.is_empty() {
        let legend = "Green: healthy. Yellow: limits the robot. Red: stops it. Grey: says nothing.";
        section(&mut html, "Health of the sources", &chart(&charts::sources(history)), legend);
    }
    counters(&mut html, history);
    html + "</main></html>\n"
}

/// Entries of the list of what held the robot; more make the page too long for a phone.
const HELD_MAX: usize = 200;

const OVERVIEW_LEGEND: &str = "White: seen free. Dark: something stands there. Blue: the robot's path. Thin coloured \
lines: tracked people. Red: stops, numbered as below. In the odometry frame, without correction.";
const SPEED_LEGEND: &str = "Line: measured speed in m/s. Area: what the guard permits. Red ticks: stops.";
const GRID_LEGEND: &str = "White: 0. Dark: 100. Blue-grey: unknown.";

fn section(html: &mut String, title: &str, picture: &str, legend: &str) {
    let _ = write!(html, "<h2>{title}</h2>{picture}<p class=legend>{legend}</p>");
}

fn head(html: &mut String, history: &History, name: &str) {
    let text = |key: &str| history.texts.get(key).map(String::as_str);
    let run = [("scenario", text("scenario")), ("seed", text("seed")), ("floorguard", text("version"))];
    let run: Vec<String> = run
        .iter()
        .filter_map(|(name, value)| value.map(|value| format!("{name} {}", escaped(value))))
        .collect();
    let _ = write!(
        html,
        "<p class=legend>{}{}</p>",
        escaped(name),
        run.iter().fold(String::new(), |all, one| all + ", " + one)
    );
    if let Some(ended) = &history.ended {
        let _ =
            write!(html, "<p class=cut>Incomplete: {}. Everything before it is shown.</p>", escaped(ended));
    }
    if let Some(learned) = &history.learned {
        let _ = write!(html, "<p class=legend>Learned: {}.</p>", escaped(learned));
    }
    let moving_s = history.speeds.windows(2).filter(|pair| pair[0].speed_mps.abs() > 0.02);
    // The sum of nothing is −0.
    let moving_s = moving_s.map(|pair| pair[1].at_s - pair[0].at_s).sum::<f64>() + 0.0;
    let people = history.people.values().filter(|path| path.len() > 5).count();
    html.push_str(&tiles([
        (format!("{:.0} s", history.duration_s), "recorded", ""),
        (format!("{:.1} m", history.driven_m), "driven", ""),
        (format!("{moving_s:.0} s"), "moving", ""),
        count_tile(history.stops.len() as u64, "stop", "stops"),
        count_tile(people as u64, "person followed", "people followed"),
        count_tile(history.messages, "message", "messages"),
    ]));
}

fn stops(html: &mut String, history: &History) {
    let _ = write!(html, "<h2>Stops ({})</h2>", history.stops.len());
    if history.stops.is_empty() {
        html.push_str("<p>The robot never had to stop.</p>");
        return;
    }
    let mut counts = BTreeMap::<&str, usize>::new();
    for stop in &history.stops {
        *counts.entry(&stop.status.name).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    html.push_str("<table><tr><th>cause<th class=num>times</tr>");
    for (cause, count) in counts {
        let _ = write!(html, "<tr><td>{}<td class=num>{count}</tr>", escaped(cause));
    }
    html.push_str("</table>");
    let toml = history.texts.get("robot.toml");
    let robot = toml.and_then(|text| floorguard_configuration::parse_recorded("robot.toml", text).ok());
    let footprint: Vec<Point2> = robot
        .map(|parsed| parsed.configuration.robot.geometry.footprint.iter().copied().collect())
        .unwrap_or_default();
    for (index, stop) in history.stops.iter().enumerate() {
        one_stop(html, (index + 1, stop), &footprint);
    }
    held(html, history);
    html.push_str(
        "<p class=legend>Pictures: the robot in blue, its front up; the fields that were watched in yellow and red; \
         dots: what the safety scanner saw last; orange: tracked people.</p>",
    );
}

/// What held the robot one after another, and what came of the resets.
fn held(html: &mut String, history: &History) {
    if history.held.is_empty() {
        return;
    }
    html.push_str("<h3>What held the robot, and resets</h3><table><tr><th class=num>time<th>what</tr>");
    for (at_s, text) in history.held.iter().take(HELD_MAX) {
        let _ = write!(html, "<tr><td class=num>{at_s:.1} s<td>{}</tr>", escaped(text));
    }
    html.push_str("</table>");
    if history.held.len() > HELD_MAX {
        let _ =
            write!(html, "<p class=legend>{} more are in the recording.</p>", history.held.len() - HELD_MAX);
    }
}

fn one_stop(html: &mut String, (number, stop): (usize, &Stop), footprint: &[Point2]) {
    let _ = write!(
        html,
        "<div class=stop id=stop{number}><div><b>{number}. {:.1} s: {}</b><dl>",
        stop.at_s,
        escaped(&stop.status.name)
    );
    let value = |name: &str| stop.status.value(name).filter(|value| !value.is_empty());
    let unit = value("unit").unwrap_or_default();
    let rows = [
        ("what followed", value("action").map(str::to_owned)),
        ("measured", value("value").map(|value| format!("{value} {unit}"))),
        ("limit", value("limit").map(|value| format!("{value} {unit}"))),
        ("age", value("age_ms").map(|value| format!("{value} ms"))),
        ("speed", value("speed_mps").map(|value| format!("{value} m/s"))),
        ("place", Some(format!("{:.2} m, {:.2} m", plain(stop.pose.x_m), plain(stop.pose.y_m)))),
        // The message repeats the values; it stands for them where there are none.
        ("in full", value("value").is_none().then(|| stop.status.message.clone())),
    ];
    for (name, text) in rows {
        if let Some(text) = text {
            let _ = write!(html, "<dt>{name}<dd>{}", escaped(&text));
        }
    }
    html.push_str("</dl></div>");
    if let Some(moment) = &stop.moment {
        html.push_str(&sketch::moment(stop, moment, footprint));
    }
    html.push_str("</div>");
}

/// To the centimetre, and nothing is nothing: no −0.
fn plain(metres: f32) -> f32 {
    (metres * 100.0).round() / 100.0 + 0.0
}

fn counters(html: &mut String, history: &History) {
    if history.counters.is_empty() {
        return;
    }
    html.push_str("<h2>Counters at the end</h2><div class=wide tabindex=0 role=region aria-label=\"Counters at the end\"><table>");
    for (group, values) in &history.counters {
        for (name, value) in values {
            let _ = write!(
                html,
                "<tr><td>{}<td>{}<td class=num>{}</tr>",
                escaped(group),
                escaped(name),
                escaped(value)
            );
        }
    }
    html.push_str("</table></div>");
}
