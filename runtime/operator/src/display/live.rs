//! A progress bar with the live table under it; on anything but a terminal a line now and then.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::status::Status;

/// Fast enough to look alive, slow enough to read.
const REDRAW: Duration = Duration::from_millis(100);
/// Robot time between two lines when there is no terminal, seconds.
const LINE_EVERY_S: f64 = 20.0;

/// Shows the status while a run goes on.
pub struct LiveDisplay {
    bar: ProgressBar,
    terminal: bool,
    quiet: bool,
    drawn: Option<Instant>,
    next_line_s: f64,
}

impl LiveDisplay {
    /// For a run of `duration_s` of robot time; zero for an endless one. `quiet` shows nothing at all.
    #[must_use]
    pub fn new(duration_s: f64, quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal() && !quiet;
        let bar =
            if duration_s > 0.0 { ProgressBar::new(duration_s as u64) } else { ProgressBar::new_spinner() };
        bar.set_draw_target(if terminal {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        });
        let template = if duration_s > 0.0 {
            "  {bar:50} {pos}/{len} s of robot time, {elapsed} passed\n{msg}"
        } else {
            "  {spinner} {elapsed}\n{msg}"
        };
        // The templates are constants of this file; the default style is as good when indicatif changes its syntax.
        bar.set_style(ProgressStyle::with_template(template).unwrap_or(ProgressStyle::default_bar()));
        Self { bar, terminal, quiet, drawn: None, next_line_s: 0.0 }
    }

    /// It is time to show something: cheap to ask at every step.
    #[must_use]
    pub fn is_due(&self, elapsed_s: f64) -> bool {
        if self.terminal {
            self.drawn.is_none_or(|drawn| drawn.elapsed() >= REDRAW)
        } else {
            !self.quiet && elapsed_s >= self.next_line_s
        }
    }

    /// Shows a status.
    pub fn show(&mut self, status: &Status) {
        if self.terminal {
            self.drawn = Some(Instant::now());
            self.bar.set_position(status.elapsed_s as u64);
            self.bar.set_message(status.table(true));
        } else if !self.quiet {
            self.next_line_s = status.elapsed_s + LINE_EVERY_S;
            say!("{}", status.line());
        }
    }

    /// A persistent line above the bar; printed also when no status is shown.
    pub fn note(&self, line: &str) {
        if self.terminal {
            self.bar.println(line);
        } else {
            say!("{line}");
        }
    }

    /// Takes the bar away so that the summary starts on a clean line.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}
