//! The report of a recording: one HTML file that needs nothing else, for a phone, a screen and a printer.

use std::collections::BTreeMap;
use std::fmt::Write;

use floorguard_core::geometry::Point2;

use super::charts;
use super::grids::{self, Scale};
use super::history::{History, Stop};
use super::mission;
use super::sketch;
use crate::recording::topics;

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;margin:1rem auto;max-width:64rem;padding:0 1rem;\
color:#1c2733;background:#fff}h1{font-size:1.5rem;margin-bottom:0}h2{font-size:1.15rem;margin-top:2rem}\
svg{width:100%;height:auto;max-height:90vh}.sum{display:flex;flex-wrap:wrap;gap:.6rem;padding:0;list-style:none}\
.sum li{background:#f4f6f8;border-radius:.5rem;padding:.4rem .8rem;flex:1 1 8rem}.sum b{display:block;font-size:1.25rem}\
table{border-collapse:collapse;width:100%;font-size:.92rem}td,th{padding:.25rem .5rem;text-align:left;\
border-bottom:1px solid #d8dee5}.num{text-align:right;font-variant-numeric:tabular-nums}.wide{overflow-x:auto}\
.stop{display:flex;flex-wrap:wrap;gap:1rem;border-top:1px solid #d8dee5;padding:1rem 0;break-inside:avoid}\
.stop>div{flex:1 1 16rem}.stop svg{flex:0 1 300px;max-width:300px}dl{display:grid;grid-template-columns:max-content 1fr;\
gap:.1rem .8rem;margin:0}dt{color:#5b6770}dd{margin:0}.cut{background:#fdf2d0;padding:.5rem 1rem;border-radius:.5rem}\
.chart{overflow-x:auto}\
@media screen and (max-width:40rem){.chart svg{min-width:44rem}.stop svg{flex-basis:100%;max-width:22rem}}\
.pair{display:flex;flex-wrap:wrap;gap:1rem}figure{flex:1 1 18rem;margin:0;break-inside:avoid}\
figcaption{text-align:center}h3{font-size:1rem;margin:1rem 0 .3rem}.legend{color:#5b6770;font-size:.88rem}@media print{body{max-width:none;font-size:11px}h2{break-after:avoid}a{color:inherit}}";

/// Text that means nothing to HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The page.
#[must_use]
pub fn document(history: &History, name: &str) -> String {
    let title = history.texts.get("title").cloned().unwrap_or_else(|| name.to_owned());
    let mut html = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width,initial-scale=1\"><title>floorguard: {t}</title><style>{STYLE}</style>\
         <h1>{t}</h1>",
        t = escaped(&title)
    );
    head(&mut html, history, name);
    section(&mut html, "Map, way and stops", &sketch::overview(history), OVERVIEW_LEGEND);
    mission::section(&mut html, history);
    section(&mut html, "Speed and limit", &chart(&charts::speeds(history)), SPEED_LEGEND);
    stops(&mut html, history);
    if !history.heat.is_empty() {
        let legend = "Darker: people were there longer, each step four times as long.";
        section(&mut html, "Where people were", &sketch::heat(history), legend);
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
        section(&mut html, &format!("Map {}", escaped(topic)), &both, GRID_LEGEND);
    }
    if !history.sources.is_empty() {
        let legend = "Green: healthy. Yellow: limits the robot. Red: stops it. Grey: says nothing.";
        section(&mut html, "Health of the sources", &chart(&charts::sources(history)), legend);
    }
    counters(&mut html, history);
    html + "</html>\n"
}

const OVERVIEW_LEGEND: &str = "White: seen free. Dark: something stands there. Blue: the robot's way. Thin coloured \
lines: tracked people. Red: stops, numbered as below. In the odometry frame, without correction.";
const SPEED_LEGEND: &str = "Line: measured speed in m/s. Area: what the guard permits. Red ticks: stops.";
const GRID_LEGEND: &str = "White: 0. Dark: 100. Blue-grey: unknown.";

/// On a phone a chart is wider than the page, so that its words can be read.
pub(super) fn chart(svg: &str) -> String {
    format!("<div class=chart>{svg}</div>")
}

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
    let moving_s = history.speeds.windows(2).filter(|pair| pair[0].speed_mps.abs() > 0.02);
    // The sum of nothing is −0.
    let moving_s = moving_s.map(|pair| pair[1].at_s - pair[0].at_s).sum::<f64>() + 0.0;
    let people = history.people.values().filter(|way| way.len() > 5).count();
    let tiles = [
        (format!("{:.0} s", history.duration_s), "recorded"),
        (format!("{:.1} m", history.driven_m), "driven"),
        (format!("{moving_s:.0} s"), "moving"),
        (history.stops.len().to_string(), "stops"),
        (people.to_string(), "people followed"),
        (history.messages.to_string(), "messages"),
    ];
    html.push_str("<ul class=sum>");
    for (value, what) in tiles {
        let _ = write!(html, "<li><b>{value}</b>{what}</li>");
    }
    html.push_str("</ul>");
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
    let robot = toml.and_then(|text| crate::configuration::parse("robot.toml", text).ok());
    let footprint: Vec<Point2> =
        robot.map(|parsed| parsed.robot.geometry.footprint.iter().copied().collect()).unwrap_or_default();
    for (index, stop) in history.stops.iter().enumerate() {
        one_stop(html, (index + 1, stop), &footprint);
    }
    html.push_str(
        "<p class=legend>Pictures: the robot in blue, its front up; the fields that were watched in yellow and red; \
         dots: what the safety scanner saw last; orange: tracked people.</p>",
    );
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
        ("in full", Some(stop.status.message.clone())),
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
    html.push_str("<h2>Counters at the end</h2><div class=wide><table>");
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
