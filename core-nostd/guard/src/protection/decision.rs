//! The guard's answer to its inputs.

use super::action::{Action, GuardState};
use super::record::CauseRecord;
use super::source::{Health, Source};
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

/// The answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision {
    /// When it was taken.
    pub stamp: Stamp,
    /// The command permitted to the drive; zero when the robot must stand.
    pub permitted: Twist2,
    /// The most severe demand of all causes that hold.
    pub action: Action,
    /// Greatest speed that is permitted now, m/s.
    pub speed_limit_mps: f32,
    /// State to show.
    pub state: GuardState,
    /// First cause of this stop; without a stop the cause with the least limit.
    pub primary_cause: Option<CauseRecord>,
    /// What holds the robot now: of the causes with the most severe demand the one with the newest evidence; without a stop
    /// the same as [`Self::primary_cause`] (FG-REQ-071).
    pub holding_cause: Option<CauseRecord>,
    /// The drive's torque must be off: category 0, or category 1 once the robot stands.
    pub torque_off: bool,
    /// The robot leaves an obstacle at escape speed although a stop is in force.
    pub escaping: bool,
    /// Index of the field set that is watched.
    pub field_set: usize,
}

/// One line of the health display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceReport {
    /// Which source.
    pub source: Source,
    /// How it is.
    pub health: Health,
    /// Microseconds since its newest measurement; the greatest number when there is none.
    pub age_us: u64,
    /// How far its last refused stamp was ahead of the robot's clock, microseconds; 0 = accepted.
    pub ahead_us: u64,
    /// The robot has it.
    pub fitted: bool,
}
