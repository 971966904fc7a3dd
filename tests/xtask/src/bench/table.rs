//! Ours and theirs on the same inputs, as a table of ratios.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use anyhow::Result;
use serde::{Deserialize, Serialize};

/// What a measurement printed.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
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
    fastest_ns: Option<f64>,
    cpu_ns: Option<f64>,
    fastest_cpu_ns: Option<f64>,
    /// The ratio that was asked for.
    aim: Option<f64>,
    skipped: Option<String>,
}

impl Told {
    /// One object a line; some peers print lines of their own between them.
    pub fn read(text: &str) -> Result<Vec<Self>> {
        let objects = text.lines().filter(|line| line.starts_with('{'));
        objects.map(|line| Ok(serde_json::from_str(line)?)).collect()
    }

    fn times(&self) -> Times {
        Times {
            fastest_ns: self.fastest_ns.or(self.ns),
            median_ns: self.ns,
            fastest_cpu_ns: self.fastest_cpu_ns.or(self.cpu_ns),
            median_cpu_ns: self.cpu_ns,
        }
    }
}

/// What a task took, by the wall clock and by the processor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    fastest_ns: Option<f64>,
    median_ns: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fastest_cpu_ns: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    median_cpu_ns: Option<f64>,
}

/// A line of the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    task: String,
    #[serde(default)]
    input: String,
    /// None: the peer is absent.
    ours: Option<Times>,
    #[serde(default)]
    note: String,
    /// None: nothing does the same.
    peer: Option<String>,
    peer_times: Option<Times>,
    #[serde(default)]
    peer_note: String,
    /// Why the peer is absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    absent: Option<String>,
    /// The ratio that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    aim: Option<f64>,
    /// What an old table printed, of which only rounded times are kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    printed: Option<Ratios>,
}

/// How many times longer the peer takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Ratios {
    /// Of the fastest rounds, by the wall clock.
    fastest: f64,
    medians: f64,
    /// Of the fastest rounds, by the processor; none where it was not counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    computed: Option<f64>,
}

/// Ours before and after the peers: the fastest of both, and the mean of both medians.
fn both(first: Times, second: Option<Times>) -> Times {
    let Some(second) = second else { return first };
    let least = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::min);
    let mean = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => Some(0.5 * (a + b)),
        (a, b) => a.or(b),
    };
    Times {
        fastest_ns: least(first.fastest_ns, second.fastest_ns),
        median_ns: mean(first.median_ns, second.median_ns),
        fastest_cpu_ns: least(first.fastest_cpu_ns, second.fastest_cpu_ns),
        median_cpu_ns: mean(first.median_cpu_ns, second.median_cpu_ns),
    }
}

impl Line {
    /// Every task and input of ours with every peer that did the same; peers that were skipped follow without times.
    pub fn join(ours: &[Vec<Told>; 2], peers: &[Told]) -> Vec<Self> {
        let [first, second] = ours;
        let mut lines = Vec::new();
        for told in first {
            let same = |other: &&Told| other.task == told.task && other.input == told.input;
            let times = both(told.times(), second.iter().find(same).map(Told::times));
            let line = |peer: Option<&Told>| Self {
                task: told.task.clone(),
                input: told.input.clone(),
                ours: Some(times),
                note: told.note.clone(),
                peer: peer.map(|peer| format!("{} {}", peer.peer, peer.version).trim().to_owned()),
                peer_times: peer.map(Told::times),
                peer_note: peer.map(|peer| peer.note.clone()).unwrap_or_default(),
                absent: None,
                aim: peer.and_then(|peer| peer.aim),
                printed: None,
            };
            let matching: Vec<&Told> = peers.iter().filter(same).filter(|told| told.ns.is_some()).collect();
            if matching.is_empty() {
                lines.push(line(None));
            }
            lines.extend(matching.into_iter().map(|peer| line(Some(peer))));
        }
        let absent = peers.iter().filter(|told| told.skipped.is_some()).map(|told| Self {
            task: told.task.clone(),
            input: told.input.clone(),
            ours: None,
            note: String::new(),
            peer: Some(told.peer.clone()),
            peer_times: None,
            peer_note: String::new(),
            absent: told.skipped.clone(),
            aim: None,
            printed: None,
        });
        lines.extend(absent);
        lines
    }

    fn ratios(&self) -> Option<Ratios> {
        if self.printed.is_some() {
            return self.printed;
        }
        let (ours, peer) = (self.ours?, self.peer_times?);
        let of = |peer: Option<f64>, ours: Option<f64>| Some(peer? / ours?);
        Some(Ratios {
            fastest: of(peer.fastest_ns, ours.fastest_ns)?,
            medians: of(peer.median_ns, ours.median_ns)?,
            computed: of(peer.fastest_cpu_ns, ours.fastest_cpu_ns),
        })
    }

