//! Draws a run as an SVG document: the map at the left, legend and list of stops at the right.

use floorguard_types::geometry::{Point2, Pose2};

use super::canvas::{Canvas, Ink, Lettering, Mapping};
use super::content::TopView;
use super::palette;
use super::panel;
use super::spread::spread;

/// Space around everything, pixels.
pub(super) const BORDER_PX: f32 = 24.0;
/// Title and subtitle.
const HEADER_PX: f32 = 62.0;
const FOOTER_PX: f32 = 40.0;
const MAP_AREA_PX: (f32, f32) = (1_060.0, 860.0);
/// The legend needs this height even beside a flat map.
const HEIGHT_MIN_PX: f32 = 420.0;
/// Marks of stops are this far from each other, pixels.
const STOP_APART_PX: f32 = 24.0;
/// From arrow to arrow along the robot's path, pixels.
const ARROW_SPACING_PX: f32 = 90.0;

impl TopView {
    /// The picture as an SVG document; the same content gives the same bytes.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let origin_px = (BORDER_PX, BORDER_PX + HEADER_PX);
        let mapping = self.mapping(origin_px);
        let (width_px, height_px) = mapping.size_px();
        let panel_x = origin_px.0 + width_px + BORDER_PX;
        let body_px = height_px.max(HEIGHT_MIN_PX);
        let total = (panel_x + panel::WIDTH_PX + BORDER_PX, origin_px.1 + body_px + FOOTER_PX + BORDER_PX);
        let mut canvas = Canvas::new(total.0, total.1, &self.title);
        canvas.rectangle((0.0, 0.0), total, area(palette::PAPER));
        self.draw_header(&mut canvas);
        self.draw_map(&mut canvas, &mapping);
        panel::draw(self, &mut canvas, (panel_x, origin_px.1), body_px);
        canvas.finish()
    }

    /// The map alone, for a page that says in words what the lines mean.
    #[must_use]
    pub fn map_svg(&self) -> String {
        let mapping = self.mapping((0.0, 0.0));
        let (width_px, height_px) = mapping.size_px();
        let mut canvas = Canvas::new(width_px, height_px + FOOTER_PX, &self.title);
        self.draw_map(&mut canvas, &mapping);
        canvas.finish()
    }

    fn mapping(&self, origin_px: (f32, f32)) -> Mapping {
        let robot: Vec<Point2> = self.robot_path.iter().map(|pose| Point2::new(pose.x_m, pose.y_m)).collect();
        let shown = (self.walls.iter().chain(&self.obstacles).flatten())
            .chain(self.people.iter().flat_map(|person| &person.points))
            .chain(&robot);
        Mapping::fit(shown, origin_px, MAP_AREA_PX)
    }

    fn draw_map(&self, canvas: &mut Canvas, mapping: &Mapping) {
        canvas.rectangle(mapping.origin_px, mapping.size_px(), area(palette::FLOOR));
        draw_grid(canvas, mapping);
        self.draw_building(canvas, mapping);
        self.draw_people(canvas, mapping);
        self.draw_robot(canvas, mapping);
        self.draw_stops(canvas, mapping);
        draw_scale(canvas, mapping);
    }

    fn draw_header(&self, canvas: &mut Canvas) {
        let title = Lettering {
            at_px: (BORDER_PX, BORDER_PX + 20.0),
            size_px: 22.0,
            colour: palette::INK,
            anchor: "start",
            is_bold: true,
        };
        canvas.text(&self.title, title);
        let at_px = (BORDER_PX, BORDER_PX + 43.0);
        canvas.text(
            &self.subtitle,
            Lettering { at_px, size_px: 14.0, colour: palette::FAINT, is_bold: false, ..title },
        );
    }

    fn draw_building(&self, canvas: &mut Canvas, mapping: &Mapping) {
        let furniture =
            Ink { fill: palette::OBSTACLE, stroke: palette::OBSTACLE_EDGE, width_px: 1.0, opacity: 1.0 };
        let wall = Ink { fill: palette::WALL, stroke: palette::WALL, width_px: 1.0, opacity: 1.0 };
        for (outlines, ink) in [(&self.obstacles, furniture), (&self.walls, wall)] {
            for outline in outlines {
                let corners: Vec<_> = outline.iter().map(|corner| mapping.px(*corner)).collect();
                canvas.path(&corners, true, ink);
            }
        }
    }

    fn draw_people(&self, canvas: &mut Canvas, mapping: &Mapping) {
        for (index, person) in self.people.iter().enumerate() {
            let colour = palette::person(index);
            let path = mapping.path_px(person.points.iter().copied());
            canvas.path(&path, false, Ink { opacity: 0.75, ..line(colour, 1.8) });
            let Some(end) = path.last() else { continue };
            canvas.circle(*end, 4.5, Ink { stroke: palette::PAPER, width_px: 1.0, ..area(colour) });
            let lettering = Lettering {
                at_px: (end.0 + 7.0, end.1 + 4.0),
                size_px: 11.0,
                colour,
                anchor: "start",
                is_bold: true,
            };
            canvas.text(&person.id.to_string(), lettering);
        }
    }

    fn draw_robot(&self, canvas: &mut Canvas, mapping: &Mapping) {
        let places = self.robot_path.iter().map(|pose| Point2::new(pose.x_m, pose.y_m));
        let path = mapping.path_px(places);
        if self.swath_width_m > 0.0 {
            let width_px = self.swath_width_m * mapping.px_per_m;
            canvas.path(&path, false, Ink { opacity: 0.16, ..line(palette::ROBOT, width_px) });
        }
        canvas.path(&path, false, Ink { opacity: 0.85, ..line(palette::PAPER, 5.0) });
        canvas.path(&path, false, line(palette::ROBOT, 2.6));
        for arrow in arrows(&path) {
            canvas.path(&arrow, true, area(palette::ROBOT));
        }
        if let Some(start) = self.robot_path.first() {
            let ink = Ink { fill: palette::PAPER, ..line(palette::ROBOT, 2.0) };
            canvas.path(&self.outline_px(*start, mapping), true, Ink { opacity: 0.9, ..ink });
        }
        if let Some(end) = self.robot_path.last() {
            let ink = Ink { fill: palette::ROBOT, ..line(palette::PAPER, 1.5) };
            canvas.path(&self.outline_px(*end, mapping), true, ink);
            // A nose marks its heading.
            let nose = [(0.05, 0.15), (0.25, 0.0), (0.05, -0.15)];
            let nose: Vec<_> = nose
                .into_iter()
                .map(|(x_m, y_m)| end.transform(Point2::new(x_m, y_m)))
                .filter(|corner| is_finite(*corner))
                .map(|corner| mapping.px(corner))
                .collect();
            canvas.path(&nose, false, line(palette::PAPER, 2.0));
        }
    }

    fn outline_px(&self, pose: Pose2, mapping: &Mapping) -> Vec<(f32, f32)> {
        let corners = self.robot_outline.iter().map(|corner| pose.transform(*corner));
        corners.filter(|corner| is_finite(*corner)).map(|corner| mapping.px(corner)).collect()
    }

    fn draw_stops(&self, canvas: &mut Canvas, mapping: &Mapping) {
        let causes = panel::causes(self);
        let shown: Vec<_> =
            self.stops.iter().enumerate().filter(|(_, stop)| is_finite(stop.position)).collect();
        let places: Vec<_> = shown.iter().map(|(_, stop)| mapping.px(stop.position)).collect();
        let drawn = spread(&places, STOP_APART_PX);
        canvas.open_group("mark");
        // The first ones are painted last, on top: their numbers stand in the list.
        for (((index, stop), place), at) in shown.iter().zip(&places).zip(&drawn).rev() {
            let cause = causes.iter().position(|(cause, _)| *cause == stop.cause).unwrap_or(0);
            if place != at {
                canvas.path(&[*place, *at], false, line(palette::cause(cause), 1.5));
            }
            panel::draw_stop(canvas, *at, palette::cause(cause), index + 1);
        }
        canvas.close_group();
    }
}

