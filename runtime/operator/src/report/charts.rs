//! Curves and strips over time as SVG.

use std::fmt::Write;

use super::history::History;
use super::style::escaped;
use crate::words::Language;

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 60.0;
/// Space for half the text of the last mark.
const RIGHT: f64 = 36.0;
/// The unit stands above the curve.
const TOP: f64 = 36.0;
/// Words of the marks, as large as a phone shows them.
const FOOT: f64 = 30.0;
/// Names of sources stand before their strips.
const NAMES: f64 = 225.0;
const STRIP: f64 = 30.0;

struct Axis {
    left: f64,
    last_s: f64,
}

impl Axis {
    fn x(&self, at_s: f64) -> f64 {
        self.left + at_s / self.last_s * (WIDTH - self.left - RIGHT)
    }

    /// Marks at round times.
    fn marks(&self, from_y: f64, to_y: f64) -> String {
        let step_s = [1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 300.0, 600.0, 3600.0]
            .into_iter()
            .find(|s| self.last_s / s <= 12.0);
        let step_s = step_s.unwrap_or(7200.0);
        let mut svg = String::new();
        for mark in 0..=(self.last_s / step_s) as u32 {
            let at_s = f64::from(mark) * step_s;
            let x = self.x(at_s);
            let label =
                if step_s >= 60.0 { format!("{:.0} min", at_s / 60.0) } else { format!("{at_s:.0} s") };
            let class = if mark % 2 == 1 { " class=\"odd\"" } else { "" };
            // The first one would touch the values at the left.
            let anchor = if mark == 0 { "start" } else { "middle" };
            let _ = write!(
                svg,
                "<path d=\"M{x:.1} {from_y:.0}V{to_y:.0}\" stroke=\"#d8dee5\"/><text{class} x=\"{x:.1}\" \
                 y=\"{:.0}\" text-anchor=\"{anchor}\">{label}</text>",
                to_y + FOOT - 6.0
            );
        }
        svg
    }
}

fn open(height: f64, label: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" font-size=\"15\" role=\"img\" \
         aria-label=\"{label}\">"
    )
}

/// A value at the left edge with its line across.
fn level(svg: &mut String, y: f64, word: &str) {
    let _ = write!(
        svg,
        "<path d=\"M{LEFT} {y:.1}H{:.0}\" stroke=\"#e9edf1\"/><text x=\"{:.0}\" y=\"{y:.1}\" text-anchor=\"end\" \
         dominant-baseline=\"central\">{word}</text>",
        WIDTH - RIGHT,
        LEFT - 8.0
    );
}

/// Speed and what was permitted at a time: seconds, m/s, m/s.
pub type SpeedAt = (f64, f32, f32);

/// Speed as a line before the limit as an area, stops as ticks.
pub fn speeds(
    (duration_s, language): (f64, Language),
    speeds: &[SpeedAt],
    stops_s: impl Iterator<Item = f64>,
) -> String {
    let axis = Axis { left: LEFT, last_s: duration_s.max(1.0) };
    let fastest = speeds.iter().flat_map(|(_, speed, limit)| [speed.abs(), *limit]).fold(0.6_f32, f32::max);
    let top_mps = fastest * 1.1;
    let bottom = HEIGHT - FOOT;
    let y = |mps: f32| bottom - f64::from(mps.clamp(0.0, top_mps) / top_mps) * (bottom - TOP);
    let mut svg = open(HEIGHT, language.say("speed and limit over time"));
    let step_mps = if top_mps > 2.0 { 0.5 } else { 0.2 };
    for step in 0..=(top_mps / step_mps) as u8 {
        let mps = f32::from(step) * step_mps;
        level(&mut svg, y(mps), &language.number(mps.into(), 1));
    }
    let (mut limit, mut speed) = (format!("M{:.1} {bottom:.1}", axis.x(0.0)), String::new());
    let mut last_x = axis.x(0.0);
    for (at_s, speed_mps, limit_mps) in speeds {
        let x = axis.x(*at_s);
        // A limit holds until the next one: steps, not slopes.
        let _ = write!(limit, "H{x:.1}V{:.1}", y(*limit_mps));
        let word = if speed.is_empty() { 'M' } else { 'L' };
        let _ = write!(speed, "{word}{x:.1} {:.1}", y(speed_mps.abs()));
        last_x = x;
    }
    let _ = write!(
        svg,
        "<path d=\"{limit}H{last_x:.1}V{bottom:.1}z\" fill=\"#cfe3f5\"/><text x=\"4\" y=\"17\">m/s</text>"
    );
    svg.push_str(&axis.marks(TOP, bottom));
    let _ = write!(svg, "<path d=\"{speed}\" fill=\"none\" stroke=\"#0b5394\" stroke-width=\"1.8\"/>");
    for at_s in stops_s {
        let x = axis.x(at_s);
        let _ = write!(svg, "<path d=\"M{x:.1} {bottom:.0}v-16\" stroke=\"#c0392b\" stroke-width=\"3\"/>");
    }
    svg + "</svg>"
}

