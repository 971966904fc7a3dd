//! What the search over all reachable states of the guard saw, and what each cause demands, as the code says today.

use std::collections::BTreeSet;

use super::table::{Table, code, escape, grouped};
use crate::trace::results::{CauseLine, Explored};

/// The picture, the count of each transition, and the causes.
pub fn section(picture: &str, explored: &Explored, causes: &[CauseLine]) -> String {
    format!(
        "<p>A search by breadth over the real supervisor, from start-up, made in this run: <b>{} states</b> that differ in more \
         than the clock, <b>{} steps</b> out of them, one for each state and each of twelve happenings (obstacles, a person, \
         contact, emergency stop, a lost source, reset, leaving, and mixtures). After every step the test holds that a robot \
         with a hazard before it, or with a button pressed, stands or only leaves; that what is latched stays so without a reset \
         and a passed self-test; and that nothing moves before the start-up check \
         (<code>core-nostd/guard/src/tests/reachable.rs</code>). A second model of the decisions, written from the requirements \
         alone, goes the same way at random: see <i>model</i> among the campaigns.</p>{picture}{}\
         <h3>Every cause: what it demands and how it clears</h3><p>Printed by the guard's own table \
         (<code>core-nostd/guard/src/rules.rs</code>) in this run. What a person beside the robot is to do about each stands in \
         <a href='../../docs/src/operating.md'>docs/src/operating.md</a>.</p>{}",
        grouped(explored.states),
        grouped(explored.steps),
        transitions(explored),
        table_of(causes)
    )
}

/// From each shown state to each: steps of the search that went that way.
fn transitions(explored: &Explored) -> String {
    let states: BTreeSet<&str> =
        explored.transitions.iter().flat_map(|seen| [seen.from.as_str(), seen.to.as_str()]).collect();
    let mut columns = vec!["steps from, to"];
    columns.extend(states.iter().copied());
    let mut table = Table::new(&columns);
    for from in &states {
        let steps = |to: &&str| {
            let found = explored.transitions.iter().find(|seen| seen.from == *from && seen.to == *to);
            found.map_or_else(|| String::from("never"), |seen| grouped(seen.steps))
        };
        let mut row = vec![format!("<b>{}</b>", escape(from))];
        row.extend(states.iter().map(steps));
        table.row(&row);
    }
    table.finish()
}

fn table_of(causes: &[CauseLine]) -> String {
    let mut table =
        Table::new(&["cause", "what people read", "action", "how it clears", "may leave meanwhile"]);
    for line in causes {
        table.row(&[
            code(&line.cause),
            escape(&line.words),
            escape(&line.action),
            escape(&clears(&line.clears)),
            escape(leaves(&line.escape)),
        ]);
    }
    table.finish()
}

fn clears(clear: &str) -> String {
    let quiet = clear.strip_prefix("Quiet(").and_then(|rest| rest.strip_suffix(')')?.parse::<f64>().ok());
    match (quiet, clear) {
        (Some(quiet_us), _) => format!("by itself, {:.1} s after the last evidence", quiet_us * 1.0e-6),
        (None, "Reset") => String::from("by the operator's reset with a passed self-test"),
        (None, "Restart") => String::from("never without a restart"),
        (None, other) => other.to_owned(),
    }
}

fn leaves(escape: &str) -> &str {
    match escape {
        "Never" => "no",
        "Forward" => "forwards, at a crawl",
        "Backward" => "backwards, at a crawl",
        "AwayFromEvidence" => "where no evidence comes nearer",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::results::Transition;

    #[test]
    fn counts_and_causes_are_reported_in_words() {
        let step =
            |from: &str, to: &str| Transition { from: from.to_owned(), to: to.to_owned(), steps: 7_000 };
        let explored = Explored {
            states: 3,
            steps: 14_000,
            transitions: vec![step("Run", "Stop"), step("Stop", "Stop")],
        };
        let text = str::to_owned;
        let cause = CauseLine {
            cause: text("InputUnknown"),
            action: text("stop"),
            clears: text("Reset"),
            escape: text("Never"),
            words: text("safety input not read"),
        };
        let html = section("<svg>", &explored, &[cause]);
        assert!(html.contains("<b>3 states</b>") && html.contains("never"), "{html}");
        assert!(html.contains("<b>Stop</b><td>never<td>7\u{202f}000"), "{html}");
        assert!(html.contains("safety input not read<td>stop<td>by the operator&#39;s reset"), "{html}");
        assert_eq!(clears("Quiet(500000)"), "by itself, 0.5 s after the last evidence");
        assert_eq!(leaves("Backward"), "backwards, at a crawl");
    }
}