fn is_finite(point: Point2) -> bool {
    point.x_m.is_finite() && point.y_m.is_finite()
}

/// Filled, without an edge.
pub(super) fn area(fill: &'static str) -> Ink {
    Ink { fill, stroke: "none", width_px: 0.0, opacity: 1.0 }
}

/// A line of one colour.
pub(super) fn line(stroke: &'static str, width_px: f32) -> Ink {
    Ink { fill: "none", stroke, width_px, opacity: 1.0 }
}

/// Small triangles along a path that show its direction.
fn arrows(path: &[(f32, f32)]) -> Vec<Vec<(f32, f32)>> {
    let mut arrows = Vec::new();
    let mut since_px = ARROW_SPACING_PX / 2.0;
    for pair in path.windows(2) {
        let [(x0, y0), (x1, y1)] = *pair else { continue };
        let (dx, dy) = (x1 - x0, y1 - y0);
        let length = dx.hypot(dy);
        since_px += length;
        if length > 0.0 && since_px >= ARROW_SPACING_PX {
            since_px = 0.0;
            let (ux, uy) = (dx / length, dy / length);
            let corner =
                |along: f32, aside: f32| (x1 + ux * along - uy * aside, y1 + uy * along + ux * aside);
            arrows.push(vec![corner(7.0, 0.0), corner(-4.0, 5.0), corner(-4.0, -5.0)]);
        }
    }
    arrows
}

