//! The overview: all pages, and every target that was missed.

use std::fmt::Write as _;

use super::cells;
use super::schema::{Experiment, Figure, Met, Subject};

const INTRODUCTION: &str = "# Measured figures

<!-- written by cargo xtask figures from docs/evidence/figures -->

One page for each subject. Each row of a table names the data and the seed, how many, the result with its interval where
there is one, the target, whether it was met, and the command that measures it again. Below each table stand the date, the
commit (of figures from before 23 November 2026 the one that first printed them), the machine and its load; what was not written down at the time is \"not recorded\".
Misses and what was tried without gain are lists below the table. Experiments marked \"former\" were replaced by a later one;
they stay on their page and are not counted here.

Times are medians of one core, unless a row says otherwise, and most were measured on a server that others used, too:
quote ratios, not these absolutes. An interval marked \"exact binomial\" was computed from the counts beside it (Clopper and
Pearson); all others were printed by the command.
";

/// The page.
pub fn text(subjects: &[Subject]) -> String {
    let mut text =
        format!("{INTRODUCTION}\n| page | figures | targets met | targets missed |\n|---|---:|---:|---:|\n");
    for subject in subjects {
        let with = |met: Met| figures(subject).filter(|figure| figure.met == Some(met)).count();
        let _infallible = writeln!(
            text,
            "| [{}](figures/{}.md) | {} | {} | {} |",
            subject.title,
            subject.name,
            figures(subject).count(),
            with(Met::Yes),
            with(Met::No)
        );
    }
    text.push_str(
        "\n## Missed targets\n\n| page | experiment | metric | result | target |\n|---|---|---|---|---|\n",
    );
    for subject in subjects {
        for experiment in current(subject) {
            for figure in experiment.figures.iter().filter(|figure| figure.met == Some(Met::No)) {
                let target = figure.target.as_deref().unwrap_or(cells::NONE);
                let row = [&subject.title, &experiment.title, &figure.metric, &cells::result(figure)];
                let row = row.map(String::as_str).join(" | ");
                let _infallible = writeln!(text, "| {row} | {target} |");
            }
        }
    }
    text
}

fn current(subject: &Subject) -> impl Iterator<Item = &Experiment> {
    subject.experiments.iter().filter(|experiment| !experiment.former)
}

fn figures(subject: &Subject) -> impl Iterator<Item = &Figure> {
    current(subject).flat_map(|experiment| &experiment.figures)
}
