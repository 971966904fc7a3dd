//! Compares a reset before and after a decision: what came of it, and in words.

use core::fmt;

use super::machine::DecisionMachine;
use super::supervisor::Supervisor;
use crate::protection::{Health, ResetRefusal, ResetReport, Source};
use floorguard_types::time::Stamp;

impl Supervisor {
    /// What came of the operator's resets.
    #[must_use]
    pub const fn resets(&self) -> ResetReport {
        self.resets
    }

    /// After a decision: what came of a reset that was in progress before it.
    pub(super) fn note_reset(&mut self, before: &ResetProgress, standing: bool, now: Stamp) {
        let after = ResetProgress::of(&self.state.machine);
        if !before.is_under_way || after.is_under_way {
            return;
        }
        self.resets.answered_at = now;
        if after.granted == before.granted {
            self.resets.refused = self.resets.refused.saturating_add(1);
            self.resets.refusal = self.refusal(standing, now);
        } else {
            self.resets.granted = self.resets.granted.saturating_add(1);
            self.resets.refusal = None;
            self.memory.on_reset(now);
        }
    }

    fn refusal(&self, standing: bool, now: Stamp) -> Option<ResetRefusal> {
        let present = self.state.machine.present_latch(now).map(ResetRefusal::Present);
        let unfit = || {
            let watched = self.config.sources.iter().zip(&self.state.monitors);
            let mut judged = Source::ALL.into_iter().zip(watched);
            judged.find_map(|(source, (rules, monitor))| {
                let health = monitor.health(rules, now);
                let is_needed = rules.fitted && rules.required_at_start;
                (is_needed && health != Health::Healthy).then_some(ResetRefusal::NotHealthy(source, health))
            })
        };
        present.or_else(unfit).or((!standing).then_some(ResetRefusal::Moving))
    }
}

/// How far a reset is, before or after a decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ResetProgress {
    is_under_way: bool,
    granted: u32,
}

impl ResetProgress {
    pub(super) const fn of(machine: &DecisionMachine) -> Self {
        Self { is_under_way: machine.reset_since.is_some(), granted: machine.resets }
    }
}

impl fmt::Display for ResetRefusal {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Present(cause) => write!(out, "{cause}: it is still there"),
            Self::NotHealthy(source, health) => write!(out, "{} is {health}", source.name()),
            Self::Moving => out.write_str("the robot still moves"),
        }
    }
}
