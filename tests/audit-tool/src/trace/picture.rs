//! States of the guard and the transitions that the search over the real code saw, as a picture.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use crate::claim::{Claim, Finding};
use crate::facts::{State, facts};
use crate::trace::results::{CauseLine, Explored, Transition};

/// Half of a state's width and height.
const HALF: (f32, f32) = (80.0, 32.0);

/// The picture. Arrows show which state can follow which; staying is not shown.
pub fn svg(transitions: &[Transition]) -> String {
    let mut text = String::from(HEAD);
    for Transition { from, to, .. } in transitions.iter().filter(|seen| seen.from != seen.to) {
        let place = |name: &str| facts().states.shown.iter().find(|state| state.name == name);
        if let (Some(start), Some(end)) = (place(from), place(to)) {
            arrow(&mut text, (start.x, start.y), (end.x, end.y), start.reset);
        }
    }
    for State { name, x, y, meaning, .. } in &facts().states.shown {
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

/// A bent arrow from border to border; those out of a state that needs one are drawn as resets.
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

/// The manual's picture is the one that the code gives today, and the table below it has every cause.
pub fn claim(root: &Path, (explored, causes): (&Explored, &[CauseLine]), wanted: &BTreeSet<String>) -> Claim {
    let kept = std::fs::read_to_string(root.join(&facts().states.picture)).unwrap_or_default();
    Claim {
        id: "states-pictured",
        text: "The picture of states and transitions in the safety manual is what the code does, and the code reported every cause.",
        evidence: format!(
            "the search over all reachable states found {} of them, judged each of {} steps, and saw {} pairs of shown states \
             follow one another; {} causes printed what they demand, of {} in the code",
            explored.states,
            explored.steps,
            explored.transitions.len(),
            causes.len(),
            wanted.len()
        ),
        findings: [drawn(&kept, explored), reported(causes, wanted)].concat(),
    }
}

/// What the picture lacks.
fn drawn(kept: &str, explored: &Explored) -> Vec<Finding> {
    let complain = |message: String| Finding { place: facts().states.picture.clone(), line: 0, message };
    if explored.transitions.is_empty() || explored.states == 0 {
        return vec![complain(String::from("the search over the states did not run, or found none"))];
    }
    let names = explored.transitions.iter().flat_map(|seen| [seen.from.as_str(), seen.to.as_str()]);
    let unknown: BTreeSet<&str> =
        names.filter(|name| !facts().states.shown.iter().any(|state| state.name == *name)).collect();
    let mut findings: Vec<Finding> = unknown
        .into_iter()
        .map(|name| {
            complain(format!(
                "the search saw the state `{name}`, which is not drawn; add it to tests/audit.toml"
            ))
        })
        .collect();
    if kept != svg(&explored.transitions) {
        let message = "is not what the code does today: copy target/audit/guard-states.svg over it";
        findings.push(complain(message.to_owned()));
    }
    findings
}

/// What the printed table of causes lacks, or has too much.
fn reported(causes: &[CauseLine], wanted: &BTreeSet<String>) -> Vec<Finding> {
    let complain = |message: String| Finding { place: facts().trace.causes.clone(), line: 0, message };
    if causes.is_empty() || wanted.is_empty() {
        return vec![complain(String::from(
            "no test printed what the causes demand: guard/tests/truth_tables.rs does",
        ))];
    }
    let printed: BTreeSet<&str> = causes.iter().map(|line| line.cause.as_str()).collect();
    let absent = wanted.iter().filter(|cause| !printed.contains(cause.as_str()));
    let absent =
        absent.map(|cause| format!("the test of the causes did not print `{cause}`, or not in five cells"));
    let unknown = printed.iter().filter(|cause| !wanted.contains(**cause));
    let unknown = unknown.map(|cause| format!("the test of the causes printed `{cause}`, which is no cause"));
    absent.chain(unknown).map(complain).collect()
}

const HEAD: &str = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 800 580' font-family='sans-serif' \
font-size='13' text-anchor='middle'>\n<style>rect{fill:#eef3fa;stroke:#345}.name{font-size:17px;font-weight:bold}\
.arrow{fill:none;stroke:#345;stroke-width:1.6;marker-end:url(#tip)}.reset{stroke:#b3261e;stroke-dasharray:6 4}</style>\n\
<marker id='tip' viewBox='0 0 10 10' refX='8' refY='5' markerWidth='7' markerHeight='7' orient='auto'>\
<path d='M0 0 10 5 0 10z' fill='#345'/></marker>\n\
<text x='400' y='560'>dashed: only by an act of the operator (reset with a passed self-test, then start)</text>\n";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_are_drawn_only_for_seen_transitions() {
        let seen = [("Run", "Stop"), ("Latched", "Run"), ("Run", "Run")];
        let seen = seen.map(|(from, to)| Transition { from: from.to_owned(), to: to.to_owned(), steps: 1 });
        let picture = svg(&seen);
        assert_eq!(picture.matches("class='arrow'").count(), 1);
        assert_eq!(picture.matches("class='arrow reset'").count(), 1);
        assert!(!picture.contains("NaN"));
    }

    fn explored(steps: &[(&str, &str)]) -> Explored {
        let seen = |(from, to): &(&str, &str)| Transition {
            from: (*from).to_owned(),
            to: (*to).to_owned(),
            steps: 1,
        };
        Explored { states: 3, steps: 9, transitions: steps.iter().map(seen).collect() }
    }

    #[test]
    fn a_state_that_is_not_drawn_is_named() {
        let good = explored(&[("Run", "Stop")]);
        let kept = svg(&good.transitions);
        assert_eq!(drawn(&kept, &good), []);
        let new = explored(&[("Run", "Stop"), ("Run", "Docked"), ("Docked", "Docked")]);
        let findings = drawn(&kept, &new);
        assert_eq!(findings.len(), 1, "{findings:?}");
        assert!(findings[0].message.contains("`Docked`"), "{findings:?}");
        assert_eq!(drawn(&kept, &explored(&[("Stop", "Run")])).len(), 1, "another picture");
        assert_eq!(drawn(&svg(&[]), &explored(&[])).len(), 1, "nothing was searched");
        assert_eq!(drawn(&kept, &Explored { states: 0, ..good }).len(), 1, "no state was counted");
    }

    #[test]
    fn causes_that_are_not_printed_are_named() {
        let line = |cause: &str| {
            let text = || "x".to_owned();
            CauseLine {
                cause: cause.to_owned(),
                action: text(),
                clears: text(),
                escape: text(),
                words: text(),
            }
        };
        let wanted = BTreeSet::from(["A", "B(X)"].map(str::to_owned));
        let messages = |causes: &[CauseLine]| {
            reported(causes, &wanted)
                .into_iter()
                .map(|finding| finding.message)
                .collect::<Vec<_>>()
                .join("; ")
        };
        assert_eq!(messages(&[line("A"), line("B(X)")]), "");
        assert!(messages(&[line("A")]).contains("did not print `B(X)`"));
        assert!(messages(&[line("A"), line("B(X)"), line("C")]).contains("`C`, which is no cause"));
        assert_eq!(reported(&[], &wanted).len(), 1);
    }
}
