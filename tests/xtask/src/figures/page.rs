//! The page of one subject.

use std::fmt::Write as _;

use super::cells;
use super::schema::{Experiment, Record, Subject};

const HEAD: &str = "| metric | data, seed | n | result ± interval | target | met | command |\n|---|---|---|---|---|---|---|\n";

/// The page.
pub fn text(subject: &Subject) -> String {
    let Subject { name, title, about, experiments, .. } = subject;
    let mut text = format!(
        "# Figures: {title}\n\n<!-- written by cargo xtask figures from docs/evidence/figures/{name}.json -->\n\n{about}\n"
    );
    for experiment in experiments {
        add(&mut text, experiment);
    }
    text
}

/// Table, record, and the lists below it.
fn add(text: &mut String, experiment: &Experiment) {
    let former = if experiment.former { " (former)" } else { "" };
    let _infallible = write!(text, "\n## {}{former}\n\n{HEAD}", experiment.title);
    for row in cells::rows(experiment) {
        let _infallible = writeln!(text, "| {} |", row.join(" | "));
    }
    let _infallible = writeln!(text, "\n{}", record(&experiment.record));
    list(text, "Missed", &experiment.misses);
    list(text, "Tried without gain", &experiment.tried);
    list(text, "Notes", &experiment.notes);
}

/// Date, machine and load.
fn record(record: &Record) -> String {
    let Record { measured_on, printed_on, commit, machine, load } = record;
    format!(
        "Measured on: {measured_on}. First printed: {printed_on}. Commit: {commit}. Machine: {machine}. Load: {load}."
    )
}

fn list(text: &mut String, name: &str, items: &[String]) {
    if items.is_empty() {
        return;
    }
    let _infallible = writeln!(text, "\n{name}:\n");
    for item in items {
        let _infallible = writeln!(text, "* {item}");
    }
}
