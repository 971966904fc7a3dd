//! Curves and strips over time as SVG.

use std::fmt::Write;

use super::history::History;

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 220.0;
const LEFT: f64 = 44.0;
/// Names of sources stand before their strips.
const NAMES: f64 = 150.0;
const STRIP: f64 = 26.0;

struct Axis {
    left: f64,
    last_s: f64,
}

impl Axis {
    fn x(&self, at_s: f64) -> f64 {
        self.left + at_s / self.last_s * (WIDTH - self.left - 14.0)
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
            let _ = write!(
                svg,
                "<path d=\"M{x:.1} {from_y:.0}V{to_y:.0}\" stroke=\"#d8dee5\"/><text x=\"{x:.1}\" y=\"{:.0}\" \
                 text-anchor=\"middle\">{label}</text>",
                to_y + 14.0
            );
        }
        svg
    }
}

fn open(height: f64, label: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" font-size=\"14\" role=\"img\" \
         aria-label=\"{label}\">"
    )
}

/// Speed as a line before the limit as an area, stops as ticks.
pub fn speeds(history: &History) -> String {
    let axis = Axis { left: LEFT, last_s: history.duration_s.max(1.0) };
    let top_mps = history
        .speeds
        .iter()
        .flat_map(|speed| [speed.speed_mps.abs(), speed.limit_mps.unwrap_or(0.0)])
        .fold(0.6_f32, f32::max)
        * 1.1;
    let bottom = HEIGHT - 20.0;
    let y = |mps: f32| bottom - f64::from(mps.clamp(0.0, top_mps) / top_mps) * (bottom - 10.0);
    let mut svg = open(HEIGHT, "speed and limit over time");
    svg.push_str(&axis.marks(6.0, bottom));
    let (mut limit, mut speed) = (format!("M{:.1} {bottom:.1}", axis.x(0.0)), String::new());
    let mut last_x = axis.x(0.0);
    for sample in &history.speeds {
        let x = axis.x(sample.at_s);
        // A limit holds until the next one: steps, not slopes.
        let _ = write!(limit, "H{x:.1}V{:.1}", y(sample.limit_mps.unwrap_or(0.0)));
        let word = if speed.is_empty() { 'M' } else { 'L' };
        let _ = write!(speed, "{word}{x:.1} {:.1}", y(sample.speed_mps.abs()));
        last_x = x;
    }
    let _ = write!(
        svg,
        "<path d=\"{limit}H{last_x:.1}V{bottom:.1}z\" fill=\"#cfe3f5\"/><path d=\"{speed}\" fill=\"none\" \
         stroke=\"#0b5394\" stroke-width=\"1.6\"/>"
    );
    for stop in &history.stops {
        let x = axis.x(stop.at_s);
        let _ = write!(svg, "<path d=\"M{x:.1} {bottom:.0}v-12\" stroke=\"#c0392b\" stroke-width=\"2\"/>");
    }
    let mut mps = 0.0_f32;
    while mps < top_mps {
        let _ = write!(svg, "<text x=\"4\" y=\"{:.1}\">{mps:.1}</text>", y(mps) + 4.0);
        mps += if top_mps > 2.0 { 0.5 } else { 0.2 };
    }
    svg + "</svg>"
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
pub fn sources(history: &History) -> String {
    let axis = Axis { left: NAMES, last_s: history.duration_s.max(1.0) };
    let count = history.sources.len() as f64;
    let bottom = 4.0 + count * STRIP;
    let mut svg = open(bottom + 20.0, "health of the sources over time");
    for (row, (name, spans)) in history.sources.iter().enumerate() {
        let top = 4.0 + row as f64 * STRIP;
        for (index, (from_s, level, word)) in spans.iter().enumerate() {
            let to_s = spans.get(index + 1).map_or(axis.last_s, |(at_s, ..)| *at_s);
            let (x, wide) = (axis.x(*from_s), axis.x(to_s) - axis.x(*from_s));
            let _ = write!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"{wide:.1}\" height=\"{:.0}\" fill=\"{}\"><title>{} \
                 {from_s:.1} to {to_s:.1} s: {}</title></rect>",
                STRIP - 4.0,
                colour(*level),
                super::document::escaped(name),
                super::document::escaped(word)
            );
        }
        let _ = write!(
            svg,
            "<text x=\"{:.0}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            NAMES - 8.0,
            top + 16.0,
            super::document::escaped(name)
        );
    }
    svg.push_str(&axis.marks(bottom, bottom));
    svg + "</svg>"
}
