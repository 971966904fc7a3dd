//! The report of a map: one page with the picture and the figures.

use floorguard_operator::report::style::{escaped, head, tiles};

use super::summary::MapSummary;

/// The page; it shows `picture.png` beside it.
pub fn document(summary: &MapSummary, files: &[String]) -> String {
    let mut html = head("Map");
    let verdict =
        (summary.verdict.to_owned(), "verdict", if summary.doubts.is_empty() { "good" } else { "bad" });
    let [width_m, height_m] = summary.size_m;
    let all = [
        verdict,
        (format!("{width_m:.1} × {height_m:.1} m"), "size", ""),
        (format!("{:.0} m²", summary.free_m2), "free floor", ""),
        (format!("{:.0} m", summary.path_m), "path", ""),
        (summary.loops.to_string(), "recognised places", ""),
    ];
    html += &tiles(all);
    html += &list("In doubt", &summary.doubts);
    html += &list("Notes", &summary.notes);
    html += "<figure><img src=\"picture.png\" alt=\"the map\" style=\"max-width:100%;image-rendering:pixelated\">\
             <figcaption>black: walls; white: free floor; grey: not seen; blue: the path from green to orange; red: places \
             that were recognised</figcaption></figure>";
    html += &figures(summary, files);
    html += "<h2>Files</h2><dl class=facts><dt>map.yaml, map.pgm</dt><dd>the map for ROS's map_server and nav2</dd>\
             <dt>trajectory.tum</dt><dd>the robot's poses: time x y z qx qy qz qw</dd>\
             <dt>graph.g2o</dt><dd>the pose graph of the scanner</dd>\
             <dt>submaps/</dt><dd>the map in pieces; index.txt says where each lies</dd>\
             <dt>summary.json</dt><dd>these figures for programs</dd></dl>";
    html + "</main></html>\n"
}

fn list(title: &str, lines: &[String]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let items: String = lines.iter().map(|line| format!("<li>{}</li>", escaped(line))).collect();
    format!("<h2>{title}</h2><ul>{items}</ul>")
}

fn stamps(summary: &MapSummary) -> String {
    match (summary.scans_younger_ms, summary.times_corrected) {
        (None, _) => {
            "not judged: the drive turns too little, or its odometry has no stamps of its own".to_owned()
        }
        (Some(_), true) => format!("scans are {}; corrected", summary.offset_in_words()),
        (Some(_), false) => format!("as they are; scans seem {}", summary.offset_in_words()),
    }
}

fn figures(summary: &MapSummary, files: &[String]) -> String {
    let input = &summary.input;
    let drift = summary.odometry_drift_m.map_or_else(|| "no odometry".to_owned(), |m| format!("{m:.2} m"));
    let rows = [
        ("from", files.join(", ")),
        ("duration", format!("{:.0} s", summary.duration_s)),
        ("scans used", input.scans.to_string()),
        ("scans kept in the graph", summary.kept_scans.to_string()),
        (
            "left out: not later, frozen, empty",
            format!("{}, {}, {}", input.not_later, input.frozen, input.empty),
        ),
        ("mean value of the matches", format!("{:.2}", summary.score_mean)),
        ("kept scans that hardly fit", summary.poor_scans.to_string()),
        ("recognised places rejected by the others", summary.loops_rejected.to_string()),
        ("largest distance of the odometry from the map", drift),
        ("stamps of the scans", stamps(summary)),
        ("cell", format!("{:.3} m", summary.cell_m)),
        ("time needed", format!("{:.1} s, {:.2} ms a scan", summary.took_s, summary.ms_per_scan)),
    ];
    let rows: String =
        rows.iter().map(|(name, value)| format!("<dt>{name}</dt><dd>{}</dd>", escaped(value))).collect();
    format!("<h2>Figures</h2><dl class=facts>{rows}</dl>")
}
