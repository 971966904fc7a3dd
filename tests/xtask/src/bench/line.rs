//! Ours and theirs on the same input: times and ratios.

use anyhow::Result;
use serde::{Deserialize, Serialize};

/// What a measurement printed.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
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
    cpu_ns: Option<f64>,
    fastest_cpu_ns: Option<f64>,
    /// The ratio that was asked for.
    aim: Option<f64>,
    skipped: Option<String>,
}

impl Reported {
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

impl Times {
    /// Of the fastest round: processor time where it was counted, wall-clock time otherwise.
    pub fn fastest_ns(&self) -> Option<f64> {
        self.fastest_cpu_ns.or(self.fastest_ns)
    }

    /// Ours before and after the peers: the fastest of both, and the mean of both medians.
    fn joined(self, second: Option<Self>) -> Self {
        let Some(second) = second else { return self };
        let least = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::min);
        let mean = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => Some(0.5 * (a + b)),
            (a, b) => a.or(b),
        };
        Self {
            fastest_ns: least(self.fastest_ns, second.fastest_ns),
            median_ns: mean(self.median_ns, second.median_ns),
            fastest_cpu_ns: least(self.fastest_cpu_ns, second.fastest_cpu_ns),
            median_cpu_ns: mean(self.median_cpu_ns, second.median_cpu_ns),
        }
    }
}

/// A line of the table.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Line {
    pub task: String,
    #[serde(default)]
    pub input: String,
    /// None: the peer is absent, or only ratios are known.
    pub ours: Option<Times>,
    #[serde(default)]
    pub note: String,
    /// None: nothing does the same.
    pub peer: Option<String>,
    pub peer_times: Option<Times>,
    #[serde(default)]
    pub peer_note: String,
    /// Why the peer is absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub absent: Option<String>,
    /// The ratio that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aim: Option<f64>,
    /// What an old table printed, of which only rounded times are kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    printed: Option<Ratios>,
}

/// How many times longer the peer takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ratios {
    /// Of the fastest rounds, by the processor; none where it was not counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub computed: Option<f64>,
    /// Of the fastest rounds, by the wall clock.
    pub fastest: f64,
    /// Of the medians, by the wall clock.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub medians: Option<f64>,
}

impl Ratios {
    /// By the processor; by the wall clock where nothing else was counted.
    pub fn best_known(&self) -> f64 {
        self.computed.unwrap_or(self.fastest)
    }
}

impl Line {
    /// Every task and input of ours with every peer that did the same; peers that were skipped follow without times.
    pub fn join(ours: &[Vec<Reported>; 2], peers: &[Reported]) -> Vec<Self> {
        let [first, second] = ours;
        let mut lines = Vec::new();
        for reported in first {
            let same = |other: &&Reported| other.task == reported.task && other.input == reported.input;
            let times = reported.times().joined(second.iter().find(same).map(Reported::times));
            let matching: Vec<&Reported> =
                peers.iter().filter(same).filter(|peer| peer.ns.is_some()).collect();
            if matching.is_empty() {
                lines.push(Self::beside(reported, times, None));
            }
            lines.extend(matching.into_iter().map(|peer| Self::beside(reported, times, Some(peer))));
        }
        let absent = peers.iter().filter(|peer| peer.skipped.is_some()).map(|peer| Self {
            task: peer.task.clone(),
            input: peer.input.clone(),
            peer: Some(peer.peer.clone()),
            absent: peer.skipped.clone(),
            ..Self::default()
        });
        lines.extend(absent);
        lines
    }

    fn beside(ours: &Reported, times: Times, peer: Option<&Reported>) -> Self {
        Self {
            task: ours.task.clone(),
            input: ours.input.clone(),
            ours: Some(times),
            note: ours.note.clone(),
            peer: peer.map(|peer| format!("{} {}", peer.peer, peer.version).trim().to_owned()),
            peer_times: peer.map(Reported::times),
            peer_note: peer.map(|peer| peer.note.clone()).unwrap_or_default(),
            aim: peer.and_then(|peer| peer.aim),
            ..Self::default()
        }
    }

    /// None where the peer is absent.
    pub fn ratios(&self) -> Option<Ratios> {
        if self.printed.is_some() {
            return self.printed;
        }
        let (ours, peer) = (self.ours?, self.peer_times?);
        let of = |peer: Option<f64>, ours: Option<f64>| Some(peer? / ours?);
        Some(Ratios {
            computed: of(peer.fastest_cpu_ns, ours.fastest_cpu_ns),
            fastest: of(peer.fastest_ns, ours.fastest_ns)?,
            medians: of(peer.median_ns, ours.median_ns),
        })
    }
}
