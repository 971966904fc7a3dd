//! Ours and theirs on the same inputs, as a table of ratios.

use std::fmt::Write as _;

use anyhow::Result;
use serde::Deserialize;

/// A line that a measurement printed.
#[derive(Clone, Debug, Deserialize)]
pub struct Told {
    task: String,
    peer: String,
    #[serde(default)]
    input: String,
    #[serde(default)]
    version: String,
    #[serde(default)]
    note: String,
    ns: Option<f64>,
    skipped: Option<String>,
}

impl Told {
    /// One object a line; some peers print lines of their own between them.
    pub fn read(text: &str) -> Result<Vec<Self>> {
        text.lines()
            .filter(|line| line.starts_with('{'))
            .map(|line| Ok(serde_json::from_str(line)?))
            .collect()
    }
}

/// A line of the table.
#[derive(Clone, Debug)]
pub struct Row {
    ours: Told,
    /// The mean of our measurements before and after, nanoseconds.
    ours_ns: f64,
    /// None: nothing of the registry does the same.
    peer: Option<Told>,
}

impl Row {
    /// Every task and input of ours with every peer that did the same; peers that were skipped follow without times.
    pub fn join(ours: &[Vec<Told>; 2], peers: &[Told]) -> Vec<Self> {
        let [first, second] = ours;
        let mut rows = Vec::new();
        for told in first {
            let same = |other: &&Told| other.task == told.task && other.input == told.input;
            let times: Vec<f64> =
                std::iter::once(told).chain(second.iter().find(same)).filter_map(|told| told.ns).collect();
            let ours_ns = times.iter().sum::<f64>() / times.len().max(1) as f64;
            let row = |peer| Self { ours: told.clone(), ours_ns, peer };
            let matching: Vec<&Told> = peers.iter().filter(same).collect();
            if matching.is_empty() {
                rows.push(row(None));
            }
            rows.extend(matching.into_iter().map(|peer| row(Some(peer.clone()))));
        }
        for told in peers.iter().filter(|told| told.skipped.is_some()) {
            rows.push(Self { ours: told.clone(), ours_ns: f64::NAN, peer: Some(told.clone()) });
        }
        rows
    }
}

fn shown(ns: f64) -> String {
    match ns {
        ns if ns.is_nan() => "–".to_owned(),
        ns if ns < 1.0e4 => format!("{:.2} µs", ns / 1.0e3),
        ns if ns < 1.0e6 => format!("{:.0} µs", ns / 1.0e3),
        ns => format!("{:.2} ms", ns / 1.0e6),
    }
}

/// The table, with the machine in front.
pub fn markdown(rows: &[Row], machine: &str) -> String {
    let mut text = format!(
        "Machine: {machine}. Medians; ours is the mean of one run before and one after the peers.\n\n"
    );
    text.push_str("| task | input | floorguard | peer | peer's time | ratio | notes |\n|---|---|---:|---|---:|---:|---|\n");
    for row in rows {
        let (peer, time, ratio, note) = match &row.peer {
            None => ("–".to_owned(), "–".to_owned(), "–".to_owned(), String::new()),
            Some(Told { skipped: Some(why), peer, .. }) => {
                (peer.clone(), "–".to_owned(), "–".to_owned(), format!("skipped: {why}"))
            }
            Some(told) => {
                let ns = told.ns.unwrap_or(f64::NAN);
                let ratio = format!("**{:.1}**", ns / row.ours_ns);
                (format!("{} {}", told.peer, told.version), shown(ns), ratio, told.note.clone())
            }
        };
        let ours_note = if row.ours.skipped.is_some() { "" } else { &row.ours.note };
        let notes: Vec<&str> = [ours_note, &note].into_iter().filter(|note| !note.is_empty()).collect();
        let _infallible = writeln!(
            text,
            "| {} | {} | {} | {peer} | {time} | {ratio} | {} |",
            row.ours.task,
            row.ours.input,
            shown(row.ours_ns),
            notes.join("; peer: "),
        );
    }
    text
}
