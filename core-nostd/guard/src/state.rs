//! Everything that changes: plain data, kept twice so that a flipped bit is noticed before it can matter.

use super::field_selection::FieldSelection;
use super::machine::DecisionMachine;
use super::motion_checks::MotionChecks;
use super::rules::STOP_QUIET_US;
use super::source_monitor::SourceMonitor;
use crate::protection::{Blocked, GuardConfig, Motion, Source};
use floorguard_types::capacities::REAR_SCANNERS_MAX;
use floorguard_types::geometry::Twist2;
use floorguard_types::time::{Age, Stamp};

/// Evidence of an obstacle in a direction counts as long as the stop that it caused, microseconds: leaving towards
/// it must not begin before the stop would end (FG-REQ-041).
const BLOCKED_US: u64 = STOP_QUIET_US;

/// The state of the guard. No number in it is ever NaN, so that it equals its copy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    pub(super) monitors: [SourceMonitor; Source::COUNT],
    pub(super) machine: DecisionMachine,
    pub(super) selection: FieldSelection,
    pub(super) motion: Motion,
    pub(super) checks: MotionChecks,
    pub(super) wanted: Twist2,
    pub(super) wanted_fastest_mps: f32,
    pub(super) permitted: Twist2,
    pub(super) decided_at: Stamp,
    pub(super) started: bool,
    pub(super) scans_with_hit: u8,
    pub(super) rear_scans_with_hit: [u8; REAR_SCANNERS_MAX],
    pub(super) packet_returns: u8,
    pub(super) silent_cdeg: u32,
    pub(super) blocked_forward: Option<Stamp>,
    pub(super) blocked_backward: Option<Stamp>,
}

impl State {
    /// Nothing is known, not even the robot.
    pub(super) const UNKNOWN: Self = Self {
        monitors: [SourceMonitor::UNKNOWN; Source::COUNT],
        machine: DecisionMachine::IDLE,
        selection: FieldSelection::NONE,
        motion: Motion::STILL,
        checks: MotionChecks::NONE,
        wanted: Twist2::ZERO,
        wanted_fastest_mps: 0.0,
        permitted: Twist2::ZERO,
        decided_at: Stamp::ZERO,
        started: false,
        scans_with_hit: 0,
        rear_scans_with_hit: [0; REAR_SCANNERS_MAX],
        packet_returns: 0,
        silent_cdeg: 0,
        blocked_forward: None,
        blocked_backward: None,
    };

    /// Nothing but the robot is known.
    pub(super) fn new(config: &GuardConfig, now: Stamp) -> Self {
        let selection = FieldSelection::new(&config.fields, now);
        Self { machine: DecisionMachine::new(now), selection, decided_at: now, ..Self::UNKNOWN }
    }

    /// Becomes equal to another one. By fields: the machine's table is large and mostly without meaning.
    pub(super) fn follow(&mut self, other: &Self) {
        self.machine.follow(&other.machine);
        (self.monitors, self.selection, self.motion) = (other.monitors, other.selection, other.motion);
        (self.checks, self.wanted, self.permitted) = (other.checks, other.wanted, other.permitted);
        self.wanted_fastest_mps = other.wanted_fastest_mps;
        (self.decided_at, self.started) = (other.decided_at, other.started);
        (self.scans_with_hit, self.packet_returns) = (other.scans_with_hit, other.packet_returns);
        (self.silent_cdeg, self.rear_scans_with_hit) = (other.silent_cdeg, other.rear_scans_with_hit);
        (self.blocked_forward, self.blocked_backward) = (other.blocked_forward, other.blocked_backward);
    }

    /// Remembers in which directions evidence lies.
    pub(super) fn note_blocked(&mut self, blocked: Blocked, now: Stamp) {
        if blocked.forward {
            self.blocked_forward = Some(now);
        }
        if blocked.backward {
            self.blocked_backward = Some(now);
        }
    }

    /// No recent evidence lies in the direction.
    pub(super) fn is_clear(&self, backward: bool, now: Stamp) -> bool {
        let blocked = if backward { self.blocked_backward } else { self.blocked_forward };
        match blocked.map(|stamp| stamp.age(now)) {
            None => true,
            Some(Age::Past(us)) => us >= BLOCKED_US,
            Some(Age::Future(_)) => false,
        }
    }
}
