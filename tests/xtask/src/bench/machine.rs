//! The machine that measures: what it is, and whether anybody else works on it.

use anyhow::{Result, ensure};
use serde::{Deserialize, Serialize};

/// What stands beside every figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Year, month and day of the measurement; of an old table that of its record.
    pub date: String,
    /// Its processor.
    pub processor: String,
    /// Cores that we may use.
    pub cores: usize,
    /// The largest mean over a minute of the processes that wanted a core, while it was measured.
    pub load: f64,
}

impl Machine {
    /// This one, now.
    pub fn here() -> Self {
        let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
        let processor = read("/proc/cpuinfo");
        let name = processor.lines().find(|line| line.starts_with("model name"));
        let name = name.and_then(|line| line.split(": ").nth(1)).unwrap_or("unknown processor").to_owned();
        let date = crate::shell::output(std::process::Command::new("date").arg("+%Y-%m-%d"));
        Self {
            date: date.unwrap_or_default().trim().to_owned(),
            processor: name,
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            load: load(),
        }
    }

    /// Notes the load once more.
    pub fn look_again(&mut self) {
        self.load = self.load.max(load());
    }

    /// Others had to wait for a core, or we had to: what was measured is not to be told.
    pub fn is_busy(&self) -> bool {
        self.load > self.cores as f64
    }

    /// Refuses to measure for the table on a busy machine.
    ///
    /// # Errors
    /// More processes want a core than there are cores.
    pub fn need_quiet(&self) -> Result<()> {
        ensure!(
            !self.is_busy(),
            "the load is {:.2} on {} cores: the table is written on a quiet machine only; `--task NAME` measures one task and \
             writes nothing",
            self.load,
            self.cores
        );
        Ok(())
    }

    /// In words.
    pub fn words(&self) -> String {
        let Self { date, processor, cores, load } = self;
        format!("{date}, {processor}, {cores} cores, load {load:.2}, one thread each")
    }
}

/// The mean over the last minute.
fn load() -> f64 {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').next().and_then(|load| load.parse().ok()).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_busy_machine_is_refused() {
        let machine = |load| Machine { date: String::new(), processor: String::from("P"), cores: 2, load };
        assert!(machine(2.0).need_quiet().is_ok());
        let refused = machine(2.01).need_quiet().expect_err("too busy").to_string();
        assert!(refused.starts_with("the load is 2.01 on 2 cores"), "{refused}");
        assert!(Machine::here().cores > 0 && !Machine::here().load.is_nan());
    }
}
