//! Watches one source: is it fresh, alive, seeing, and honest about time?

use crate::protection::{Action, FaultKind, Health, SourceRules};
use floorguard_types::time::{Age, Stamp};

/// A stamp may lie this far in the future: rounding and jitter of clock estimates.
pub const FUTURE_TOLERANCE_US: u64 = 2_000;

/// What is remembered of a source.
///
/// ```
/// use floorguard_guard::{Health, SourceMonitor, SourceRules};
/// use floorguard_types::time::Stamp;
///
/// let rules = SourceRules::required(100, 0.3, 200);
/// let at = |millis: u64| Stamp::from_micros(millis * 1_000);
/// let mut monitor = SourceMonitor::UNKNOWN;
/// assert!(monitor.accept(at(10), 1, at(10)));
/// assert_eq!(monitor.health(&rules, at(50)), Health::Healthy);
/// assert_eq!(monitor.health(&rules, at(150)), Health::Stale);
/// // From the future: it proves nothing.
/// assert!(!monitor.accept(at(900), 2, at(160)));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SourceMonitor {
    /// Newest accepted measurement.
    pub newest: Option<Stamp>,
    /// How far ahead of our clock the last refused stamp was, microseconds, at most some 71 minutes; 0 = the last stamp was
    /// acceptable. The state is copied and compared at each decision: each byte counts.
    pub ahead_us: u32,
    /// What the driver or a check reported after the last good sample.
    pub fault: Option<FaultKind>,
    /// It sees nothing where it must see something.
    pub blind: bool,
    /// What it measures stays the same although the robot moves (FG-REQ-035).
    pub repeats: bool,
    pub(super) fingerprint: u32,
    pub(super) identical: u16,
}

impl SourceMonitor {
    /// Nothing arrived yet.
    pub const UNKNOWN: Self = Self {
        newest: None,
        ahead_us: 0,
        fault: None,
        blind: false,
        repeats: false,
        fingerprint: 0,
        identical: 0,
    };

    /// Books a sample. `fingerprint` sums up its content; equal content counts towards frozen (FG-REQ-015). `false`: the stamp
    /// comes from the future, the sample proves nothing (FG-REQ-011).
    pub fn accept(&mut self, stamp: Stamp, fingerprint: u32, now: Stamp) -> bool {
        if let Age::Future(ahead_us) = stamp.age(now)
            && ahead_us > FUTURE_TOLERANCE_US
        {
            self.ahead_us = u32::try_from(ahead_us).unwrap_or(u32::MAX);
            return false;
        }
        self.ahead_us = 0;
        self.fault = None;
        self.identical = if fingerprint == self.fingerprint { self.identical.saturating_add(1) } else { 0 };
        self.fingerprint = fingerprint;
        self.newest = self.newest.max(Some(stamp));
        true
    }

    /// Microseconds since the newest measurement; the greatest number when there is none or it lies in the future.
    #[must_use]
    pub fn age_us(&self, now: Stamp) -> u64 {
        match self.newest.map(|stamp| stamp.age(now)) {
            Some(Age::Past(age_us)) => age_us,
            Some(Age::Future(ahead_us)) if ahead_us <= FUTURE_TOLERANCE_US => 0,
            _ => u64::MAX,
        }
    }

    /// How it is (FG-REQ-010). What is wrong with the device comes before what is wrong with its age.
    #[must_use]
    pub fn health(&self, rules: &SourceRules, now: Stamp) -> Health {
        if self.fault.is_some() || self.ahead_us > 0 {
            Health::Faulty
        } else if self.newest.is_none() {
            Health::Absent
        } else if self.age_us(now) > rules.limit_after_us {
            Health::Stale
        } else if self.repeats || (rules.frozen_samples > 0 && self.identical >= rules.frozen_samples) {
            Health::Frozen
        } else if self.blind {
            Health::Blind
        } else {
            Health::Healthy
        }
    }

    /// What the failure of this source demands (FG-REQ-013): nothing, a limit, or a stop; a source that
    /// never stops still limits (FG-REQ-014).
    #[must_use]
    pub fn demand(&self, rules: &SourceRules, now: Stamp) -> Action {
        let health = self.health(rules, now);
        if !rules.fitted || health == Health::Healthy {
            return Action::None;
        }
        match rules.stop_after_us {
            None => Action::Limit,
            Some(stop_after_us) if health == Health::Stale && self.age_us(now) <= stop_after_us => {
                Action::Limit
            }
            Some(_) => Action::Category2,
        }
    }
}
