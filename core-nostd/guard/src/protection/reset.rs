//! What came of the operator's reset: granted, or refused and why. For display alone; nothing is decided by it.

use super::cause::Cause;
use super::source::{Health, Source};
use floorguard_types::time::Stamp;

/// Why a reset was refused (FG-REQ-072).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ResetRefusal {
    /// What is to be reset is still there.
    Present(Cause),
    /// A required source is not healthy.
    NotHealthy(Source, Health),
    /// The robot moves.
    Moving,
}

/// The resets so far; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ResetReport {
    /// Granted.
    pub granted: u32,
    /// Refused.
    pub refused: u32,
    /// When the last one was answered.
    pub answered_at: Stamp,
    /// Why the last one was refused; none if it was granted, or if nobody has pressed reset.
    pub refusal: Option<ResetRefusal>,
}

impl ResetReport {
    /// Nobody has pressed reset.
    pub const NONE: Self = Self { granted: 0, refused: 0, answered_at: Stamp::ZERO, refusal: None };
}
