//! The machine that measures: what it is, and whether others work on it.

use std::time::Duration;

use serde::{Deserialize, Serialize};

/// Pauses after the build until the load has fallen, and how long each is.
const PAUSES: usize = 30;
const PAUSE: Duration = Duration::from_secs(10);

/// What stands beside every figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Year, month and day of the measurement; of an old table that of its record.
    pub date: String,
    pub processor: String,
    /// Cores that we may use.
    pub cores: usize,
    /// The largest mean over a minute of the processes that wanted a core, while it was measured; none where it was not
    /// recorded.
    pub load: Option<f64>,
    /// Who measured, if it was not this command.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured_by: Option<String>,
}

impl Machine {
    /// This one, now.
    pub fn here() -> Self {
        let processor = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let name = processor.lines().find(|line| line.starts_with("model name"));
        let name = name.and_then(|line| line.split(": ").nth(1)).unwrap_or("unknown processor").to_owned();
        let date = crate::shell::output(std::process::Command::new("date").arg("+%Y-%m-%d"));
        Self {
            date: date.unwrap_or_default().trim().to_owned(),
            processor: name,
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            load: load(),
            measured_by: None,
        }
    }

    /// Notes the load once more, and keeps the larger one.
    pub fn note_load(&mut self) {
        self.load = self.load.into_iter().chain(load()).reduce(f64::max);
    }

    /// Waits until the load that the build has made is gone, at most five minutes, and begins to note the load.
    pub fn settle(&mut self) {
        let quiet = 0.75 * self.cores as f64;
        for _ in 0..PAUSES {
            if load().is_none_or(|load| load <= quiet) {
                break;
            }
            std::thread::sleep(PAUSE);
        }
        self.load = load();
    }

    /// More processes want a core than there are cores.
    pub fn is_busy(&self) -> bool {
        self.load.is_some_and(|load| load > self.cores as f64)
    }

    /// Why the table is not written on this machine now.
    pub fn refusal(&self) -> Option<String> {
        let load = self.load.filter(|_| self.is_busy())?;
        Some(format!(
            "BENCHMARKS.md stays as it is: the load is {load:.2} on {} cores, and the table is written on a quiet machine \
             only. `--task NAME` measures one task at any load and writes nothing.",
            self.cores
        ))
    }

    /// In words.
    pub fn words(&self) -> String {
        let Self { date, processor, cores, load, measured_by } = self;
        let load = load.map_or_else(|| "load not recorded".to_owned(), |load| format!("load {load:.2}"));
        let by = measured_by.as_ref().map_or_else(String::new, |by| format!("{by}, "));
        format!("{by}{date}, {processor}, {cores} cores, {load}, one thread each")
    }
}

/// The mean over the last minute.
fn load() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split(' ').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::Machine;

    #[test]
    fn a_busy_machine_is_refused() {
        let machine = |load| Machine {
            date: String::new(),
            processor: String::from("P"),
            cores: 2,
            load: Some(load),
            measured_by: None,
        };
        assert_eq!(machine(2.0).refusal(), None);
        let refusal = machine(2.01).refusal().expect("too busy");
        assert!(refusal.contains("the load is 2.01 on 2 cores"), "{refusal}");
        assert!(Machine::here().cores > 0);
    }
}
