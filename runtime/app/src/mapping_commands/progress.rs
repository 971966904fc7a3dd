//! How far a command is: a bar in a terminal, a line now and then elsewhere.

use std::cell::Cell;
use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Without a terminal the progress is printed this often.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Counts scans.
pub struct Progress {
    bar: Option<ProgressBar>,
    all: u64,
    done: Cell<u64>,
    began: Instant,
    printed: Cell<Duration>,
}

impl Progress {
    /// Of so many scans.
    pub fn new(all: u64) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            ProgressBar::new(all).with_style(
                ProgressStyle::with_template("{bar:40} {pos}/{len} scans, {eta} left {msg}")
                    .unwrap_or_else(|_| ProgressStyle::default_bar()),
            )
        });
        Self { bar, all, done: Cell::new(0), began: Instant::now(), printed: Cell::default() }
    }

    /// A scan more.
    pub fn count(&self) {
        self.done.set(self.done.get() + 1);
        match &self.bar {
            Some(bar) => bar.inc(1),
            None if self.began.elapsed() >= self.printed.get() + LINE_EVERY => {
                self.printed.set(self.began.elapsed());
                say!(
                    "  {:.0} s: {} of {} scans",
                    self.began.elapsed().as_secs_f64(),
                    self.done.get(),
                    self.all
                );
            }
            None => {}
        }
    }

    /// What is done after the scans.
    pub fn phase(&self, what: &str) {
        if let Some(bar) = &self.bar {
            bar.set_message(what.to_owned());
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
