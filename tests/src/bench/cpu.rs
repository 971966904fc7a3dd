//! Time that this thread has really been computing: on a machine that others use, the wall clock tells how busy they are.
//!
//! The kernel counts it in ticks of some milliseconds: good for what takes tens of them.

use std::time::{Duration, Instant};

/// A stopwatch of the thread's own processor time; of the wall clock where the system does not tell it.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    begun: Instant,
    begun_cpu: Option<Duration>,
}

impl Stopwatch {
    /// From now on.
    #[must_use]
    pub fn begin() -> Self {
        Self { begun: Instant::now(), begun_cpu: computed() }
    }

    /// Computed since.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        match (self.begun_cpu, computed()) {
            (Some(before), Some(now)) => now.saturating_sub(before),
            _ => self.begun.elapsed(),
        }
    }
}

/// Nanoseconds on a processor: the first number of the kernel's scheduler statistics.
fn computed() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(Duration::from_nanos(text.split(' ').next()?.parse().ok()?))
}
