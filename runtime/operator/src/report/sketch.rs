//! Pictures of a recording as SVG: the map with paths and stops, where people were, and the moment of a stop.

use std::collections::BTreeMap;
use std::fmt::Write;

use floorguard_types::geometry::{Point2, Pose2};

use super::history::{HEAT_M, History, MapScan, Moment, Stop};
use crate::picture::spread;
use crate::words::Language;

/// Edge of a cell of the map, metres.
const CELL_M: f32 = 0.1;
/// Farther returns are too uncertain for the map, metres.
const MAP_RANGE_M: f32 = 20.0;
/// Pixels of the longer side of a picture.
const PICTURE_PX: f32 = 960.0;
/// Marks of stops are this far from each other, pixels.
const MARKS_APART_PX: f32 = 24.0;
/// The picture of a moment shows this much around the robot, metres.
const AROUND_M: f32 = 5.0;

/// What the scans say about each cell: seen through, hit.
type Cells = BTreeMap<(i32, i32), (u32, u32)>;

fn cell(point: Point2, edge_m: f32) -> (i32, i32) {
    ((point.x_m / edge_m).floor() as i32, (point.y_m / edge_m).floor() as i32)
}

/// Occupancy by counting: a cell is what most rays say.
fn map(scans: &[MapScan]) -> Cells {
    let mut cells = Cells::new();
    // Many rays fill every cell, few need all of theirs.
    let stride = if scans.len() > 60 { 2 } else { 1 };
    for scan in scans {
        let from = Point2::new(scan.sensor.x_m, scan.sensor.y_m);
        for hit in &scan.hits {
            let range_m = hit.norm().min(MAP_RANGE_M);
            let to = scan.sensor.transform(*hit);
            let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
            let steps = (range_m / CELL_M) as u32;
            let whole_m = hit.norm().max(CELL_M);
            for step in (0..steps).step_by(stride) {
                let share = step as f32 * CELL_M / whole_m;
                let seen = Point2::new(from.x_m + dx * share, from.y_m + dy * share);
                cells.entry(cell(seen, CELL_M)).or_default().0 += 1;
            }
            if hit.norm() < MAP_RANGE_M {
                cells.entry(cell(to, CELL_M)).or_default().1 += 1;
            }
        }
    }
    cells
}

/// Metres to pixels, y upwards.
struct Frame {
    left_m: f32,
    top_m: f32,
    pixels_per_m: f32,
    width_px: f32,
    height_px: f32,
}

impl Frame {
    fn around(points: impl Iterator<Item = Point2>) -> Self {
        let (mut low, mut high) = (Point2::new(-3.0, -3.0), Point2::new(3.0, 3.0));
        for point in points {
            low = Point2::new(low.x_m.min(point.x_m), low.y_m.min(point.y_m));
            high = Point2::new(high.x_m.max(point.x_m), high.y_m.max(point.y_m));
        }
        let (wide_m, high_m) = (high.x_m - low.x_m + 2.0, high.y_m - low.y_m + 2.0);
        let pixels_per_m = PICTURE_PX / wide_m.max(high_m);
        Self {
            left_m: low.x_m - 1.0,
            top_m: high.y_m + 1.0,
            pixels_per_m,
            width_px: wide_m * pixels_per_m,
            height_px: high_m * pixels_per_m,
        }
    }

    fn at(&self, point: Point2) -> (f32, f32) {
        ((point.x_m - self.left_m) * self.pixels_per_m, (self.top_m - point.y_m) * self.pixels_per_m)
    }

    fn open(&self, label: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" role=\"img\" \
             aria-label=\"{label}\"><rect width=\"100%\" height=\"100%\" fill=\"#eef1f4\"/>",
            self.width_px, self.height_px
        )
    }

    /// Cells side by side in a row become one rectangle.
    fn cells(&self, keys: impl Iterator<Item = (i32, i32)>, edge_m: f32) -> String {
        let mut rows = BTreeMap::<i32, Vec<i32>>::new();
        for (x, y) in keys {
            rows.entry(y).or_default().push(x);
        }
        let edge_px = edge_m * self.pixels_per_m;
        let mut path = String::new();
        for (y, columns) in rows {
            let mut columns = columns.into_iter().peekable();
            while let Some(first) = columns.next() {
                let mut last = first;
                while let Some(next) = columns.next_if(|next| *next == last + 1) {
                    last = next;
                }
                let corner = Point2::new(first as f32 * edge_m, (y + 1) as f32 * edge_m);
                let (left_px, top_px) = self.at(corner);
                let wide_px = (last - first + 1) as f32 * edge_px;
                let _ = write!(path, "M{left_px:.1} {top_px:.1}h{wide_px:.1}v{edge_px:.1}h-{wide_px:.1}z");
            }
        }
        path
    }

    fn line(&self, points: impl Iterator<Item = Point2>) -> String {
        let mut path = String::new();
        for (index, point) in points.enumerate() {
            let (x, y) = self.at(point);
            let _ = write!(path, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
        }
        path
    }

    /// A bar of known length, so that distances can be judged.
    fn scale(&self) -> String {
        let metres = if self.width_px / self.pixels_per_m > 40.0 { 10.0 } else { 2.0 };
        let (y, wide_px) = (self.height_px - 14.0, metres * self.pixels_per_m);
        format!(
            "<path d=\"M14 {y:.0}h{wide_px:.1}\" stroke=\"#1c2733\" stroke-width=\"3\"/><text x=\"14\" y=\"{:.0}\" \
             font-size=\"14\">{metres:.0} m</text>",
            y - 6.0
        )
    }
}

