//! How late a ring is: from the moment at which a timer was due until what waited for it has run.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

/// Width of a step, microseconds.
const STEP_US: u64 = 20;
/// Steps: up to 40 ms; what is later is in the last one.
const STEPS: usize = 2_000;

struct Counts {
    steps: [AtomicU32; STEPS],
    longest_us: AtomicU64,
}

/// Counts of one ring, shared with who reads them; nothing is allocated while it counts.
#[derive(Clone)]
pub struct Lateness(Arc<Counts>);

/// What was counted so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LatenessFigures {
    /// Rounds of the ring that a timer began.
    pub rounds: u64,
    /// Half of them were not later than this, microseconds, to 20 µs.
    pub median_us: u64,
    /// 99.9 % of them were not later than this, microseconds, to 20 µs; 40,000 stands for more.
    pub permille_999_us: u64,
    /// The latest one, microseconds.
    pub longest_us: u64,
}

impl Default for Lateness {
    fn default() -> Self {
        Self(Arc::new(Counts { steps: [const { AtomicU32::new(0) }; STEPS], longest_us: AtomicU64::new(0) }))
    }
}

impl fmt::Debug for Lateness {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.figures().fmt(out)
    }
}

impl Lateness {
    /// Counts a round, which ended so late, microseconds.
    pub fn note(&self, late_us: u64) {
        let step = usize::try_from(late_us / STEP_US).unwrap_or(STEPS).min(STEPS - 1);
        if let Some(count) = self.0.steps.get(step) {
            count.fetch_add(1, Ordering::Relaxed);
        }
        self.0.longest_us.fetch_max(late_us, Ordering::Relaxed);
    }

    /// What was counted so far.
    #[must_use]
    pub fn figures(&self) -> LatenessFigures {
        let counts: Vec<u64> = self.0.steps.iter().map(|step| step.load(Ordering::Relaxed).into()).collect();
        let rounds: u64 = counts.iter().sum();
        let longest_us = self.0.longest_us.load(Ordering::Relaxed);
        let permille = |permille: u64| {
            let wanted = (rounds * permille).div_ceil(1_000).max(1);
            let mut below = 0;
            let step = counts.iter().position(|count| {
                below += count;
                below >= wanted
            });
            step.map_or(0, |step| ((step as u64 + 1) * STEP_US).min(longest_us))
        };
        LatenessFigures { rounds, median_us: permille(500), permille_999_us: permille(999), longest_us }
    }
}

impl fmt::Display for LatenessFigures {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |us: u64| us as f64 * 1.0e-3;
        write!(
            out,
            "{:.2} ms late in the middle, {:.2} ms in 99.9 % of {} timers, {:.2} ms at most",
            ms(self.median_us),
            ms(self.permille_999_us),
            self.rounds,
            ms(self.longest_us)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_a_known_list() {
        let lateness = Lateness::default();
        assert_eq!(lateness.figures(), LatenessFigures::default());
        // 1 to 2,000 µs, and one that is later than all steps.
        (1..2_000).for_each(|late_us| lateness.note(late_us));
        lateness.note(70_000);
        let figures = lateness.figures();
        assert_eq!((figures.rounds, figures.longest_us), (2_000, 70_000));
        assert!((1_000..=1_020).contains(&figures.median_us), "{figures:?}");
        assert!((1_998..=2_018).contains(&figures.permille_999_us), "{figures:?}");
    }
}
