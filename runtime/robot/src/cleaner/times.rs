//! Where the time of a mission goes: driving, slowed, held or with no way to go, each by its reason.
//!
//! What people cost is told from this and from nothing else, so that the sum of all reasons is the time of the mission.

use floorguard_guard::{Cause, Decision};
use floorguard_types::geometry::Twist2;

/// Slower than this is standing, m/s and rad/s.
const STANDS: (f32, f32) = (0.02, 0.02);
/// A limit this much below the wish slows the robot, m/s.
const SLOWER_MPS: f32 = 0.02;

/// Who may drive no faster than this stands.
pub(super) fn is_standing(permitted: Twist2) -> bool {
    permitted.linear_mps.abs() < STANDS.0 && permitted.angular_radps.abs() < STANDS.1
}

/// What a moment is spent on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Spent {
    /// Drives as it wishes.
    Driving,
    /// Slower than it wishes: something in the warning field, or where a faster field would reach.
    SlowNearThings,
    /// Slower: a person near the body.
    SlowNearPerson,
    /// Slower: somebody comes nearer.
    SlowSomebodyComes,
    /// Slower for another reason of the guard's.
    SlowOther,
    /// Held: something in the protective field.
    HeldField,
    /// Held: somebody would walk into it.
    HeldSomebodyComes,
    /// Held for another reason of the guard's.
    HeldOther,
    /// Everything that is left to clean is behind somebody or something.
    NoWay,
    /// Stands to find out where it is.
    Finding,
    /// Paused by the operator.
    Paused,
    /// Nothing is left to do.
    Done,
}

impl Spent {
    /// All of them, in the order in which they are told.
    pub const ALL: [Self; 12] = [
        Self::Driving,
        Self::SlowNearThings,
        Self::SlowNearPerson,
        Self::SlowSomebodyComes,
        Self::SlowOther,
        Self::HeldField,
        Self::HeldSomebodyComes,
        Self::HeldOther,
        Self::NoWay,
        Self::Finding,
        Self::Paused,
        Self::Done,
    ];

    /// In plain words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Driving => "driving as it wishes",
            Self::SlowNearThings => "slowed: something stands near its way",
            Self::SlowNearPerson => "slowed: a person is near",
            Self::SlowSomebodyComes => "slowed: somebody comes nearer",
            Self::SlowOther => "slowed: another reason",
            Self::HeldField => "held: something in the protective field",
            Self::HeldSomebodyComes => "held: somebody would walk into it",
            Self::HeldOther => "held: another reason",
            Self::NoWay => "waiting: somebody stands in every way",
            Self::Finding => "standing to find itself",
            Self::Paused => "paused",
            Self::Done => "nothing left to do",
        }
    }

    /// Of a robot that wishes to move, from what its guard permits.
    #[must_use]
    pub fn of(wish: Twist2, decision: Option<Decision>) -> Self {
        let Some(decision) = decision else { return Self::HeldOther };
        let cause = decision.holding_cause.map(|record| record.cause);
        let permitted = decision.permitted;
        if is_standing(permitted) {
            return match cause {
                // No cause stops it: it is only about to set off.
                _ if decision.speed_limit_mps > STANDS.0 => Self::Driving,
                Some(Cause::ScanProtective | Cause::LidarProtective) | None => Self::HeldField,
                Some(Cause::CollisionStop) => Self::HeldSomebodyComes,
                Some(_) => Self::HeldOther,
            };
        }
        if decision.speed_limit_mps + SLOWER_MPS >= wish.linear_mps.abs() {
            return Self::Driving;
        }
        match cause {
            Some(Cause::PersonNear) => Self::SlowNearPerson,
            Some(Cause::CollisionSlow) => Self::SlowSomebodyComes,
            Some(Cause::Warning | Cause::ScanProtective | Cause::LidarProtective) | None => {
                Self::SlowNearThings
            }
            Some(_) => Self::SlowOther,
        }
    }
}

/// Seconds by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    spent_s: [f32; Spent::ALL.len()],
    lost_s: f32,
}

impl Times {
    /// A moment more, with what the robot wished and was permitted.
    pub fn add(&mut self, spent: Spent, (wish, permitted): (Twist2, Twist2), lasted_s: f32) {
        if let Some(seconds) = self.spent_s.get_mut(spent as usize) {
            *seconds += lasted_s;
        }
        let share = match spent {
            Spent::HeldField | Spent::HeldSomebodyComes | Spent::NoWay => 1.0,
            Spent::SlowNearPerson | Spent::SlowSomebodyComes => {
                (1.0 - permitted.linear_mps.abs() / wish.linear_mps.abs().max(STANDS.0)).clamp(0.0, 1.0)
            }
            _ => 0.0,
        };
        self.lost_s += share * lasted_s;
    }

    /// What people and things in the way cost: standing before them in full, driving slowly past people by what is missing.
    #[must_use]
    pub const fn lost_s(&self) -> f32 {
        self.lost_s
    }

    /// Seconds spent on one thing.
    #[must_use]
    pub fn of(&self, spent: Spent) -> f32 {
        self.spent_s.get(spent as usize).copied().unwrap_or(0.0)
    }

    /// Everything that took time, in the order of [`Spent::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Spent, f32)> + '_ {
        Spent::ALL.into_iter().zip(self.spent_s).filter(|(_, seconds)| *seconds > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use floorguard_guard::{Action, CauseRecord, GuardState};
    use floorguard_types::time::Stamp;

    use super::*;

    const WISH: Twist2 = Twist2 { linear_mps: 0.6, angular_radps: 0.0 };

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
    fn every_moment_has_one_reason_and_slowness_costs_what_is_missing() {
        let cases = [
            (0.6, None, Spent::Driving, 0.0),
            (0.3, Some(Cause::PersonNear), Spent::SlowNearPerson, 0.5),
            (0.15, Some(Cause::CollisionSlow), Spent::SlowSomebodyComes, 0.75),
            (0.3, None, Spent::SlowNearThings, 0.0),
            (0.0, Some(Cause::CollisionStop), Spent::HeldSomebodyComes, 1.0),
            (0.0, Some(Cause::ScanProtective), Spent::HeldField, 1.0),
            (0.0, Some(Cause::EmergencyStop), Spent::HeldOther, 0.0),
        ];
        let (mut times, mut lost_s) = (Times::default(), 0.0);
        for (permitted_mps, cause, spent, costs) in cases {
            let decision = decision(permitted_mps, cause);
            assert_eq!(Spent::of(WISH, Some(decision)), spent, "{cause:?}");
            times.add(spent, (WISH, decision.permitted), 2.0);
            lost_s += 2.0 * costs;
        }
        assert!((times.lost_s() - lost_s).abs() < 1e-5, "{}", times.lost_s());
        let all_s: f32 = times.iter().map(|(_, seconds)| seconds).sum();
        assert_eq!(all_s, 2.0 * cases.len() as f32);
    }
}
