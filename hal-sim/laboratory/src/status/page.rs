//! The page.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde_json::json;

use super::account::{MissionStatus, ZoneStatus};
use super::base64::base64;
use super::raster::{LEGEND, Moment, png};
use floorguard_operator::report::{made_now, style};

/// What this page has beside the style of all reports.
const STYLE: &str = "*{box-sizing:border-box}\
.verdict{padding:.8rem 1rem;border-radius:.5rem;font-size:1.1rem}.good{background:var(--good)}.open{background:var(--cut)}\
.maps{display:grid;gap:1rem;grid-template-columns:repeat(auto-fit,minmax(20rem,1fr))}figure{margin:0}\
figcaption{font-weight:600}svg{width:100%;height:auto;border:1px solid #c3cad2;image-rendering:pixelated}\
.cards{display:grid;gap:.6rem;grid-template-columns:repeat(auto-fit,minmax(10rem,1fr));margin:1rem 0}\
.card{border:1px solid var(--line);border-radius:.5rem;padding:.5rem .8rem}.card b{display:block;font-size:1.4rem}\
.table{overflow-x:auto}table{border-collapse:collapse;width:100%}td,th{padding:.45rem .6rem;text-align:right;\
border-bottom:1px solid var(--line);font-variant-numeric:tabular-nums}td:first-child,th:first-child{text-align:left}\
.key{display:inline-block;margin:.2rem 1rem .2rem 0}.key i{display:inline-block;width:1.1em;height:1.1em;\
border:1px solid #8a94a0;vertical-align:-.15em;margin-right:.4em}details{margin-top:1rem}summary{padding:.4rem 0}\
text{font:600 var(--s) system-ui,sans-serif;fill:#10202e;stroke:#fff;stroke-width:var(--w);paint-order:stroke}";

/// Writes `index.html` and, for machines, `status.json` into a folder. Gives the path of the page.
///
/// # Errors
/// The folder cannot be made or written.
pub fn write_status(folder: &Path, status: &MissionStatus, strategy: &str) -> anyhow::Result<PathBuf> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{}: cannot make this folder; give another one", folder.display()))?;
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).with_context(|| format!("{}: cannot be written", path.display()))?;
        anyhow::Ok(path)
    };
    let machine = json!({
        "map": status.floor.name, "strategy": strategy, "tau": status.tolerated_units,
        "confidence": status.confidence, "sentence": status.sentence(), "total": status.total,
        "zones": status.zones, "spots": status.spots, "distance_m": status.result.distance_m,
        "time_s": status.result.time_s, "waited_for_people_s": status.result.waited_s,
    });
    write("status.json", &serde_json::to_string_pretty(&machine)?)?;
    write("index.html", &page(status, strategy)?)
}

fn page(status: &MissionStatus, strategy: &str) -> anyhow::Result<String> {
    let name = &status.floor.name;
    let total = &status.total;
    let is_open = total.dirty_after_m2 + total.uncertain_m2 + total.dirty_unreachable_m2 > 0.005;
    let mut html = style::head(&format!("Cleaning report: {name}"));
    let _ = write!(
        html,
        "<style>{STYLE}</style><p class=\"verdict {}\">{}</p><dl class=facts>",
        if is_open { "open" } else { "good" },
        escaped(&status.sentence())
    );
    let rows = made_now(None).into_iter().chain([("map", name.clone()), ("strategy", strategy.to_owned())]);
    for (what, value) in rows {
        let _ = write!(html, "<dt>{what}<dd>{}", escaped(&value));
    }
    html.push_str("</dl>");
    cards(&mut html, status);
    html.push_str("<div class=maps>");
    for (moment, caption) in
        [(Moment::Before, "Before: dirt that was expected"), (Moment::After, "After: what is promised")]
    {
        let _ = write!(html, "<figure><figcaption>{caption}</figcaption>{}</figure>", map(status, moment)?);
    }
    html.push_str("</div><p>");
    for (meaning, image::Rgb([r, g, b])) in LEGEND {
        let _ = write!(html, "<span class=key><i style=\"background:rgb({r},{g},{b})\"></i>{meaning}</span>");
    }
    html.push_str("</p>");
    zones(&mut html, status);
    spots(&mut html, status);
    fine_print(&mut html, status, strategy);
    html.push_str("</main></html>\n");
    Ok(html)
}

fn cards(html: &mut String, status: &MissionStatus) {
    let (total, result) = (&status.total, status.result);
    let minutes = |seconds: f32| format!("{:.0} min", (seconds / 60.0).ceil());
    let all = [
        ("dirty before", format!("{:.2} m²", total.dirty_before_m2)),
        ("of it clean now", format!("{:.2} m²", total.cleaned_m2)),
        ("still dirty", format!("{:.2} m²", total.dirty_after_m2)),
        ("uncertain", format!("{:.2} m²", total.uncertain_m2)),
        ("spots before / open", format!("{} / {}", total.spots_before, total.spots_after)),
        ("floor in reach", format!("{:.1} m²", total.answered_m2)),
        ("driven over", format!("{:.1} m²", total.swept_m2)),
        ("path", format!("{:.0} m", result.distance_m)),
        ("time", minutes(result.time_s)),
        ("of it waiting for people", minutes(result.waited_s)),
    ];
    html.push_str("<div class=cards>");
    for (name, value) in all {
        let _ = write!(html, "<div class=card><b>{value}</b>{name}</div>");
    }
    html.push_str("</div>");
}

