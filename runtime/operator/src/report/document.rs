//! The report of a recording: one HTML file that needs nothing else, for a phone, a screen and a printer.

use std::collections::BTreeMap;
use std::fmt::Write;

use floorguard_types::geometry::Point2;

use super::charts;
use super::grids::{self, Scale};
use super::history::{History, Stop};
use super::mission;
use super::proof::{Circumstances, proof};
use super::proof_section;
use super::sketch;
use super::slider;
use super::style::{self, chart, count_tile_in, escaped, map, tiles};
use crate::words::Language;
use floorguard_recording::topics;

/// The page, in a language.
#[must_use]
pub fn document(history: &History, circumstances: &Circumstances, language: Language) -> String {
    let name = circumstances.recording.as_str();
    let title = history.texts.get("title").cloned().unwrap_or_else(|| name.to_owned());
    let say = |words: &'static str| language.say(words);
    let footprint = footprint(history);
    let mut html = style::head_in(language, &title);
    head(&mut html, history, (name, language));
    html.push_str(&proof_section::section(&proof(history, circumstances, language), language));
    let picture = map(&sketch::overview(history, language)) + &slider::slider(history, &footprint, language);
    section(&mut html, say("Map, path and stops"), &picture, say(OVERVIEW_LEGEND));
    mission::section(&mut html, history, language);
    let speeds: Vec<_> =
        history.speeds.iter().map(|s| (s.at_s, s.speed_mps, s.limit_mps.unwrap_or(0.0))).collect();
    let speeds =
        charts::speeds((history.duration_s, language), &speeds, history.stops.iter().map(|stop| stop.at_s));
    // A bag of somebody else's robot knows of no guard: its stops are unknown.
    if history.speeds.iter().any(|speed| speed.limit_mps.is_some()) || !history.stops.is_empty() {
        section(&mut html, say("Speed and limit"), &chart(&speeds), say(SPEED_LEGEND));
        stops(&mut html, history, (&footprint, language));
    } else {
        section(&mut html, say("Speed"), &chart(&speeds), say("Line: measured speed in m/s."));
    }
    if !history.heat.is_empty() {
        let legend = say("Darker: people were there longer, each step four times as long.");
        section(&mut html, say("Where people were"), &map(&sketch::heat(history, language)), legend);
    }
    // The map is drawn above, and the mission has a section of its own.
    let drawn = [topics::MAP, topics::CLAIMED, topics::DIRT];
    for (topic, (first, last)) in history.grids.iter().filter(|(topic, _)| !drawn.contains(&topic.as_str())) {
        let picture = |grid| grids::picture(grid, Scale::Occupied, language);
        let both = if first.cells == last.cells {
            picture(last)
        } else {
            let [before, after] = ["before", "after"].map(say);
            format!("<p>{before}:</p>{}<p>{after}:</p>{}", picture(first), picture(last))
        };
        let legend = format!("{} {}", say(GRID_LEGEND), grids::size(last, language));
        section(&mut html, &language.fill("Map {}", &[&escaped(topic)]), &both, &legend);
    }
    if !history.sources.is_empty() {
        let legend = say("Green: healthy. Yellow: limits the robot. Red: stops it. Grey: says nothing.");
        let picture = chart(&charts::sources(history, language));
        section(&mut html, say("Health of the sources"), &picture, legend);
    }
    counters(&mut html, history, language);
    html + "</main></html>\n"
}

/// Entries of the list of what held the robot; more make the page too long for a phone.
const HELD_MAX: usize = 200;

const OVERVIEW_LEGEND: &str = "White: seen free. Dark: something stands there. Blue: the robot's path. Thin coloured \
lines: tracked people. Red: stops, numbered as below. In the odometry frame, without correction.";
const SPEED_LEGEND: &str = "Line: measured speed in m/s. Area: what the guard permits. Red ticks: stops.";
const STOPS_LEGEND: &str = "Pictures: the robot in blue, its front up; the fields that were watched in yellow and red; dots: \
what the safety scanner saw last; orange: tracked people.";
const GRID_LEGEND: &str = "White: 0. Dark: 100. Blue-grey: unknown.";

fn section(html: &mut String, title: &str, picture: &str, legend: &str) {
    let _ = write!(html, "<h2>{title}</h2>{picture}<p class=legend>{legend}</p>");
}

fn head(html: &mut String, history: &History, (name, language): (&str, Language)) {
    let text = |key: &str| history.texts.get(key).map(String::as_str);
    let run =
        [("scenario {}", text("scenario")), ("seed {}", text("seed")), ("floorguard {}", text("version"))];
    let run: Vec<String> = run
        .iter()
        .filter_map(|(name, value)| value.map(|value| language.fill(name, &[&escaped(value)])))
        .collect();
    let _ = write!(
        html,
        "<p class=legend>{}{}</p>",
        escaped(name),
        run.iter().fold(String::new(), |all, one| all + ", " + one)
    );
    if let Some(ended) = &history.ended {
        let words = language.fill("Incomplete: {}. Everything before it is shown.", &[&escaped(ended)]);
        let _ = write!(html, "<p class=cut>{words}</p>");
    }
    if let Some(learned) = &history.learned {
        let words = language.fill("Learned: {}.", &[&escaped(learned)]);
        let _ = write!(html, "<p class=legend>{words}</p>");
    }
    let moving_s = history.speeds.windows(2).filter(|pair| pair[0].speed_mps.abs() > 0.02);
    // The sum of nothing is −0.
    let moving_s = moving_s.map(|pair| pair[1].at_s - pair[0].at_s).sum::<f64>() + 0.0;
    let people = history.people.values().filter(|path| path.len() > 5).count();
    html.push_str(&tiles([
        (format!("{:.0} s", history.duration_s), language.say("recorded"), ""),
        (format!("{} m", language.number(history.driven_m, 1)), language.say("driven"), ""),
        (format!("{moving_s:.0} s"), language.say("moving"), ""),
        count_tile_in(language, history.stops.len() as u64, ["stop", "stops"]),
        count_tile_in(language, people as u64, ["person followed", "people followed"]),
        count_tile_in(language, history.messages, ["message", "messages"]),
    ]));
}

