//! What no sensor sees, from above: a square for each place that the body goes to, the darker the higher an object may be that is not
//! seen there in time.

use std::fmt::Write as _;

use floorguard_configuration::{Coverage, HEIGHTS_M, HostedConfiguration};
use floorguard_types::geometry::Point2;

/// Pixels of a metre, and of the margins.
const SCALE: f32 = 160.0;
const MARGIN_PX: f32 = 20.0;
/// The legend stands beside the picture, pixels.
const LEGEND_PX: f32 = 330.0;
/// Half the side of a place, metres.
const HALF_M: f32 = 0.025;
/// From seen from the floor on to not seen at all.
const COLOURS: [&str; 5] = ["#cfe8cf", "#ffe08a", "#f6a04d", "#d9482b", "#7a0f1e"];

/// Ahead is up, left is left.
struct View {
    least: Point2,
    greatest: Point2,
}

impl View {
    fn around(points: impl Iterator<Item = Point2>) -> Self {
        let (least, greatest) = (Point2::new(f32::MAX, f32::MAX), Point2::new(f32::MIN, f32::MIN));
        points.fold(Self { least, greatest }, |view, point| Self {
            least: Point2::new(view.least.x_m.min(point.x_m), view.least.y_m.min(point.y_m)),
            greatest: Point2::new(view.greatest.x_m.max(point.x_m), view.greatest.y_m.max(point.y_m)),
        })
    }

    fn px(&self, at: Point2) -> [f32; 2] {
        [MARGIN_PX + (self.greatest.y_m - at.y_m) * SCALE, MARGIN_PX + (self.greatest.x_m - at.x_m) * SCALE]
    }

    fn size_px(&self) -> [f32; 2] {
        let [x, y] = self.px(self.least);
        [x + MARGIN_PX + LEGEND_PX, (y + MARGIN_PX).max(420.0)]
    }
}

/// Which colour stands for so many unseen heights.
fn shade(unseen: usize) -> usize {
    match unseen {
        0 => 0,
        1..=3 => 1,
        4..=6 => 2,
        7..=8 => 3,
        _ => 4,
    }
}

/// An SVG document.
pub(super) fn draw(configuration: &HostedConfiguration, coverage: &Coverage) -> String {
    let robot = &configuration.robot;
    let footprint = &robot.geometry.footprint;
    let view = View::around(coverage.places.iter().map(|(at, _)| *at).chain(footprint.iter().copied()));
    let [width, height] = view.size_px();
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\" font-size=\"12\">\
         <title>What no sensor sees where the body goes</title><rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for (at, unseen) in &coverage.places {
        let [x, y] = view.px(Point2::new(at.x_m + HALF_M, at.y_m + HALF_M));
        let (side, colour) = (2.0 * HALF_M * SCALE, COLOURS[shade(*unseen)]);
        let _ = writeln!(
            svg,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{side}\" height=\"{side}\" fill=\"{colour}\"/>"
        );
    }
    let corners = footprint.iter().map(|corner| view.px(*corner)).map(|[x, y]| format!("{x:.1},{y:.1}"));
    let _ = writeln!(
        svg,
        "<polygon points=\"{}\" fill=\"#dfe5ee\" stroke=\"#222\" stroke-width=\"1.5\"/>",
        corners.collect::<Vec<_>>().join(" ")
    );
    let camera = configuration.carriers.camera.as_ref().map(|camera| ("camera", camera.mounting));
    let sensors = [("lidar", robot.lidar.mounting), ("scanner", robot.scanner.mounting)];
    for (name, mounting) in sensors.into_iter().chain(camera) {
        let [x, y] = view.px(Point2::new(mounting.position.x_m, mounting.position.y_m));
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/><text x=\"{:.1}\" y=\"{:.1}\">{name}</text>",
            x + 7.0,
            y + 4.0
        );
    }
    legend(&mut svg, coverage, width - LEGEND_PX);
    svg.push_str("</svg>\n");
    svg
}

/// What the colours stand for, and the gaps by name.
fn legend(svg: &mut String, coverage: &Coverage, x: f32) {
    let mut y = MARGIN_PX;
    let mut line = |colour: Option<&str>, text: &str| {
        if let Some(colour) = colour {
            let _ = writeln!(
                svg,
                "<rect x=\"{x}\" y=\"{y}\" width=\"14\" height=\"14\" fill=\"{colour}\" stroke=\"#999\"/>"
            );
        }
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{}\">{text}</text>", x + 20.0, y + 11.0);
        y += 18.0;
    };
    line(None, "Forward is up. Objects are seen in time");
    for (index, colour) in COLOURS.iter().enumerate() {
        let of_colour = (0..=HEIGHTS_M.len()).filter(|unseen| shade(*unseen) == index);
        let words = match of_colour.max().and_then(|unseen| HEIGHTS_M.get(unseen)) {
            Some(height_m) if index > 0 => format!("from {height_m:.2} m of height at the latest"),
            Some(height_m) => format!("from {height_m:.2} m of height on"),
            None => "from 1.00 m on, or never".to_owned(),
        };
        line(Some(colour), &words);
    }
    for gap in &coverage.gaps {
        line(None, &format!("{}, up to {:.2} m/s", gap.gap, gap.reached_mps()));
    }
}