fn place(pose: &Pose2) -> Point2 {
    Point2::new(pose.x_m, pose.y_m)
}

fn everything(history: &History, cells: &Cells) -> Frame {
    let occupied = cells.iter().filter(|(_, seen)| is_occupied(seen));
    let corners = occupied.map(|((x, y), _)| Point2::new(*x as f32 * CELL_M, *y as f32 * CELL_M));
    Frame::around(corners.chain(history.path.iter().map(place)))
}

const fn is_occupied((free, hit): &(u32, u32)) -> bool {
    *hit >= 2 && *hit * 3 > *free
}

fn ground(frame: &Frame, cells: &Cells) -> String {
    let free = cells.iter().filter(|(_, seen)| !is_occupied(seen)).map(|(key, _)| *key);
    let occupied = cells.iter().filter(|(_, seen)| is_occupied(seen)).map(|(key, _)| *key);
    format!(
        "<path d=\"{}\" fill=\"#fff\"/><path d=\"{}\" fill=\"#46525e\"/>",
        frame.cells(free, CELL_M),
        frame.cells(occupied, CELL_M)
    )
}

/// The map, the robot's path, the paths of people, and every stop with its number.
pub fn overview(history: &History, language: Language) -> String {
    let cells = map(&history.scans);
    let frame = everything(history, &cells);
    // Its marks are links: a picture that is one piece would hide them.
    let label = language.say("map with the path of the robot, people and stops");
    let mut svg = frame.open(label).replacen("role=\"img\"", "role=\"group\"", 1);
    svg.push_str(&ground(&frame, &cells));
    for (index, path) in history.people.values().filter(|path| path.len() > 5).enumerate() {
        let hue = index * 47 % 360;
        let line = frame.line(path.iter().step_by(3).copied());
        let _ = write!(
            svg,
            "<path d=\"{line}\" fill=\"none\" stroke=\"hsl({hue} 60% 50%)\" stroke-width=\"1.5\" opacity=\".6\"/>"
        );
    }
    let line = frame.line(history.path.iter().map(place));
    let _ = write!(svg, "<path d=\"{line}\" fill=\"none\" stroke=\"#0b5394\" stroke-width=\"3\"/>");
    let places: Vec<_> = history.stops.iter().map(|stop| frame.at(place(&stop.pose))).collect();
    let drawn = spread(&places, MARKS_APART_PX);
    svg.push_str("<g class=\"mark\" dominant-baseline=\"central\">");
    for (number, ((from_x, from_y), (x, y))) in places.iter().zip(&drawn).enumerate().rev() {
        let _ = write!(
            svg,
            "<a href=\"#stop{n}\"><path d=\"M{from_x:.1} {from_y:.1}L{x:.1} {y:.1}\" stroke=\"#c0392b\"/><circle \
             cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"9\" fill=\"#c0392b\" stroke=\"#fff\"/><text x=\"{x:.1}\" y=\"{y:.1}\" \
             font-size=\"11\" fill=\"#fff\" text-anchor=\"middle\">{n}</text></a>",
            n = number + 1
        );
    }
    svg.push_str("</g>");
    svg.push_str(&frame.scale());
    svg.push_str("<g id=now></g>");
    svg + "</svg>"
}

/// Moments on the slider at most; a longer run has them farther apart.
const MOMENTS_MAX: usize = 2_000;

