//! Where the time of a mission goes: driving, slowed, held or without a free path, each by its reason.
//!
//! What people cost is computed from this alone, so that the sum of all reasons is the time of the mission.

use floorguard_guard::{Cause, Decision};
use floorguard_types::geometry::Twist2;

/// Slower than this is standing, m/s and rad/s.
const STANDS: (f32, f32) = (0.02, 0.02);
/// A limit this much below the requested speed slows the robot, m/s.
const SLOWER_MPS: f32 = 0.02;

/// Who may drive no faster than this stands.
pub(super) fn is_standing(permitted: Twist2) -> bool {
    permitted.linear_mps.abs() < STANDS.0 && permitted.angular_radps.abs() < STANDS.1
}

/// What a moment is spent on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TimeUse {
    /// Drives as requested.
    Driving,
    /// Slower than requested: something in the warning field, or where a faster field would reach.
    SlowNearObjects,
    /// Slower: a person near the body.
    SlowNearPerson,
    /// Slower: somebody comes nearer.
    SlowPersonApproaches,
    /// Slower for another reason of the guard's.
    SlowOther,
    /// Held: something in the protective field.
    HeldField,
    /// Held: somebody would walk into it.
    HeldPersonApproaches,
    /// Held for another reason of the guard's.
    HeldOther,
    /// Everything that is left to clean is behind somebody or something.
    NoPath,
    /// Stands to find out where it is.
    Finding,
    /// Paused by the operator.
    Paused,
    /// Nothing is left to do.
    Done,
}

impl TimeUse {
    /// All of them, in the order in which they are reported.
    pub const ALL: [Self; 12] = [
        Self::Driving,
        Self::SlowNearObjects,
        Self::SlowNearPerson,
        Self::SlowPersonApproaches,
        Self::SlowOther,
        Self::HeldField,
        Self::HeldPersonApproaches,
        Self::HeldOther,
        Self::NoPath,
        Self::Finding,
        Self::Paused,
        Self::Done,
    ];

    /// In plain words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Driving => "driving as requested",
            Self::SlowNearObjects => "slowed: an object near the path",
            Self::SlowNearPerson => "slowed: a person is near",
            Self::SlowPersonApproaches => "slowed: a person approaches",
            Self::SlowOther => "slowed: another reason",
            Self::HeldField => "held: something in the protective field",
            Self::HeldPersonApproaches => "held: a person would walk into it",
            Self::HeldOther => "held: another reason",
            Self::NoPath => "waiting: every path is blocked",
            Self::Finding => "standing to find itself",
            Self::Paused => "paused",
            Self::Done => "nothing left to do",
        }
    }

    /// Of a robot with a non-zero request, from what its guard permits.
    #[must_use]
    pub fn of(requested: Twist2, decision: Option<Decision>) -> Self {
        let Some(decision) = decision else { return Self::HeldOther };
        let cause = decision.holding_cause.map(|record| record.cause);
        let permitted = decision.permitted;
        if is_standing(permitted) {
            return match cause {
                // No cause stops it: it is only about to set off.
                _ if decision.speed_limit_mps > STANDS.0 => Self::Driving,
                Some(Cause::ScanProtective | Cause::LidarProtective | Cause::WayClosed) | None => {
                    Self::HeldField
                }
                Some(Cause::CollisionStop) => Self::HeldPersonApproaches,
                Some(_) => Self::HeldOther,
            };
        }
        if decision.speed_limit_mps + SLOWER_MPS >= requested.linear_mps.abs() {
            return Self::Driving;
        }
        match cause {
            Some(Cause::PersonNear) => Self::SlowNearPerson,
            Some(Cause::CollisionSlow) => Self::SlowPersonApproaches,
            Some(Cause::Warning | Cause::ScanProtective | Cause::LidarProtective | Cause::WayNarrow)
            | None => Self::SlowNearObjects,
            Some(_) => Self::SlowOther,
        }
    }
}

/// Seconds by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    spent_s: [f32; TimeUse::ALL.len()],
    lost_s: f32,
}

impl Times {
    /// A moment more, with the requested and the permitted velocity.
    pub fn add(&mut self, spent: TimeUse, (requested, permitted): (Twist2, Twist2), lasted_s: f32) {
        if let Some(seconds) = self.spent_s.get_mut(spent as usize) {
            *seconds += lasted_s;
        }
        let share = match spent {
            TimeUse::HeldField | TimeUse::HeldPersonApproaches | TimeUse::NoPath => 1.0,
            TimeUse::SlowNearPerson | TimeUse::SlowPersonApproaches => {
                (1.0 - permitted.linear_mps.abs() / requested.linear_mps.abs().max(STANDS.0)).clamp(0.0, 1.0)
            }
            _ => 0.0,
        };
        self.lost_s += share * lasted_s;
    }

    /// What people and objects on the path cost: standing before them in full, driving slowly past people by what is
    /// missing.
    #[must_use]
    pub const fn lost_s(&self) -> f32 {
        self.lost_s
    }

    /// Seconds of one category.
    #[must_use]
    pub fn of(&self, spent: TimeUse) -> f32 {
        self.spent_s.get(spent as usize).copied().unwrap_or(0.0)
    }

    /// Everything that took time, in the order of [`TimeUse::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (TimeUse, f32)> + '_ {
        TimeUse::ALL.into_iter().zip(self.spent_s).filter(|(_, seconds)| *seconds > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use floorguard_guard::{Action, CauseRecord, GuardState};
    use floorguard_types::time::Stamp;

    use super::*;

    const REQUESTED: Twist2 = Twist2 { linear_mps: 0.6, angular_radps: 0.0 };

    fn decision(linear_mps: f32, cause: Option<Cause>) -> Decision {
        Decision {
            stamp: Stamp::ZERO,
            permitted: Twist2 { linear_mps, angular_radps: 0.0 },
            action: Action::None,
            speed_limit_mps: linear_mps,
            state: GuardState::Run,
            primary_cause: cause.map(|_| CauseRecord::new(Cause::StartUp, Stamp::ZERO)),
            holding_cause: cause.map(|cause| CauseRecord::new(cause, Stamp::ZERO)),
            torque_off: false,
            escaping: false,
            field_set: 0,
        }
    }

    #[test]
    fn every_moment_has_one_time_use() {
        let cases = [
            (0.6, None, TimeUse::Driving, 0.0),
            (0.3, Some(Cause::PersonNear), TimeUse::SlowNearPerson, 0.5),
            (0.15, Some(Cause::CollisionSlow), TimeUse::SlowPersonApproaches, 0.75),
            (0.3, None, TimeUse::SlowNearObjects, 0.0),
            (0.0, Some(Cause::CollisionStop), TimeUse::HeldPersonApproaches, 1.0),
            (0.0, Some(Cause::ScanProtective), TimeUse::HeldField, 1.0),
            (0.0, Some(Cause::EmergencyStop), TimeUse::HeldOther, 0.0),
        ];
        let (mut times, mut lost_s) = (Times::default(), 0.0);
        for (permitted_mps, cause, spent, costs) in cases {
            let decision = decision(permitted_mps, cause);
            assert_eq!(TimeUse::of(REQUESTED, Some(decision)), spent, "{cause:?}");
            times.add(spent, (REQUESTED, decision.permitted), 2.0);
            lost_s += 2.0 * costs;
        }
        assert!((times.lost_s() - lost_s).abs() < 1e-5, "{}", times.lost_s());
        let all_s: f32 = times.iter().map(|(_, seconds)| seconds).sum();
        assert_eq!(all_s, 2.0 * cases.len() as f32);
    }
}
