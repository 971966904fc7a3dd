//! Does a controller stop by itself when this computer is silent? It is asked before it may drive (FG-REQ-084).

use floorguard_types::time::{Age, Stamp};

/// Beyond its own time a controller may take so long to show it, microseconds: three heartbeats of an ODrive.
const SHOWN_WITHIN_US: u64 = 300_000;

/// What is known of the controllers' watchdogs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WatchdogCheck {
    /// Not known yet; nothing drives.
    #[default]
    Pending,
    /// The wheels stand with torque, nothing is sent, and each controller must say that its watchdog expired.
    Silent(Stamp),
    /// Every controller stops by itself.
    Passed,
    /// One does not; nothing drives until the operator resets.
    Failed,
    /// It cannot be known by what the controller sends: the operator answers for it.
    Unknowable,
}

impl WatchdogCheck {
    /// Driving is allowed.
    #[must_use]
    pub const fn allows(self) -> bool {
        matches!(self, Self::Passed | Self::Unknowable)
    }

    /// One poll of a check by silence. `is_ready`: the wheels stand with torque; `is_wanted`: they are to operate; `have_expired`: every
    /// controller says so.
    pub(super) fn step(
        self,
        (is_wanted, is_ready, have_expired): (bool, bool, bool),
        (now, limit_ms): (Stamp, u16),
    ) -> Self {
        let limit_us = u64::from(limit_ms).saturating_mul(1_000).saturating_add(SHOWN_WITHIN_US);
        match self {
            Self::Pending if is_wanted && is_ready => Self::Silent(now),
            // A stop must go out: it is asked again later.
            Self::Silent(_) if !is_wanted => Self::Pending,
            Self::Silent(_) if have_expired => Self::Passed,
            Self::Silent(since) if !matches!(since.age(now), Age::Past(us) if us <= limit_us) => Self::Failed,
            other => other,
        }
    }
}
