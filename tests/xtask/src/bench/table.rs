//! The tables of ratios: every peer for BENCHMARKS.md, the best one of each task for the README.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::history::Measurement;
use super::line::{Line, Ratios};

const HEAD: &str = "| task | input | floorguard | peer | peer's time | ratio | by the wall clock | of medians | aim | notes |\n\
    |---|---|---:|---|---:|---:|---:|---:|---:|---|\n";

/// The cells of a line.
fn cells(line: &Line) -> [String; 10] {
    let none = || String::from("–");
    let time = |ns: Option<f64>| ns.map_or_else(none, shown);
    let ratios = line.ratios();
    let ratio = |of: fn(&Ratios) -> Option<f64>| {
        ratios.as_ref().and_then(of).map_or_else(none, |ratio| format!("{ratio:.1}"))
    };
    let computed = ratio(|ratios| ratios.computed);
    let peer_note = line.absent.as_deref().unwrap_or(&line.peer_note);
    let notes = [line.note.as_str(), peer_note].into_iter().filter(|note| !note.is_empty());
    [
        line.task.clone(),
        line.input.clone(),
        time(line.ours.and_then(|times| times.fastest_ns())),
        line.peer.clone().unwrap_or_else(none),
        time(line.peer_times.and_then(|times| times.fastest_ns())),
        if computed == none() { computed } else { format!("**{computed}**") },
        ratio(|ratios| Some(ratios.fastest)),
        ratio(|ratios| ratios.medians),
        line.aim.map(|aim| aim.to_string()).unwrap_or_default(),
        notes.collect::<Vec<_>>().join("; peer: "),
    ]
}

fn shown(ns: f64) -> String {
    match ns {
        ns if ns < 1.0e4 => format!("{:.2} µs", ns / 1.0e3),
        ns if ns < 1.0e6 => format!("{:.0} µs", ns / 1.0e3),
        ns => format!("{:.2} ms", ns / 1.0e6),
    }
}

/// The table of one measurement, with the machine in front.
pub fn markdown(measurement: &Measurement) -> String {
    let mut text = format!("Measured: {}.\n\n{HEAD}", measurement.machine.words());
    for line in &measurement.lines {
        let _infallible = writeln!(text, "| {} |", cells(line).join(" | "));
    }
    text
}

/// The last table with times. A table from a busy machine is preceded by what is known of quiet ones.
pub fn for_benchmarks(all: &[Measurement]) -> Option<String> {
    let has_times = |one: &&Measurement| one.lines.iter().any(|line| line.ours.is_some());
    let last = all.iter().rev().find(has_times)?;
    let mut text = String::new();
    if last.machine.is_busy() {
        text.push_str("**The table below was measured on a busy machine, which overstates its ratios**, and without counting \
            processor time. Ratios on a quiet machine are lower:\n\n");
        if let Some(quiet) = all.iter().rev().find(|one| !one.machine.is_busy()) {
            let _infallible =
                writeln!(text, "{}\nMeasured: {}.\n", ratios(&quiet.lines), quiet.machine.words());
        }
    }
    text.push_str(&markdown(last));
    Some(text)
}

/// The best peer of each task, from the last measurement on a quiet machine, or else from the last one.
pub fn for_readme(all: &[Measurement]) -> Option<String> {
    let quiet = all.iter().rev().find(|one| !one.machine.is_busy()).or(all.last())?;
    let warning =
        if quiet.machine.is_busy() { " The machine was busy, which overstates the ratios." } else { "" };
    Some(format!("{}\nMeasured: {}.{warning}\n", best_peers(&quiet.lines), quiet.machine.words()))
}

/// Smallest and largest ratio over the inputs of a task.
#[derive(Clone, Copy)]
struct Range {
    least: f64,
    most: f64,
}

impl Range {
    fn words(self) -> String {
        let rounded = |ratio: f64| if ratio < 20.0 { format!("{ratio:.1}") } else { format!("{ratio:.0}") };
        let (least, most) = (rounded(self.least), rounded(self.most));
        if least == most { least } else { format!("{least} to {most}") }
    }
}

