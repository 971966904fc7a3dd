//! The right side of the picture: what the lines mean, why the robot stopped how often, and every stop by number.

use super::canvas::{Canvas, Ink, Lettering};
use super::content::TopView;
use super::palette;
use super::top_view::{area, line};

/// Width of the panel, pixels.
pub(super) const WIDTH_PX: f32 = 390.0;
const ROW_PX: f32 = 22.0;
/// Letters of a cause that fit into the panel.
const CAUSE_LETTERS: usize = 44;
/// Stops with a number of their own; more would hide the map.
const NUMBERED_MAX: usize = 99;

/// The causes of the stops and how often each was one, in the order of their first stop.
pub(super) fn causes(view: &TopView) -> Vec<(&str, usize)> {
    counted(view.stops.iter().map(|stop| stop.cause.as_str()))
}

fn counted<'a>(stops: impl Iterator<Item = &'a str>) -> Vec<(&'a str, usize)> {
    let mut causes: Vec<(&str, usize)> = Vec::new();
    for stop in stops {
        match causes.iter_mut().find(|(cause, _)| *cause == stop) {
            Some((_, count)) => *count += 1,
            None => causes.push((stop, 1)),
        }
    }
    causes
}

/// The colour in which the picture draws each of these stops.
pub fn cause_colours<'a>(stops: impl Iterator<Item = &'a str> + Clone) -> Vec<&'static str> {
    let causes = counted(stops.clone());
    let place = |stop| causes.iter().position(|(cause, _)| *cause == stop).unwrap_or(0);
    stops.map(|stop| palette::cause(place(stop))).collect()
}

/// The mark of a stop: a disc with its number.
pub(super) fn draw_stop(canvas: &mut Canvas, (x, y): (f32, f32), colour: &'static str, number: usize) {
    canvas.circle((x, y), 9.0, Ink { stroke: palette::PAPER, width_px: 1.6, ..area(colour) });
    if number <= NUMBERED_MAX {
        let lettering = Lettering {
            at_px: (x, y + 0.5),
            size_px: 11.0,
            colour: palette::PAPER,
            anchor: "middle",
            is_bold: true,
        };
        canvas.centred_text(&number.to_string(), lettering);
    }
}

/// Draws the panel with its upper left corner at `origin_px` and at most `height_px` high.
pub(super) fn draw(view: &TopView, canvas: &mut Canvas, origin_px: (f32, f32), height_px: f32) {
    let (x, top) = origin_px;
    let mut y = top + 12.0;
    heading(canvas, (x, y), "What you see");
    y += ROW_PX;
    for (draw_sample, words) in samples(view) {
        draw_sample(canvas, (x, y - 4.5));
        words_at(canvas, (x + 40.0, y), &words);
        y += ROW_PX;
    }
    y += ROW_PX / 2.0;
    let causes = causes(view);
    heading(canvas, (x, y), &format!("Stops: {}", view.stops.len()));
    y += ROW_PX;
    for (index, (cause, count)) in causes.iter().enumerate() {
        canvas.circle((x + 10.0, y - 4.5), 6.0, area(palette::cause(index)));
        words_at(canvas, (x + 40.0, y), &format!("{count} × {}", shortened(cause)));
        y += ROW_PX;
    }
    y += ROW_PX / 2.0;
    let rows = ((top + height_px - y) / ROW_PX).floor().max(0.0) as usize;
    let listed = if view.stops.len() > rows { rows.saturating_sub(1) } else { view.stops.len() };
    for (index, stop) in view.stops.iter().take(listed).enumerate() {
        let place = causes.iter().position(|(cause, _)| *cause == stop.cause).unwrap_or(0);
        draw_stop(canvas, (x + 10.0, y - 4.5), palette::cause(place), index + 1);
        words_at(canvas, (x + 40.0, y), &format!("{:.1} s  {}", stop.at_s, shortened(&stop.cause)));
        y += ROW_PX;
    }
    if listed < view.stops.len() {
        words_at(canvas, (x + 40.0, y), &format!("and {} more", view.stops.len() - listed));
    }
}

type Sample = fn(&mut Canvas, (f32, f32));

/// Samples of what the picture really contains.
fn samples(view: &TopView) -> Vec<(Sample, String)> {
    let mut samples: Vec<(Sample, String)> = Vec::new();
    if !view.robot_path.is_empty() {
        samples.push((robot_sample, "path of the robot".into()));
        samples.push((start_sample, "start (white) and end (blue)".into()));
    }
    match view.people.len() {
        0 => {}
        1 => samples.push((people_sample, "path of 1 person, dot at the end".into())),
        many => samples.push((people_sample, format!("paths of {many} people, dot at the end"))),
    }
    if !view.walls.is_empty() {
        samples.push((|canvas, at| block_sample(canvas, at, palette::WALL), "walls".into()));
    }
    if !view.obstacles.is_empty() {
        samples.push((|canvas, at| block_sample(canvas, at, palette::OBSTACLE), "obstacles".into()));
    }
    samples
}

fn robot_sample(canvas: &mut Canvas, (x, y): (f32, f32)) {
    canvas.path(&[(x, y), (x + 28.0, y)], false, line(palette::ROBOT, 2.6));
    canvas.path(&[(x + 21.0, y), (x + 10.0, y + 5.0), (x + 10.0, y - 5.0)], true, area(palette::ROBOT));
}

fn start_sample(canvas: &mut Canvas, (x, y): (f32, f32)) {
    let start = Ink { fill: palette::PAPER, ..line(palette::ROBOT, 2.0) };
    canvas.rectangle((x, y - 5.0), (12.0, 10.0), start);
    canvas.rectangle((x + 17.0, y - 5.0), (12.0, 10.0), area(palette::ROBOT));
}

fn people_sample(canvas: &mut Canvas, (x, y): (f32, f32)) {
    for (index, offset_px) in [-3.0, 3.0].into_iter().enumerate() {
        let colour = palette::person(index);
        canvas.path(&[(x, y + offset_px), (x + 24.0, y + offset_px)], false, line(colour, 1.8));
        canvas.circle((x + 26.0, y + offset_px), 3.0, area(colour));
    }
}

fn block_sample(canvas: &mut Canvas, (x, y): (f32, f32), colour: &'static str) {
    canvas.rectangle((x, y - 5.0), (28.0, 10.0), area(colour));
}

fn heading(canvas: &mut Canvas, at_px: (f32, f32), words: &str) {
    canvas.text(
        words,
        Lettering { at_px, size_px: 15.0, colour: palette::INK, anchor: "start", is_bold: true },
    );
}

fn words_at(canvas: &mut Canvas, at_px: (f32, f32), words: &str) {
    canvas.text(
        words,
        Lettering { at_px, size_px: 13.0, colour: palette::INK, anchor: "start", is_bold: false },
    );
}

fn shortened(words: &str) -> String {
    if words.chars().count() <= CAUSE_LETTERS {
        return words.to_owned();
    }
    words.chars().take(CAUSE_LETTERS - 1).chain(['…']).collect()
}
