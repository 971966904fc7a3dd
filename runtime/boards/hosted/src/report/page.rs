//! The folder: one self-contained page, the picture alone, and the verdict for machines.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::summary::summary;
use super::view::top_view;
use crate::world::{Observation, Plan};

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:64rem;padding:0 1rem;\
color:#1c2733}h1{font-size:1.4rem}table{border-collapse:collapse;width:100%}td,th{padding:.3rem .6rem;text-align:left;\
border-bottom:1px solid #d8dee5}svg{max-width:100%;height:auto}pre{background:#f4f6f8;padding:1rem;overflow:auto}\
.num{text-align:right;font-variant-numeric:tabular-nums}";

/// Writes `index.html`, `top-view.svg`, `speed.svg` and `verdict.json`. Gives the path of the page.
///
/// # Errors
/// The folder cannot be made or written.
pub fn write_report(folder: &Path, plan: &Plan, observation: &Observation) -> anyhow::Result<PathBuf> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{}: cannot make this folder; give another one", folder.display()))?;
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).with_context(|| format!("{}: cannot be written", path.display()))?;
        anyhow::Ok(path)
    };
    let picture = top_view(plan, observation).to_svg();
    let speed = speed_plot(observation);
    write("top-view.svg", &picture)?;
    write("speed.svg", &speed)?;
    write("verdict.json", &serde_json::to_string_pretty(&observation.verdict)?)?;
    write("index.html", &page(plan, observation, (&picture, &speed)))
}

fn page(plan: &Plan, observation: &Observation, (picture, speed): (&str, &str)) -> String {
    let mut html = String::new();
    let title = escaped(&plan.scenario.title);
    let cleaning = observation.mission.as_ref().map(super::cleaning::section).unwrap_or_default();
    let _ = write!(
        html,
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width\"><title>floorguard: {title}</title><style>{STYLE}</style>\
         <h1>{title}</h1><pre>{}</pre>{picture}{cleaning}<h2>Speed and limit</h2>{speed}<h2>Stops</h2>",
        escaped(&summary(plan, observation)),
    );
    html.push_str("<table><tr><th class=num>time, s<th class=num>speed, m/s<th>why</tr>");
    for stop in &observation.stops {
        let _ = write!(
            html,
            "<tr><td class=num>{:.1}<td class=num>{:.2}<td>{}</tr>",
            stop.at_s,
            stop.speed_mps,
            escaped(&stop.cause)
        );
    }
    html.push_str("</table></html>\n");
    html
}

/// Speed as a line above the limit as an area, one value per second.
fn speed_plot(observation: &Observation) -> String {
    const WIDTH: f64 = 960.0;
    const HEIGHT: f64 = 180.0;
    const TOP_MPS: f64 = 1.2;
    let last_s = observation.speeds.last().map_or(1.0, |(seconds, ..)| seconds.max(1.0));
    let x = |seconds: f64| 40.0 + seconds / last_s * (WIDTH - 50.0);
    let y = |mps: f32| HEIGHT - 20.0 - f64::from(mps.clamp(0.0, TOP_MPS as f32)) / TOP_MPS * (HEIGHT - 30.0);
    let mut limit = format!("M{:.1} {:.1}", x(0.0), y(0.0));
    let mut speed = String::new();
    for (index, (seconds, speed_mps, limit_mps)) in observation.speeds.iter().enumerate() {
        let _ = write!(limit, " L{:.1} {:.1}", x(*seconds), y(*limit_mps));
        let word = if index == 0 { 'M' } else { 'L' };
        let _ = write!(speed, "{word}{:.1} {:.1} ", x(*seconds), y(speed_mps.abs()));
    }
    let _ = write!(limit, " L{:.1} {:.1} Z", x(last_s), y(0.0));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"system-ui,sans-serif\" \
         font-size=\"12\"><path d=\"{limit}\" fill=\"#cfe3f5\"/><path d=\"{speed}\" fill=\"none\" stroke=\"#0b5394\" \
         stroke-width=\"2\"/>"
    );
    for mps in [0.0_f32, 0.3, 0.6, 0.9] {
        let _ = write!(
            svg,
            "<text x=\"4\" y=\"{:.1}\">{mps:.1}</text><path d=\"M36 {at:.1}H{WIDTH}\" stroke=\"#d8dee5\"/>",
            y(mps) + 4.0,
            at = y(mps)
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"40\" y=\"{HEIGHT}\">0 s</text><text x=\"{:.0}\" y=\"{HEIGHT}\" text-anchor=\"end\">{last_s:.0} s</text>\
         <text x=\"48\" y=\"14\">m/s: line = speed, area = limit</text></svg>",
        WIDTH - 10.0
    );
    svg
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