/// Tasks, their peers, and the ratios of each.
fn ranges(lines: &[Line]) -> BTreeMap<&str, BTreeMap<&str, Range>> {
    let mut tasks = BTreeMap::<&str, BTreeMap<&str, Range>>::new();
    for line in lines {
        let (Some(peer), Some(ratios)) = (&line.peer, line.ratios()) else { continue };
        let ratio = ratios.best_known();
        let range =
            tasks.entry(&line.task).or_default().entry(peer).or_insert(Range { least: ratio, most: ratio });
        *range = Range { least: range.least.min(ratio), most: range.most.max(ratio) };
    }
    tasks
}

/// All peers of which ratios are known.
fn ratios(lines: &[Line]) -> String {
    let mut text = String::from("| task | peer | it takes so many times as long |\n|---|---|---:|\n");
    for (task, peers) in ranges(lines) {
        for (peer, range) in peers {
            let _infallible = writeln!(text, "| {task} | {peer} | {} |", range.words());
        }
    }
    text
}

/// The peer of each task that comes nearest to ours.
fn best_peers(lines: &[Line]) -> String {
    let mut text =
        String::from("| task | the best peer | it takes so many times as long |\n|---|---|---:|\n");
    for (task, peers) in ranges(lines) {
        let best = peers.iter().min_by(|(_, one), (_, other)| one.least.total_cmp(&other.least));
        if let Some((peer, range)) = best {
            let _infallible = writeln!(text, "| {task} | {peer} | {} |", range.words());
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::line::Reported;
    use crate::bench::machine::Machine;

    fn reported(text: &str) -> Vec<Reported> {
        Reported::read(text).expect("lines of JSON")
    }

    fn example(load: f64) -> Measurement {
        let ours = |fastest: u32| {
            reported(&format!(
                r#"{{"task":"t","peer":"floorguard","input":"a","ns":300,"fastest_ns":{fastest},"cpu_ns":290,"fastest_cpu_ns":100}}"#
            ))
        };
        let theirs = reported(
            "a word of the peer\n{\"task\":\"t\",\"peer\":\"P\",\"version\":\"2\",\"input\":\"a\",\"ns\":9000,\"fastest_ns\":4000,\
             \"cpu_ns\":3500,\"fastest_cpu_ns\":3000,\"aim\":20}\n\
             {\"task\":\"t\",\"peer\":\"R\",\"input\":\"a\",\"ns\":90000,\"fastest_ns\":50000}\n\
             {\"task\":\"t\",\"peer\":\"Q\",\"skipped\":\"absent: pip install q\"}\n",
        );
        let machine = Machine {
            date: "2026-01-02".to_owned(),
            processor: "P".to_owned(),
            cores: 2,
            load: Some(load),
            measured_by: None,
        };
        Measurement { machine, lines: Line::join(&[ours(200), ours(100)], &theirs) }
    }

    #[test]
    fn ratios_are_of_processor_time() {
        let measurement = example(1.0);
        assert_eq!(measurement.lines.len(), 3);
        let table = markdown(&measurement);
        assert!(table.contains("| P 2 | 3.00 µs | **30.0** | 40.0 | 30.0 | 20 |"), "{table}");
        assert!(table.contains("| R | 50 µs | – | 500.0 | 300.0 |"), "no processor time: {table}");
        assert!(table.contains("| Q | – | – | – |") && table.contains("absent: pip install q"), "{table}");
        let kept = serde_json::to_string(&measurement.lines).expect("JSON");
        assert_eq!(serde_json::from_str::<Vec<Line>>(&kept).expect("JSON"), measurement.lines);
    }

    #[test]
    fn the_nearest_peer_is_the_best() {
        let best = for_readme(&[example(1.0)]).expect("a table");
        assert!(best.contains("| t | P 2 | 30 |\n") && !best.contains("busy"), "{best}");
        assert!(best.contains("2026-01-02, P, 2 cores, load 1.00"), "{best}");
    }

    #[test]
    fn a_busy_table_is_marked() {
        let all = [example(1.0), example(24.0)];
        let text = for_benchmarks(&all).expect("a table");
        assert!(
            text.contains("overstates") && text.contains("load 1.00") && text.contains("load 24.00"),
            "{text}"
        );
        assert!(for_readme(&all).expect("a table").contains("load 1.00"));
        assert!(for_readme(&all[1..]).expect("a table").contains("overstates"));
    }
}
