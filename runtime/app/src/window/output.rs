//! The files of the map, and the page that shows them.

use std::fmt::Write as _;

use floorguard_mapping::sliding_window::MovementArrow;
use floorguard_mapping_host::output::{
    ColourOf, OutputFile, PlanLayer, cloud_ply, draw_faces, draw_plan, pgm, plan_map, yaml,
};
use floorguard_types::geometry::Point3;

use floorguard_robot::actuated::WindowMap;

/// Pictures of the page with what they show.
const PICTURES: [(&str, &str); 4] = [
    ("window.png", "The window: left, front and right grid as the robot sees them; places of people red"),
    (
        "floor.png",
        "What stands on the floor, from above, x to the right; arrows show where people walk in a second",
    ),
    ("ceiling.png", "What hangs above the robot, the lowest of it"),
    ("panorama.png", "The panoramic picture, dewarped: behind, left, ahead, right, behind"),
];

/// All files but the panorama; `summary` is the JSON object of the run.
pub fn files(map: &WindowMap, colour: Option<ColourOf<'_>>, summary: &str) -> Vec<OutputFile> {
    let points: Vec<_> = map.window.points().collect();
    let cloud: Vec<Point3> = points.iter().map(|one| one.point).collect();
    let floor = plan_map(&map.plan, map.now);
    let arrows = (map.arrows(), map.now);
    vec![
        OutputFile::new("map.pgm", pgm(&floor)),
        OutputFile::new("map.yaml", yaml(&floor, "map.pgm")),
        OutputFile::new("window.png", draw_faces(&points, map.window.geometry(), colour)),
        OutputFile::new("floor.png", draw_plan(&map.plan, PlanLayer::Floor, arrows)),
        OutputFile::new("ceiling.png", draw_plan(&map.plan, PlanLayer::Ceiling, (&[], map.now))),
        OutputFile::new("surfaces.ply", cloud_ply(&cloud)),
        OutputFile::new("arrows.csv", arrow_table(map.arrows())),
        OutputFile::new("summary.json", format!("{summary}\n")),
    ]
}

fn arrow_table(arrows: &[MovementArrow]) -> String {
    let mut text = "time_s,x_m,y_m,velocity_x_mps,velocity_y_mps\n".to_owned();
    for arrow in arrows {
        let (at, time_s) = (arrow.position_in_odometry, arrow.stamp.as_micros() as f64 * 1.0e-6);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{time_s:.3},{:.3},{:.3},{:.3},{:.3}",
            at.x_m, at.y_m, arrow.velocity_x_mps, arrow.velocity_y_mps
        );
    }
    text
}

/// The page; `present` are the files that there are.
pub fn page(present: &[OutputFile], lines: &[String]) -> String {
    let mut text = "<!doctype html><meta charset=\"utf-8\"><title>Sliding window</title>\
                    <style>body{font:16px sans-serif;margin:2em;max-width:1500px}img{max-width:100%;\
                    image-rendering:pixelated;border:1px solid #ccc}</style>\n<h1>Sliding window</h1>\n<ul>\n"
        .to_owned();
    let escaped = |line: &String| line.replace('&', "&amp;").replace('<', "&lt;");
    for line in lines.iter().map(escaped) {
        let _ = writeln!(text, "<li>{line}</li>");
    }
    text.push_str("</ul>\n");
    for (name, what) in PICTURES {
        if present.iter().any(|file| file.name == name) {
            let _ = writeln!(text, "<h2>{what}</h2>\n<img src=\"{name}\" alt=\"{what}\">");
        }
    }
    text.push_str(
        "<p>For other programs: <a href=\"map.yaml\">map.yaml</a> and map.pgm (map_server), \
                   <a href=\"surfaces.ply\">surfaces.ply</a>, <a href=\"arrows.csv\">arrows.csv</a>, \
                   <a href=\"summary.json\">summary.json</a>.</p>\n",
    );
    text
}
