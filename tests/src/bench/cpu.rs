//! Time that this thread has really been computing: on a machine that others use, the wall clock tells how busy they are.

use std::sync::LazyLock;
use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};

/// What one call took, by both clocks, nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Took {
    /// By the wall clock.
    pub wall_ns: f64,
    /// What this thread computed meanwhile, less what asking for it costs.
    pub cpu_ns: f64,
}

impl Took {
    /// The median by each clock; NaN without any.
    #[must_use]
    pub fn median(times: &[Self]) -> Self {
        let of = |clock: fn(&Self) -> f64| super::median(times.iter().map(clock).collect());
        Self { wall_ns: of(|took| took.wall_ns), cpu_ns: of(|took| took.cpu_ns) }
    }

    /// The shortest by each clock.
    #[must_use]
    pub fn fastest(times: &[Self]) -> Self {
        let of = |clock: fn(&Self) -> f64| times.iter().map(clock).fold(f64::INFINITY, f64::min);
        Self { wall_ns: of(|took| took.wall_ns), cpu_ns: of(|took| took.cpu_ns) }
    }
}

/// Times one call.
pub fn took(work: impl FnMut()) -> Took {
    let took = with_asking(work);
    Took { cpu_ns: (took.cpu_ns - *ASKING_NS).max(0.0), ..took }
}

/// What the processor's clock shows for no work at all, nanoseconds: some tenths of a microsecond.
static ASKING_NS: LazyLock<f64> = LazyLock::new(|| {
    let asked: Vec<Took> = (0..1000).map(|_| with_asking(|| ())).collect();
    Took::fastest(&asked).cpu_ns
});

fn with_asking(mut work: impl FnMut()) -> Took {
    let watch = Stopwatch::begin();
    let start = Instant::now();
    work();
    let wall = start.elapsed();
    Took { wall_ns: wall.as_nanos() as f64, cpu_ns: watch.elapsed().as_nanos() as f64 }
}

/// A stopwatch of the thread's own processor time.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    begun: Duration,
}

impl Stopwatch {
    /// From now on.
    #[must_use]
    pub fn begin() -> Self {
        Self { begun: computed() }
    }

    /// Computed since.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        computed().saturating_sub(self.begun)
    }
}

/// What this thread has computed since it began.
fn computed() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(u64::try_from(time.tv_sec).unwrap_or(0), u32::try_from(time.tv_nsec).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleeping_is_no_computing() {
        let slept = took(|| std::thread::sleep(Duration::from_millis(20)));
        assert!(slept.cpu_ns < slept.wall_ns, "{slept:?}");
        let both = [Took { wall_ns: 3.0, cpu_ns: 1.0 }, Took { wall_ns: 2.0, cpu_ns: 2.0 }];
        assert_eq!(Took::fastest(&both), Took { wall_ns: 2.0, cpu_ns: 1.0 });
    }
}