/// A length of 1, 2 or 5 times a power of ten, metres, nearest below `length_m` (> 0).
fn round_length_m(length_m: f32) -> f32 {
    let decade = 10.0_f32.powf(length_m.max(1.0e-3).log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|step| step * decade).find(|step| *step <= length_m).unwrap_or(decade)
}

/// From line to line of the grid, metres.
fn grid_m(mapping: &Mapping) -> f32 {
    round_length_m(110.0 / mapping.px_per_m)
}

fn draw_grid(canvas: &mut Canvas, mapping: &Mapping) {
    /// More lines than this help nobody; the step below keeps far under it.
    const LINES_MAX: u32 = 200;
    let step_m = grid_m(mapping);
    let (low, high) = (mapping.lowest, mapping.highest);
    let lines = |from_m: f32, to_m: f32| {
        let first = (from_m / step_m).ceil();
        let place = move |index: u32| (first + index as f32) * step_m;
        (0..LINES_MAX).map(place).take_while(move |at_m| *at_m <= to_m)
    };
    for x_m in lines(low.x_m, high.x_m) {
        let ends = [Point2::new(x_m, low.y_m), Point2::new(x_m, high.y_m)].map(|end| mapping.px(end));
        canvas.path(&ends, false, line(palette::GRID, 1.0));
    }
    for y_m in lines(low.y_m, high.y_m) {
        let ends = [Point2::new(low.x_m, y_m), Point2::new(high.x_m, y_m)].map(|end| mapping.px(end));
        canvas.path(&ends, false, line(palette::GRID, 1.0));
    }
}

fn draw_scale(canvas: &mut Canvas, mapping: &Mapping) {
    let length_m = round_length_m(160.0 / mapping.px_per_m);
    let length_px = length_m * mapping.px_per_m;
    let (x, y) = (mapping.origin_px.0, mapping.origin_px.1 + mapping.size_px().1 + 18.0);
    canvas.rectangle((x, y), (length_px / 2.0, 5.0), area(palette::INK));
    let edge = Ink { fill: palette::PAPER, ..line(palette::INK, 1.0) };
    canvas.rectangle((x + length_px / 2.0, y + 0.5), (length_px / 2.0, 4.0), edge);
    let lettering = Lettering {
        at_px: (x + length_px + 10.0, y + 7.0),
        size_px: 13.0,
        colour: palette::INK,
        anchor: "start",
        is_bold: false,
    };
    canvas.text(&format!("{length_m} m, grid {} m", grid_m(mapping)), lettering);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{PersonPath, StopMark};

    #[test]
    fn scale_bars_have_round_lengths() {
        for (length_m, round_m) in [(0.7, 0.5), (1.0, 1.0), (4.9, 2.0), (12.0, 10.0), (99.0, 50.0)] {
            assert!((round_length_m(length_m) - round_m).abs() < 1e-4, "{length_m}");
        }
    }

    #[test]
    fn empty_and_non_finite_runs_give_pictures() {
        let nan = Point2::new(f32::NAN, f32::INFINITY);
        let people = vec![PersonPath { id: 1, points: vec![nan, nan] }, PersonPath::default()];
        let robot_path = vec![Pose2 { x_m: f32::NAN, y_m: 0.0, heading_rad: f32::NAN }];
        let stops = vec![StopMark { position: nan, at_s: 0.0, cause: String::new() }];
        let robot_outline = vec![Point2::new(1.0, 0.0)];
        let broken = TopView { people, robot_path, robot_outline, stops, ..TopView::default() };
        for view in [TopView::default(), broken] {
            let svg = view.to_svg();
            assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }

    #[test]
    fn positions_are_right_and_text_is_escaped() {
        let square = |low: f32, high: f32| {
            [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| Point2::new(x, y)).to_vec()
        };
        let view = TopView {
            title: "<a> & \"b\"".into(),
            walls: vec![square(0.0, 9.0)],
            robot_path: vec![Pose2::new(0.0, 0.0, 0.0), Pose2::new(9.0, 9.0, 0.0)],
            stops: vec![StopMark { position: Point2::new(9.0, 9.0), at_s: 1.0, cause: "x<y".into() }],
            ..TopView::default()
        };
        let svg = view.to_svg();
        assert!(svg.contains("&lt;a&gt; &amp; &quot;b&quot;") && !svg.contains("x<y"));
        // 10 m with margins into 860 px: the upper right corner is 9.5 m right of the left edge and 0.5 m from the top.
        let (x, y) = (BORDER_PX + 9.5 * 86.0, BORDER_PX + HEADER_PX + 0.5 * 86.0);
        assert!(svg.contains(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\"")), "{svg}");
        assert_eq!(svg, view.to_svg());
    }
}