fn stops(html: &mut String, history: &History, (footprint, language): (&[Point2], Language)) {
    let heading = language.fill("Stops ({})", &[&history.stops.len().to_string()]);
    let _ = write!(html, "<h2>{heading}</h2>");
    if history.stops.is_empty() {
        let _ = write!(html, "<p>{}</p>", language.say("The robot never had to stop."));
        return;
    }
    let mut counts = BTreeMap::<&str, usize>::new();
    for stop in &history.stops {
        *counts.entry(&stop.status.name).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let [cause, times] = ["cause", "times"].map(|words| language.say(words));
    let _ = write!(html, "<table><tr><th>{cause}<th class=num>{times}</tr>");
    for (cause, count) in counts {
        let _ = write!(html, "<tr><td>{}<td class=num>{count}</tr>", escaped(&language.begin(cause)));
    }
    html.push_str("</table>");
    for (index, stop) in history.stops.iter().enumerate() {
        one_stop(html, (index + 1, stop), (footprint, language));
    }
    held(html, history, language);
    let _ = write!(html, "<p class=legend>{}</p>", language.say(STOPS_LEGEND));
}

/// Outline of the body that the recording names.
fn footprint(history: &History) -> Vec<Point2> {
    let toml = history.texts.get("robot.toml");
    let robot = toml.and_then(|text| floorguard_configuration::parse_recorded("robot.toml", text).ok());
    robot
        .map(|parsed| parsed.configuration.robot.geometry.footprint.iter().copied().collect())
        .unwrap_or_default()
}

/// What held the robot one after another, and what came of the resets.
fn held(html: &mut String, history: &History, language: Language) {
    if history.held.is_empty() {
        return;
    }
    let heads = ["What held the robot, and resets", "time", "what"].map(|words| language.say(words));
    let [heading, time, what] = heads;
    let _ = write!(html, "<h3>{heading}</h3><table><tr><th class=num>{time}<th>{what}</tr>");
    for (at_s, text) in history.held.iter().take(HELD_MAX) {
        let (at, text) = (language.number(*at_s, 1), language.held(text));
        let _ = write!(html, "<tr><td class=num>{at} s<td>{}</tr>", escaped(&text));
    }
    html.push_str("</table>");
    if history.held.len() > HELD_MAX {
        let more = (history.held.len() - HELD_MAX).to_string();
        let words = language.fill("{} more are in the recording.", &[&more]);
        let _ = write!(html, "<p class=legend>{words}</p>");
    }
}

fn one_stop(html: &mut String, (number, stop): (usize, &Stop), (footprint, language): (&[Point2], Language)) {
    let _ = write!(
        html,
        "<div class=stop id=stop{number}><div><b>{number}. {} s: {}</b><dl>",
        language.number(stop.at_s, 1),
        escaped(&language.begin(&stop.status.name))
    );
    let value = |name: &str| stop.status.value(name).filter(|value| !value.is_empty());
    let unit = value("unit").unwrap_or_default();
    let measured = |name, unit: &str| value(name).map(|it| format!("{} {unit}", language.decimals(it)));
    let metres = |metres: f32| format!("{} m", language.number(plain(metres).into(), 2));
    let whole = || match language {
        Language::English => stop.status.message.clone(),
        _ => language.cause(&stop.status.message),
    };
    let rows = [
        ("what followed", value("action").map(|action| language.say(action).to_owned())),
        ("measured", measured("value", unit)),
        ("limit", measured("limit", unit)),
        ("age", measured("age_ms", "ms")),
        ("speed", measured("speed_mps", "m/s")),
        ("place", Some(format!("{}; {}", metres(stop.pose.x_m), metres(stop.pose.y_m)))),
        // The message repeats the values; it stands for them where there are none.
        ("in full", value("value").is_none().then(whole)),
    ];
    for (name, text) in rows {
        if let Some(text) = text {
            let _ = write!(html, "<dt>{}<dd>{}", language.say(name), escaped(&text));
        }
    }
    html.push_str("</dl></div>");
    if let Some(moment) = &stop.moment {
        html.push_str(&sketch::moment(stop, moment, (footprint, language)));
    }
    html.push_str("</div>");
}

/// To the centimetre, and nothing is nothing: no −0.
fn plain(metres: f32) -> f32 {
    (metres * 100.0).round() / 100.0 + 0.0
}

/// Names of counters are those of the program, in English everywhere.
fn counters(html: &mut String, history: &History, language: Language) {
    if history.counters.is_empty() {
        return;
    }
    let name = language.say("Counters at the end");
    let _ = write!(
        html,
        "<h2>{name}</h2><div class=wide tabindex=0 role=region aria-label=\"{name}\"><table lang=en>"
    );
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
