//! States of the guard and the transitions that the search over the real code saw, as a picture.

use std::fmt::Write as _;
use std::path::Path;

use super::claim::{Claim, Finding};
use super::results::{Explored, Transition};

/// Where the manual shows it.
pub const PATH: &str = "docs/pictures/guard-states.svg";

/// States, where they stand, and what they mean.
const STATES: [(&str, f32, f32, &str); 5] = [
    ("Init", 110.0, 90.0, "start-up check"),
    ("Run", 400.0, 90.0, "free within limits"),
    ("Slow", 690.0, 90.0, "lower limit"),
    ("Stop", 545.0, 300.0, "goes on by itself"),
    ("Latched", 255.0, 300.0, "waits for the operator"),
];
const HALF: (f32, f32) = (80.0, 32.0);

/// The picture. Arrows show which state can follow which; staying is not shown.
pub fn svg(transitions: &[Transition]) -> String {
    let mut text = String::from(HEAD);
    for Transition { from, to, .. } in transitions.iter().filter(|seen| seen.from != seen.to) {
        let place = |name: &str| STATES.iter().find(|state| state.0 == name).map(|state| (state.1, state.2));
        if let (Some(start), Some(end)) = (place(from), place(to)) {
            arrow(&mut text, start, end, from == "Latched");
        }
    }
    for (name, x, y, meaning) in STATES {
        let (left, top) = (x - HALF.0, y - HALF.1);
        let (width, height) = (2.0 * HALF.0, 2.0 * HALF.1);
        let _ = writeln!(
            text,
            "<rect x='{left}' y='{top}' width='{width}' height='{height}' rx='8'/>\n\
             <text x='{x}' y='{}' class='name'>{name}</text>\n<text x='{x}' y='{}'>{meaning}</text>",
            y - 4.0,
            y + 17.0
        );
    }
    text.push_str("</svg>\n");
    text
}

/// A bent arrow from border to border; those out of `Latched` need reset and self-test.
fn arrow(text: &mut String, (x0, y0): (f32, f32), (x1, y1): (f32, f32), reset: bool) {
    let (dx, dy) = (x1 - x0, y1 - y0);
    let length = dx.hypot(dy).max(1.0);
    let (ux, uy) = (dx / length, dy / length);
    let border = |share: f32| share.min((HALF.0 / ux.abs().max(1e-3)).min(HALF.1 / uy.abs().max(1e-3)));
    let (from, to) = (border(length), border(length) + 6.0);
    // To the right of its direction, so that there and back do not lie on one another.
    let (sx, sy) = (-uy * 12.0, ux * 12.0);
    // Wide enough to pass by a state that stands between the two.
    let bend = if length > 400.0 && dy.abs() < 1.0 { 11.0 } else { 2.5 };
    let class = if reset { "arrow reset" } else { "arrow" };
    let _ = writeln!(
        text,
        "<path class='{class}' d='M{:.0} {:.0} Q{:.0} {:.0} {:.0} {:.0}'/>",
        x0 + ux * from + sx,
        y0 + uy * from + sy,
        x0 + dx / 2.0 + sx * bend,
        y0 + dy / 2.0 + sy * bend,
        x1 - ux * to + sx,
        y1 - uy * to + sy,
    );
}

/// The manual's picture is the one that the code gives today.
pub fn claim(root: &Path, explored: &Explored) -> Claim {
    let drawn = svg(&explored.transitions);
    let current = std::fs::read_to_string(root.join(PATH)).is_ok_and(|kept| kept == drawn);
    let complaint = if explored.transitions.is_empty() {
        Some("the search over the states did not run")
    } else {
        (!current).then_some("is not what the code does today: copy target/audit/guard-states.svg over it")
    };
    let findings =
        complaint.map(|what| Finding { place: PATH.to_owned(), line: 0, message: what.to_owned() });
    Claim {
        id: "states-pictured",
        text: "The picture of states and transitions in the safety manual is what the code does.",
        evidence: format!(
            "the search over all reachable states found {} of them, judged each of {} steps, and saw {} pairs of shown states \
             follow one another",
            explored.states,
            explored.steps,
            explored.transitions.len()
        ),
        findings: findings.into_iter().collect(),
    }
}

const HEAD: &str = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 800 390' font-family='sans-serif' \
font-size='13' text-anchor='middle'>\n<style>rect{fill:#eef3fa;stroke:#345}.name{font-size:17px;font-weight:bold}\
.arrow{fill:none;stroke:#345;stroke-width:1.6;marker-end:url(#tip)}.reset{stroke:#b3261e;stroke-dasharray:6 4}</style>\n\
<marker id='tip' viewBox='0 0 10 10' refX='8' refY='5' markerWidth='7' markerHeight='7' orient='auto'>\
<path d='M0 0 10 5 0 10z' fill='#345'/></marker>\n\
<text x='400' y='375'>dashed: only by reset with a passed self-test</text>\n";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_are_drawn_for_what_was_seen_and_nothing_else() {
        let seen = [("Run", "Stop"), ("Latched", "Run"), ("Run", "Run")];
        let seen = seen.map(|(from, to)| Transition { from: from.to_owned(), to: to.to_owned(), steps: 1 });
        let picture = svg(&seen);
        assert_eq!(picture.matches("class='arrow'").count(), 1);
        assert_eq!(picture.matches("class='arrow reset'").count(), 1);
        assert!(!picture.contains("NaN"));
    }
}
