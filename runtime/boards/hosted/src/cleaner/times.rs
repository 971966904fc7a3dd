//! Where the time of a mission goes: driving, slowed, held or with no way to go, each by its reason.
//!
//! What people cost is told from this and from nothing else, so that the sum of all reasons is the time of the mission.

use floorguard_core::geometry::Twist2;
use floorguard_core::guard::{Cause, Decision};

/// Slower than this is standing, m/s and rad/s.
const STANDS: (f32, f32) = (0.02, 0.02);
/// A limit this much below the wish slows the robot, m/s.
const SLOWER_MPS: f32 = 0.02;

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
        let cause = decision.primary_cause.map(|record| record.cause);
        let permitted = decision.permitted;
        if permitted.linear_mps.abs() < STANDS.0 && permitted.angular_radps.abs() < STANDS.1 {
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
pub struct Times([f32; Spent::ALL.len()]);

impl Times {
    /// A moment more.
    pub fn add(&mut self, spent: Spent, lasted_s: f32) {
        if let Some(seconds) = self.0.get_mut(spent as usize) {
            *seconds += lasted_s;
        }
    }

    /// Seconds spent on one thing.
    #[must_use]
    pub fn of(&self, spent: Spent) -> f32 {
        self.0.get(spent as usize).copied().unwrap_or(0.0)
    }

    /// Everything that took time, in the order of [`Spent::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Spent, f32)> + '_ {
        Spent::ALL.into_iter().zip(self.0).filter(|(_, seconds)| *seconds > 0.0)
    }
}
