//! Cells of a table: what a row does not have comes from its experiment, and what the row above shows is not repeated.

use super::schema::{Experiment, Figure, Met, NOT_RECORDED};

/// Stands where the row above has the same.
const AS_ABOVE: &str = "as above";
/// Stands where there is nothing to show.
pub const NONE: &str = "–";

/// What may be equal to the row above.
#[derive(Clone, PartialEq, Eq)]
struct Shared {
    data: String,
    seed: String,
    n: String,
    command: String,
}

/// The rows of an experiment's table, in the order of [`super::page`]'s columns.
pub fn rows(experiment: &Experiment) -> Vec<[String; 7]> {
    let mut above: Option<Shared> = None;
    let mut rows = Vec::new();
    for figure in &experiment.figures {
        let shared = shared(experiment, figure);
        let once = |of: fn(&Shared) -> &String| {
            let is_same = above.as_ref().is_some_and(|above| of(above) == of(&shared));
            if is_same { AS_ABOVE.to_owned() } else { of(&shared).clone() }
        };
        rows.push([
            figure.metric.clone(),
            data_and_seed(&once(|shared| &shared.data), &once(|shared| &shared.seed)),
            once(|shared| &shared.n),
            result(figure),
            figure.target.clone().unwrap_or_else(|| NONE.to_owned()),
            met(figure.met).to_owned(),
            once(|shared| &shared.command),
        ]);
        above = Some(shared);
    }
    rows
}

fn shared(experiment: &Experiment, figure: &Figure) -> Shared {
    let or = |own: &Option<String>, common: &String| own.as_ref().unwrap_or(common).clone();
    Shared {
        data: or(&figure.data, &experiment.data),
        seed: or(&figure.seed, &experiment.seed),
        n: or(&figure.n, &experiment.n),
        command: quoted(&or(&figure.command, &experiment.command)),
    }
}

fn data_and_seed(data: &str, seed: &str) -> String {
    match (data, seed) {
        (_, AS_ABOVE) => data.to_owned(),
        (_, NOT_RECORDED) => format!("{data}; seed not recorded"),
        _ => format!("{data}; seed: {seed}"),
    }
}

/// Commands stand between backquotes.
fn quoted(command: &str) -> String {
    if command == NOT_RECORDED || command == NONE { command.to_owned() } else { format!("`{command}`") }
}

pub fn result(figure: &Figure) -> String {
    match &figure.interval {
        Some(interval) => format!("{}; {interval}", figure.result),
        None => figure.result.clone(),
    }
}

fn met(met: Option<Met>) -> &'static str {
    match met {
        Some(Met::Yes) => "yes",
        Some(Met::No) => "**no**",
        None => NONE,
    }
}
