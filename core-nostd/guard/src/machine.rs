//! The decision machine: which causes hold, and which one wins.
//!
//! Evidence arrives as pulses: [`DecisionMachine::raise`]. A cause holds from its first pulse until its rule lets it
//! go; no rule uses anything but the time since the last pulse and the operator's reset, so evidence that stops
//! arriving is not evidence of safety (its source will then raise its own cause).

use super::rules::Clear;
use crate::protection::{Action, Cause, CauseRecord, GuardState, HeldCauses};
use floorguard_types::number::truncating_u32;
use floorguard_types::time::{Age, Stamp};

/// Evidence younger than this counts as present: a reset is refused, microseconds (two periods of the slowest input).
pub const PRESENT_US: u64 = 200_000;
/// The self-test must hold this long before a reset is granted, microseconds.
pub const SELF_TEST_US: u64 = 300_000;

/// Which causes hold.
///
/// ```
/// use floorguard_guard::{Action, Cause, CauseRecord, DecisionMachine};
/// use floorguard_types::time::Stamp;
///
/// let now = Stamp::from_micros(1_000_000);
/// let mut machine = DecisionMachine::new(now);
/// machine.raise(CauseRecord::new(Cause::EmergencyStop, now));
/// let verdict = machine.settle(true, now);
/// assert_eq!(verdict.action, Action::Category0);
/// assert!(machine.holds(Cause::EmergencyStop));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecisionMachine {
    pub(super) held: HeldCauses,
    pub(super) first_stop: Option<CauseRecord>,
    pub(super) reset_since: Option<Stamp>,
    pub(super) resets: u32,
}

/// What follows from the causes that hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// The most severe demand.
    pub action: Action,
    /// State to show.
    pub state: GuardState,
    /// Least speed limit of the causes that hold, m/s; infinite when none limits.
    pub limit_mps: f32,
    /// First cause of this stop; without a stop the cause with the least limit.
    pub primary: Option<CauseRecord>,
    /// What holds the robot now: a pressed emergency stop, or of the causes with the most severe demand one that is still
    /// there, with the newest evidence; without a stop as [`Self::primary`] (FG-REQ-071).
    pub holding: Option<CauseRecord>,
}

impl DecisionMachine {
    /// Nothing holds.
    pub(super) const IDLE: Self =
        Self { held: HeldCauses::new(), first_stop: None, reset_since: None, resets: 0 };

    /// Nothing holds but the start-up check, and nobody has given the start command (FG-REQ-019).
    pub fn new(now: Stamp) -> Self {
        let mut machine = Self::IDLE;
        machine.raise(CauseRecord::new(Cause::StartUp, now));
        machine.raise(CauseRecord::new(Cause::StartNeeded, now));
        machine
    }

    /// Books evidence for a cause. The first record of a cause, and the first stop of an episode, are never
    /// overwritten (FG-REQ-004); the limit is the latest.
    pub fn raise(&mut self, record: CauseRecord) {
        self.held.pulse(record);
        if record.action.stops() && self.first_stop.is_none() {
            self.first_stop = Some(record);
        }
    }

    /// The operator pressed reset: starts the self-test (FG-REQ-005).
    pub fn request_reset(&mut self, now: Stamp) {
        self.reset_since = Some(now);
    }

    /// The operator gave the start command. It counts when nothing else waits for a person, and is not remembered: who
    /// resets afterwards must start again (FG-REQ-019).
    pub fn request_start(&mut self) {
        let waits = |cause: Cause| cause.is_latching() || cause == Cause::StartUp;
        if !self.held.iter().any(|held| waits(held.first.cause)) {
            self.held.retain(|held| held.first.cause != Cause::StartNeeded);
        }
    }

    /// The causes that hold and need a reset, one bit for each [`Cause::index`]: what a reboot must not forget
    /// (FG-REQ-070).
    #[must_use]
    pub fn latches(&self) -> u64 {
        let latched = self.held.iter().filter(|held| held.first.cause.clear() == Clear::Reset);
        latched.fold(0, |bits, held| bits | 1_u64.wrapping_shl(truncating_u32(held.first.cause.index())))
    }

    /// What raised a cause was seen to be gone: it ends now, and not after the time without evidence.
    pub(super) fn release(&mut self, cause: Cause) {
        self.held.release(cause);
    }

    /// A cause holds.
    #[must_use]
    pub fn holds(&self, cause: Cause) -> bool {
        self.held.holds(cause)
    }

    /// The causes that hold, as they began.
    pub fn held(&self) -> impl Iterator<Item = &CauseRecord> {
        self.held.iter().map(|held| &held.first)
    }

    /// Resets granted so far.
    #[must_use]
    pub fn resets(&self) -> u32 {
        self.resets
    }

    /// Becomes equal to another one, at the price of what differs.
    pub fn follow(&mut self, other: &Self) {
        self.held.follow(&other.held);
        (self.first_stop, self.reset_since, self.resets) =
            (other.first_stop, other.reset_since, other.resets);
    }

