//! Ours and theirs on the same inputs, as a table of ratios.

use std::fmt::Write as _;

use anyhow::Result;
use serde::Deserialize;

/// A line that a measurement printed.
#[derive(Clone, Debug, Deserialize)]
pub struct Reported {
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
    /// The ratio that was asked for.
    aim: Option<f64>,
    skipped: Option<String>,
}

impl Reported {
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
    ours: Reported,
    /// The fastest round of ours, before or after the peers; and the mean of both medians, nanoseconds.
    ours_ns: [f64; 2],
    /// None: nothing does the same.
    peer: Option<Reported>,
}

impl Row {
    /// Every task and input of ours with every peer that did the same; peers that were skipped follow without times.
    pub fn join(ours: &[Vec<Reported>; 2], peers: &[Reported]) -> Vec<Self> {
        let [first, second] = ours;
        let mut rows = Vec::new();
        for reported in first {
            let same = |other: &&Reported| other.task == reported.task && other.input == reported.input;
            let both = || std::iter::once(reported).chain(second.iter().find(same));
            let fastest = both().filter_map(Reported::fastest).fold(f64::NAN, f64::min);
            let medians: Vec<f64> = both().filter_map(|reported| reported.ns).collect();
            let ours_ns = [fastest, medians.iter().sum::<f64>() / medians.len().max(1) as f64];
            let row = |peer| Self { ours: reported.clone(), ours_ns, peer };
            let matching: Vec<&Reported> =
                peers.iter().filter(same).filter(|reported| reported.ns.is_some()).collect();
            if matching.is_empty() {
                rows.push(row(None));
            }
            rows.extend(matching.into_iter().map(|peer| row(Some(peer.clone()))));
        }
        for reported in peers.iter().filter(|reported| reported.skipped.is_some()) {
            rows.push(Self { ours: reported.clone(), ours_ns: [f64::NAN; 2], peer: Some(reported.clone()) });
        }
        rows
    }

    /// How many times longer the peer takes: by the fastest rounds, and by the medians.
    fn ratios(&self) -> Option<[f64; 2]> {
        let peer = self.peer.as_ref()?;
        let [fastest, median] = self.ours_ns;
        Some([peer.fastest()? / fastest, peer.ns? / median])
    }

    /// The same for programs.
    pub fn to_json(&self) -> serde_json::Value {
        let peer = self.peer.as_ref();
        let [fastest, median] = self.ours_ns.map(|ns| if ns.is_nan() { None } else { Some(ns) });
        serde_json::json!({
            "task": self.ours.task,
            "input": self.ours.input,
            "fastest_ns": fastest,
            "median_ns": median,
            "note": self.ours.note,
            "peer": peer.map(|peer| &peer.peer),
            "peer_version": peer.map(|peer| &peer.version),
            "peer_fastest_ns": peer.and_then(Reported::fastest),
            "peer_median_ns": peer.and_then(|peer| peer.ns),
            "peer_note": peer.map(|peer| &peer.note),
            "ratio": self.ratios().map(|[fastest, _]| fastest),
            "ratio_of_medians": self.ratios().map(|[_, median]| median),
            "aim": peer.and_then(|peer| peer.aim),
            "absent": peer.and_then(|peer| peer.skipped.as_ref()),
        })
    }
}

impl Reported {
    fn fastest(&self) -> Option<f64> {
        self.fastest_ns.or(self.ns)
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
        "Machine: {machine}. Fastest rounds of both, ours and theirs in turn, task by task; the ratio of the medians beside.\n\n"
    );
    text.push_str("| task | input | floorguard | peer | peer's time | ratio | aim | of medians | notes |\n");
    text.push_str("|---|---|---:|---|---:|---:|---:|---:|---|\n");
    for row in rows {
        let none = || "–".to_owned();
        let [fastest, _] = row.ours_ns;
        let (peer, time, note) = match &row.peer {
            None => (none(), none(), String::new()),
            Some(Reported { skipped: Some(why), peer, .. }) => (peer.clone(), none(), why.clone()),
            Some(reported) => {
                let name = format!("{} {}", reported.peer, reported.version);
                (name, shown(reported.fastest().unwrap_or(f64::NAN)), reported.note.clone())
            }
        };
        let [ratio, of_medians] = row.ratios().map_or([none(), none()], |[fastest, median]| {
            [format!("**{fastest:.1}**"), format!("{median:.1}")]
        });
        let aim =
            row.peer.as_ref().and_then(|peer| peer.aim).map_or_else(String::new, |aim| format!("{aim}"));
        let ours_note = if row.ours.skipped.is_some() { "" } else { &row.ours.note };
        let notes: Vec<&str> = [ours_note, &note].into_iter().filter(|note| !note.is_empty()).collect();
        let _infallible = writeln!(
            text,
            "| {} | {} | {} | {peer} | {time} | {ratio} | {aim} | {of_medians} | {} |",
            row.ours.task,
            row.ours.input,
            shown(fastest),
            notes.join("; peer: "),
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fastest_rounds_compare_absent_peers_listed() {
        let reported = |text: &str| Reported::read(text).expect("lines of JSON");
        let ours = |fastest: u32| {
            reported(&format!(
                r#"{{"task":"t","peer":"floorguard","input":"a","ns":300,"fastest_ns":{fastest}}}"#
            ))
        };
        let theirs = reported(
            "a word of the peer\n{\"task\":\"t\",\"peer\":\"P\",\"input\":\"a\",\"ns\":9000,\"fastest_ns\":4000,\"aim\":20}\n\
             {\"task\":\"t\",\"peer\":\"Q\",\"skipped\":\"absent: pip install q\"}\n",
        );
        let rows = Row::join(&[ours(200), ours(100)], &theirs);
        assert_eq!(rows.len(), 2);
        let first = rows[0].to_json();
        assert_eq!((first["ratio"].as_f64(), first["ratio_of_medians"].as_f64()), (Some(40.0), Some(30.0)));
        assert_eq!(rows[1].to_json()["absent"], "absent: pip install q");
        let table = markdown(&rows, "a machine");
        assert!(table.contains("| **40.0** | 20 | 30.0 |") && table.contains("| Q | – | – |"), "{table}");
        assert!(table.contains("absent: pip install q"), "{table}");
    }
}