/// The moments of the run in pixels of the overview: seconds, robot x, y, heading in degrees, speed, and x, y and number of each
/// person, the number of the fields and what the scanner saw; as text for a script. Beside it pixels a metre.
pub fn moments(history: &History) -> (String, f32) {
    let frame = everything(history, &map(&history.scans));
    let every = history.sightings.len().div_ceil(MOMENTS_MAX).max(1);
    let mut text = "[".to_owned();
    for (index, sighting) in history.sightings.iter().step_by(every).enumerate() {
        let (x, y) = frame.at(place(&sighting.pose));
        let heading = -sighting.pose.heading_rad.to_degrees();
        let comma = if index == 0 { "" } else { "," };
        let _ = write!(
            text,
            "{comma}[{:.1},{x:.0},{y:.0},{heading:.0},{:.2},[",
            sighting.at_s,
            sighting.speed_mps + 0.0
        );
        for (number, (id, at)) in sighting.people.iter().enumerate() {
            let (x, y) = frame.at(*at);
            let comma = if number == 0 { "" } else { "," };
            let _ = write!(text, "{comma}{x:.0},{y:.0},{id}");
        }
        let fields = sighting.fields.and_then(|index| i64::try_from(index).ok()).unwrap_or(-1);
        let _ = write!(text, "],{fields},\"{}\"]", sighting.seen);
    }
    (text + "]", frame.pixels_per_m)
}

/// Where people were, and for how long.
pub fn heat(history: &History, language: Language) -> String {
    let cells = map(&history.scans);
    let frame = everything(history, &cells);
    let mut svg = frame.open(language.say("heat map of people"));
    svg.push_str(&ground(&frame, &cells));
    let most = history.heat.values().copied().max().unwrap_or(1).max(1) as f32;
    // Five steps, each four times as long as the one before.
    for step in 0..5_u32 {
        let (low, high) = (most * 0.25_f32.powi(5 - step as i32), most * 0.25_f32.powi(4 - step as i32));
        let keys = history.heat.iter().filter(|(_, count)| (low..=high).contains(&(**count as f32)));
        let path = frame.cells(keys.map(|(key, _)| *key), HEAT_M);
        let opacity = 0.15 + 0.16 * step as f32;
        let _ = write!(svg, "<path d=\"{path}\" fill=\"#d35400\" opacity=\"{opacity:.2}\"/>");
    }
    svg.push_str(&frame.scale());
    svg + "</svg>"
}

/// What surrounded the robot when it stopped; its front is up.
pub fn moment(stop: &Stop, moment: &Moment, (footprint, language): (&[Point2], Language)) -> String {
    const PX: f32 = 300.0;
    // Forward is up, left is left.
    let at = |point: Point2| {
        let scale = PX / (2.0 * AROUND_M);
        ((AROUND_M - point.y_m) * scale, (AROUND_M * 1.3 - point.x_m) * scale)
    };
    let closed = |points: &[Point2]| {
        let mut path = String::new();
        for (index, point) in points.iter().enumerate() {
            let (x, y) = at(*point);
            let _ = write!(path, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
        }
        path + "z"
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {PX} {PX}\" role=\"img\" aria-label=\"{}\"><rect \
         width=\"100%\" height=\"100%\" fill=\"#fff\" stroke=\"#d8dee5\"/>",
        language.fill("around the robot at {} s", &[&language.number(stop.at_s, 1)])
    );
    for (points, colour) in [(&moment.warning, "#f4d58d"), (&moment.protective, "#f1a9a0")] {
        if points.len() > 2 {
            let _ = write!(svg, "<path d=\"{}\" fill=\"{colour}\" opacity=\".6\"/>", closed(points));
        }
    }
    if footprint.len() > 2 {
        let _ = write!(svg, "<path d=\"{}\" fill=\"#0b5394\"/>", closed(footprint));
    }
    let mut dots = String::new();
    for hit in moment.hits.iter().filter(|hit| hit.norm() < AROUND_M * 2.0) {
        let (x, y) = at(*hit);
        let _ = write!(dots, "M{x:.1} {y:.1}h0");
    }
    let _ =
        write!(svg, "<path d=\"{dots}\" stroke=\"#1c2733\" stroke-width=\"3\" stroke-linecap=\"round\"/>");
    for (id, person) in moment.people.iter().filter(|(_, person)| person.norm() < AROUND_M * 2.0) {
        let (x, y) = at(*person);
        let _ = write!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"9\" fill=\"#d35400\" opacity=\".75\"/><text x=\"{x:.1}\" \
             y=\"{:.1}\" font-size=\"10\" fill=\"#fff\" text-anchor=\"middle\">{id}</text>",
            y + 3.5
        );
    }
    let _ = write!(
        svg,
        "<path d=\"M10 290h{:.0}\" stroke=\"#1c2733\" stroke-width=\"2\"/><text x=\"10\" y=\"283\" font-size=\"12\">2 \
         m</text></svg>",
        2.0 * PX / (2.0 * AROUND_M)
    );
    svg
}