    /// Lets go what may go, and says what follows. `self_test_passed`: the machine is fit to be reset.
    pub fn settle(&mut self, self_test_passed: bool, now: Stamp) -> Verdict {
        let granted = self.reset_granted(self_test_passed, now);
        self.held.retain(|held| match held.first.cause.clear() {
            Clear::Quiet(needed_us) => elapsed_us(held.last_pulse, now) < needed_us,
            Clear::Reset => !granted,
            Clear::Start | Clear::Restart => true,
        });
        if granted {
            self.raise(CauseRecord::new(Cause::StartNeeded, now));
        }
        let verdict = self.verdict(now);
        if !verdict.action.stops() {
            self.first_stop = None;
        }
        verdict
    }

    /// A reset is granted once, after the self-test has held; any failure of it, or evidence of what is to be reset,
    /// cancels the request (FG-REQ-005).
    fn reset_granted(&mut self, self_test_passed: bool, now: Stamp) -> bool {
        let Some(since) = self.reset_since else { return false };
        let present = self.present_latch(now).is_some();
        let granted = self_test_passed && !present && elapsed_us(since, now) >= SELF_TEST_US;
        if granted || present || !self_test_passed {
            self.reset_since = None;
        }
        self.resets = self.resets.saturating_add(u32::from(granted));
        granted
    }

    /// A cause that needs a reset and whose evidence is present.
    pub(super) fn present_latch(&self, now: Stamp) -> Option<Cause> {
        let is_present = |cause: Cause, last_pulse: Stamp| {
            cause.clear() == Clear::Reset && elapsed_us(last_pulse, now) < PRESENT_US
        };
        self.held
            .iter()
            .find(|held| is_present(held.first.cause, held.last_pulse))
            .map(|held| held.first.cause)
    }

    fn verdict(&self, now: Stamp) -> Verdict {
        let mut verdict = Verdict {
            action: Action::None,
            state: GuardState::Run,
            limit_mps: f32::INFINITY,
            primary: None,
            holding: None,
        };
        let mut latched = false;
        let (mut holding, mut foremost) = (None, Foremost::default());
        for slot in self.held.iter() {
            verdict.action = verdict.action.max(slot.first.action);
            let is_present = elapsed_us(slot.last_pulse, now) < PRESENT_US;
            let candidate = Foremost {
                is_pressed: is_present && slot.first.cause == Cause::EmergencyStop,
                action: slot.first.action,
                is_present,
                newest: slot.last_pulse,
            };
            if candidate >= foremost {
                (holding, foremost) = (Some(slot.first), candidate);
            }
            latched |= slot.first.cause.is_latching();
            if slot.first.action == Action::Limit && slot.limit_mps < verdict.limit_mps {
                verdict.limit_mps = slot.limit_mps;
                verdict.primary = Some(slot.first);
            }
        }
        if verdict.action.stops() {
            verdict.limit_mps = 0.0;
            (verdict.primary, verdict.holding) = (self.first_stop, holding);
        } else {
            verdict.holding = verdict.primary;
        }
        verdict.state = match verdict.action {
            _ if latched => GuardState::Latched,
            _ if self.holds(Cause::StartUp) => GuardState::Init,
            _ if self.holds(Cause::StartNeeded) => GuardState::AwaitsStart,
            Action::None => GuardState::Run,
            Action::Limit => GuardState::Slow,
            _ => GuardState::Stop,
        };
        verdict
    }
}

/// Which of two causes is shown as what holds the robot: a pressed emergency stop before all others, then the more severe
/// demand, then what is still there, then the newest evidence (FG-REQ-071).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Foremost {
    is_pressed: bool,
    action: Action,
    is_present: bool,
    newest: Stamp,
}

/// Microseconds from a pulse to now; 0 when the pulse lies in the future: then nothing has been quiet.
fn elapsed_us(pulse: Stamp, now: Stamp) -> u64 {
    match pulse.age(now) {
        Age::Past(us) => us,
        Age::Future(_) => 0,
    }
}

#[cfg(test)]
impl DecisionMachine {
    /// Which causes hold, since how many steps, and how far a reset is: the state without the clock, for exploration.
    pub(super) fn abstracted(&self, now: Stamp) -> (std::vec::Vec<(Cause, u64)>, Option<u64>) {
        let held = self.held.iter();
        let ages = held.map(|slot| {
            let longest_us = match slot.first.cause.clear() {
                Clear::Quiet(us) => us,
                Clear::Reset => PRESENT_US,
                Clear::Start | Clear::Restart => 0,
            };
            (slot.first.cause, elapsed_us(slot.last_pulse, now).min(longest_us))
        });
        (ages.collect(), self.reset_since.map(|since| elapsed_us(since, now).min(SELF_TEST_US)))
    }

    /// As [`Self::abstracted`], with times in steps.
    pub(super) fn abstracted_in(
        &self,
        now: Stamp,
        step_us: u64,
    ) -> (std::vec::Vec<(Cause, u64)>, Option<u64>) {
        let (ages, reset) = self.abstracted(now);
        let steps = |us: u64| us / step_us;
        (ages.into_iter().map(|(cause, us)| (cause, steps(us))).collect(), reset.map(steps))
    }
}