    /// The cells of the table.
    fn cells(&self) -> [String; 10] {
        let none = || String::from("–");
        let time = |ns: Option<f64>| ns.map_or_else(none, shown);
        let ratios = self.ratios();
        let ratio = |of: fn(&Ratios) -> Option<f64>| {
            ratios.as_ref().and_then(of).map_or_else(none, |ratio| format!("{ratio:.1}"))
        };
        let notes = [self.note.as_str(), self.peer_note.as_str(), self.absent.as_deref().unwrap_or_default()];
        let notes: Vec<&str> = notes.into_iter().filter(|note| !note.is_empty()).collect();
        [
            self.task.clone(),
            self.input.clone(),
            time(self.ours.and_then(|times| times.fastest_ns)),
            self.peer.clone().unwrap_or_else(none),
            time(self.peer_times.and_then(|times| times.fastest_ns)),
            format!("**{}**", ratio(|ratios| Some(ratios.fastest))),
            ratio(|ratios| ratios.computed),
            ratio(|ratios| Some(ratios.medians)),
            self.aim.map(|aim| aim.to_string()).unwrap_or_default(),
            notes.join("; peer: "),
        ]
    }
}

fn shown(ns: f64) -> String {
    match ns {
        ns if ns < 1.0e4 => format!("{:.2} µs", ns / 1.0e3),
        ns if ns < 1.0e6 => format!("{:.0} µs", ns / 1.0e3),
        ns => format!("{:.2} ms", ns / 1.0e6),
    }
}

/// The table, with the machine in front.
pub fn markdown(lines: &[Line], machine: &str) -> String {
    let mut text = format!(
        "Measured: {machine}. Fastest rounds of both, ours and theirs in turn, task by task; beside it the ratio of what the \
         processor computed in the fastest rounds, and that of the medians.\n\n"
    );
    text.push_str(
        "| task | input | floorguard | peer | peer's time | ratio | of processor time | of medians | aim | notes |\n",
    );
    text.push_str("|---|---|---:|---|---:|---:|---:|---:|---:|---|\n");
    for line in lines {
        let _infallible = writeln!(text, "| {} |", line.cells().join(" | "));
    }
    text
}

/// The peer of each task that comes nearest to ours, with the smallest and the largest ratio over the inputs.
pub fn best_peers(lines: &[Line]) -> String {
    let mut tasks = BTreeMap::<&str, BTreeMap<&str, (f64, f64)>>::new();
    for line in lines {
        if let (Some(peer), Some(ratios)) = (&line.peer, line.ratios()) {
            let ratio = ratios.computed.unwrap_or(ratios.fastest).min(ratios.fastest);
            let (least, most) =
                tasks.entry(&line.task).or_default().entry(peer).or_insert((f64::INFINITY, 0.0));
            (*least, *most) = (least.min(ratio), most.max(ratio));
        }
    }
    let mut text =
        String::from("| task | the best peer | it takes so many times as long |\n|---|---|---:|\n");
    for (task, peers) in &tasks {
        let best = peers.iter().min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
        if let Some((peer, (least, most))) = best {
            let range = format!("{least:.1}–{most:.1}");
            let alone = format!("{least:.1}");
            let range = if format!("{most:.1}") == alone { alone } else { range };
            let _infallible = writeln!(text, "| {task} | {peer} | {range} |");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &str) -> Vec<Told> {
        Told::read(text).expect("lines of JSON")
    }

    fn example() -> Vec<Line> {
        let ours = |fastest: u32| {
            told(&format!(
                r#"{{"task":"t","peer":"floorguard","input":"a","ns":300,"fastest_ns":{fastest},"cpu_ns":290,"fastest_cpu_ns":100}}"#
            ))
        };
        let theirs = told(
            "a word of the peer\n{\"task\":\"t\",\"peer\":\"P\",\"version\":\"2\",\"input\":\"a\",\"ns\":9000,\"fastest_ns\":4000,\
             \"cpu_ns\":3500,\"fastest_cpu_ns\":3000,\"aim\":20}\n\
             {\"task\":\"t\",\"peer\":\"R\",\"input\":\"a\",\"ns\":90000,\"fastest_ns\":50000}\n\
             {\"task\":\"t\",\"peer\":\"Q\",\"skipped\":\"absent: pip install q\"}\n",
        );
        Line::join(&[ours(200), ours(100)], &theirs)
    }

    #[test]
    fn fastest_rounds_are_compared_by_both_clocks_and_an_absent_peer_has_its_line() {
        let lines = example();
        assert_eq!(lines.len(), 3);
        let table = markdown(&lines, "a machine");
        assert!(table.contains("| P 2 | 4.00 µs | **40.0** | 30.0 | 30.0 | 20 |"), "{table}");
        assert!(table.contains("| R | 50.00 µs | **500.0** | – | 300.0 |"), "no processor time: {table}");
        assert!(table.contains("| Q | – | **–** |") && table.contains("absent: pip install q"), "{table}");
        let kept = serde_json::to_string(&lines).expect("JSON");
        assert_eq!(serde_json::from_str::<Vec<Line>>(&kept).expect("JSON"), lines);
    }

    #[test]
    fn the_best_peer_is_the_one_nearest_to_ours_by_the_stricter_clock() {
        let best = best_peers(&example());
        assert!(best.ends_with("| t | P 2 | 30.0 |\n"), "{best}");
    }
}