/// Completion of a mission over time.
pub fn progress(history: &History, language: Language) -> String {
    const HEIGHT: f64 = 180.0;
    let axis = Axis { left: LEFT, last_s: history.duration_s.max(1.0) };
    let bottom = HEIGHT - FOOT;
    let y = |percent: f64| bottom - percent.clamp(0.0, 100.0) / 100.0 * (bottom - TOP);
    let mut svg = open(HEIGHT, language.say("progress of the mission over time"));
    for percent in [0.0, 50.0, 100.0] {
        level(&mut svg, y(percent), &format!("{percent:.0}"));
    }
    svg.push_str("<text x=\"4\" y=\"17\">%</text>");
    svg.push_str(&axis.marks(TOP, bottom));
    let mut line = String::new();
    for (at_s, values) in &history.mission {
        let done = values.iter().find(|(key, _)| key == "completion_percent");
        let Some(percent) = done.and_then(|(_, value)| value.parse::<f64>().ok()) else { continue };
        let word = if line.is_empty() { 'M' } else { 'L' };
        let _ = write!(line, "{word}{:.1} {:.1}", axis.x(*at_s), y(percent));
    }
    let _ = write!(svg, "<path d=\"{line}\" fill=\"none\" stroke=\"#2e7d32\" stroke-width=\"2.5\"/></svg>");
    svg
}

const fn colour(level: u8) -> &'static str {
    match level {
        0 => "#7fb77e",
        1 => "#f2c14e",
        2 => "#c0392b",
        _ => "#8e8e93",
    }
}

/// A strip for each source: how it was, when.
pub fn sources(history: &History, language: Language) -> String {
    let axis = Axis { left: NAMES, last_s: history.duration_s.max(1.0) };
    let count = history.sources.len() as f64;
    let bottom = 4.0 + count * STRIP;
    let mut svg = open(bottom + FOOT, language.say("health of the sources over time"));
    for (row, (name, spans)) in history.sources.iter().enumerate() {
        let top = 4.0 + row as f64 * STRIP;
        for (index, (from_s, level, word)) in spans.iter().enumerate() {
            let to_s = spans.get(index + 1).map_or(axis.last_s, |(at_s, ..)| *at_s);
            let (x, wide) = (axis.x(*from_s), axis.x(to_s) - axis.x(*from_s));
            let _ = write!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"{wide:.1}\" height=\"{:.0}\" fill=\"{}\"><title>{}</title></rect>",
                STRIP - 4.0,
                colour(*level),
                escaped(&span_words(language, (name, word), [*from_s, to_s]))
            );
        }
        let _ = write!(
            svg,
            "<text x=\"{:.0}\" y=\"{:.1}\" text-anchor=\"end\" dominant-baseline=\"central\">{}</text>",
            NAMES - 8.0,
            top + STRIP / 2.0 - 2.0,
            escaped(&language.begin(name))
        );
    }
    svg.push_str(&axis.marks(bottom, bottom));
    svg + "</svg>"
}

/// How a source was, and from when to when.
fn span_words(language: Language, (name, word): (&str, &str), [from_s, to_s]: [f64; 2]) -> String {
    let (from, to) = (language.number(from_s, 1), language.number(to_s, 1));
    language.fill("{} from {} to {} s: {}", &[&language.begin(name), &from, &to, language.say(word)])
}
