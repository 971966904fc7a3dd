//! What the guard decided: the last ten seconds, and every stop.

use floorguard_guard::{Action, Cause, CauseRecord, Decision, GuardState};
use floorguard_types::geometry::Pose2;
use floorguard_types::time::{Age, Stamp};

use super::motion::StampedPose;
use crate::black_box::BlackBox;

/// Stops kept for a reader that comes by once a second.
pub const STOPS_KEPT: usize = 32;
/// Without a change the black box takes one entry per tick, microseconds.
const ENTRY_EVERY_US: u64 = 10_000;

/// One moment in the black box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxEntry {
    /// State shown.
    pub state: GuardState,
    /// Most severe demand.
    pub action: Action,
    /// What stopped it first, or limits it.
    pub cause: Option<Cause>,
    /// What holds it at this moment.
    pub holding: Option<Cause>,
    /// Speed permitted, m/s.
    pub permitted_mps: f32,
    /// Speed measured, m/s.
    pub measured_mps: f32,
    /// Greatest speed permitted, m/s.
    pub limit_mps: f32,
    /// Field set that was watched.
    pub field_set: u8,
}

/// A stop that began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRecord {
    /// When it was decided.
    pub stamp: Stamp,
    /// Why.
    pub cause: CauseRecord,
    /// State shown.
    pub state: GuardState,
    /// Where, in the odometry frame.
    pub pose_in_odometry: Pose2,
    /// Speed at the moment of the decision, m/s.
    pub speed_mps: f32,
}

pub(super) struct Records {
    pub ring: BlackBox<BoxEntry>,
    last: Option<(Stamp, BoxEntry)>,
    stopped: bool,
    latches: u64,
}

impl Records {
    pub const fn new() -> Self {
        // Nothing moves at first: the start is not a stop.
        Self { ring: BlackBox::new(), last: None, stopped: true, latches: 0 }
    }

    /// True when other causes are latched than before.
    pub fn note_latches(&mut self, latches: u64) -> bool {
        core::mem::replace(&mut self.latches, latches) != latches
    }

    /// Takes in a decision; gives the stop that it begins.
    pub fn note(&mut self, decision: &Decision, pose: &StampedPose) -> Option<StopRecord> {
        let entry = BoxEntry {
            state: decision.state,
            action: decision.action,
            cause: decision.primary_cause.map(|record| record.cause),
            holding: decision.holding_cause.map(|record| record.cause),
            permitted_mps: decision.permitted.linear_mps,
            measured_mps: pose.twist.linear_mps,
            limit_mps: decision.speed_limit_mps,
            field_set: decision.field_set as u8,
        };
        let due = self.last.is_none_or(|(stamp, last)| {
            let aged = matches!(stamp.age(decision.stamp), Age::Past(us) if us >= ENTRY_EVERY_US);
            aged || reported(&last) != reported(&entry)
        });
        if due {
            self.ring.record(decision.stamp, entry);
            self.last = Some((decision.stamp, entry));
        }
        let stops = decision.action.stops() && !decision.escaping;
        let began = stops && !self.stopped;
        self.stopped = stops;
        let cause = decision.primary_cause.filter(|_| began)?;
        Some(StopRecord {
            stamp: decision.stamp,
            cause,
            state: decision.state,
            pose_in_odometry: pose.pose_in_odometry,
            speed_mps: pose.twist.linear_mps,
        })
    }
}

/// What is news at once.
const fn reported(entry: &BoxEntry) -> (GuardState, Action, Option<Cause>, Option<Cause>) {
    (entry.state, entry.action, entry.cause, entry.holding)
}