/// A map with numbered spots above the picture.
fn map(status: &MissionStatus, moment: Moment) -> anyhow::Result<String> {
    let cells = &status.floor.cells;
    let (wide_m, high_m) =
        (f32::from(cells.width()) * cells.resolution_m(), f32::from(cells.height()) * cells.resolution_m());
    let origin = cells.origin_in_map();
    let letter_m = wide_m.max(high_m) / 45.0;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {wide_m} {high_m}\" style=\"--s:{letter_m}px;--w:{}px\"><image width=\"{wide_m}\" \
         height=\"{high_m}\" preserveAspectRatio=\"none\" href=\"data:image/png;base64,{}\"/>",
        letter_m * 0.2,
        base64(&png(status, moment)?)
    );
    let at = |x_m: f32, y_m: f32| (x_m - origin.x_m, high_m - (y_m - origin.y_m));
    if moment == Moment::After && status.result.path.len() > 1 {
        svg.push_str("<polyline fill=\"none\" stroke=\"#2b5fa8\" stroke-opacity=\".6\" points=\"");
        for point in &status.result.path {
            let (x, y) = at(point.x_m, point.y_m);
            let _ = write!(svg, "{x:.2},{y:.2} ");
        }
        let _ = write!(svg, "\" stroke-width=\"{:.3}\"/>", letter_m * 0.12);
    }
    let open = status.spots.iter().filter(|spot| moment == Moment::Before || spot.clean_share < 1.0);
    for spot in open.take(40) {
        let (x, y) = at(spot.x_m, spot.y_m);
        let _ = write!(svg, "<text x=\"{x:.2}\" y=\"{y:.2}\">{}</text>", spot.number);
    }
    svg.push_str("</svg>");
    Ok(svg)
}

fn zones(html: &mut String, status: &MissionStatus) {
    html.push_str(
        "<h2>Zones</h2><div class=table tabindex=0 role=region aria-label=\"Zones\"><table><tr><th>zone<th>floor, m²<th>in reach<th>driven over<th>dirty before\
         <th>clean now<th>still dirty<th>uncertain<th>out of reach<th>spots before<th>open</tr>",
    );
    for zone in status.zones.iter().chain(std::iter::once(&status.total)) {
        let ZoneStatus { zone: name, .. } = zone;
        let _ = write!(html, "<tr><td>{}", escaped(name));
        let areas = [
            zone.floor_m2,
            zone.answered_m2,
            zone.swept_m2,
            zone.dirty_before_m2,
            zone.cleaned_m2,
            zone.dirty_after_m2,
            zone.uncertain_m2,
            zone.dirty_unreachable_m2,
        ];
        areas.iter().for_each(|area| {
            let _ = write!(html, "<td>{area:.2}");
        });
        let _ = write!(html, "<td>{}<td>{}</tr>", zone.spots_before, zone.spots_after);
    }
    html.push_str("</table></div>");
}

fn spots(html: &mut String, status: &MissionStatus) {
    if status.spots.is_empty() {
        return;
    }
    html.push_str(
        "<h2>Spots before cleaning</h2><div class=table tabindex=0 role=region aria-label=\"Spots before cleaning\"><table><tr><th>no.<th>x, m<th>y, m<th>area, m²\
         <th>units a cell<th>clean now</tr>",
    );
    for spot in &status.spots {
        let _ = write!(
            html,
            "<tr><td>{}<td>{:.1}<td>{:.1}<td>{:.2}<td>{:.1}<td>{:.0} %</tr>",
            spot.number,
            spot.x_m,
            spot.y_m,
            spot.area_m2,
            spot.units,
            100.0 * spot.clean_share
        );
    }
    html.push_str("</table></div>");
}

/// What is promised and what not; in simulation also the truth.
fn fine_print(html: &mut String, status: &MissionStatus, strategy: &str) {
    let result = status.result;
    let _ = write!(
        html,
        "<details><summary>What this promises, and what not</summary><p>A cell of {:.1} m is called clean if at most {} \
         units of dirt lie in it with {:.1} % confidence, errors of the robot's position included. Nothing is promised for \
         floor out of reach or uncertain. Strategy: {strategy}.</p></details>",
        status.floor.cells.resolution_m(),
        status.tolerated_units,
        100.0 * status.confidence
    );
    let _ = write!(
        html,
        "<details><summary>What the simulation knows</summary><p>Of {} cells that were dirty and are called clean, {} are \
         not. The robot was off by {:.0} mm on average.</p></details>",
        result.claimed_cells,
        result.falsely_claimed_cells,
        1_000.0 * result.mean_error_m
    );
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
