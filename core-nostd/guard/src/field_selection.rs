//! Which field set is watched, and how fast it lets the robot go (book, Guard: Field selection).
//!
//! The set follows the higher of permitted and measured speed. A larger set must have been watched, and clear, for the
//! activation time before its speed is allowed; while it is only watched, something inside it holds the speed down
//! but stops nobody.

use heapless::Vec;

use crate::protection::{FieldSet, Travel};
use floorguard_types::capacities::FIELD_SETS_MAX;
use floorguard_types::geometry::Twist2;
use floorguard_types::time::{Age, Stamp};

/// A smaller set is taken when the speed is this far below its limit, m/s.
const HYSTERESIS_MPS: f32 = 0.05;
/// Slower than this is standing, m/s.
pub const STANDING_MPS: f32 = 0.05;
/// Turning on the spot from this rate, rad/s.
const SPIN_RADPS: f32 = 0.1;
/// A bend from this curvature, 1/m.
const BEND_PER_M: f32 = 0.3;

/// The set that is watched, and the next larger one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldSelection {
    /// Something inside this set stops.
    pub active: usize,
    /// Something inside this one only keeps it from becoming active.
    pub candidate: Option<usize>,
    pub(super) candidate_clear_since: Stamp,
    pub(super) held_cap_mps: f32,
    pub(super) held_until: Stamp,
}

/// What the robot does and wants.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand {
    /// The command, as far as the other limits permit it.
    pub wanted: Twist2,
    /// What was permitted last.
    pub permitted: Twist2,
    /// What the encoders measure.
    pub measured: Twist2,
}

impl Demand {
    /// The higher of permitted and measured speed, m/s (FG-REQ-021).
    fn speed_mps(&self) -> f32 {
        self.permitted.linear_mps.abs().max(self.measured.linear_mps.abs())
    }

    /// Where the robot goes: what it does while it moves, what it wants while it stands.
    pub(super) fn travel(&self) -> Option<Travel> {
        let moves = self.measured.linear_mps.abs() > STANDING_MPS;
        travel_of(if moves { self.measured } else { self.wanted })
    }
}

/// The steering bin of a motion (FG-REQ-025); `None` while it stands.
#[must_use]
pub fn travel_of(twist: Twist2) -> Option<Travel> {
    let (speed, turn) = (twist.linear_mps, twist.angular_radps);
    if speed.abs() < STANDING_MPS {
        return if turn.abs() >= SPIN_RADPS {
            Some(Travel::Spin)
        } else if speed == 0.0 {
            None
        } else if speed < 0.0 {
            Some(Travel::Reverse)
        } else {
            Some(Travel::Straight)
        };
    }
    Some(match turn / speed {
        _ if speed < 0.0 => Travel::Reverse,
        curvature if curvature > BEND_PER_M => Travel::Left,
        curvature if curvature < -BEND_PER_M => Travel::Right,
        _ => Travel::Straight,
    })
}

impl FieldSelection {
    /// There is no set.
    pub(super) const NONE: Self = Self {
        active: 0,
        candidate: None,
        candidate_clear_since: Stamp::ZERO,
        held_cap_mps: 0.0,
        held_until: Stamp::ZERO,
    };

    /// Starts with the slowest straight set.
    pub fn new(sets: &Vec<FieldSet, FIELD_SETS_MAX>, now: Stamp) -> Self {
        let active = pick(sets, Travel::Straight, 0.0);
        Self { active, candidate_clear_since: now, held_until: now, ..Self::NONE }
    }

    /// Follows the motion. `activation_us`: how long a set is watched before its speed is allowed (FG-REQ-022).
    pub fn update(
        &mut self,
        sets: &Vec<FieldSet, FIELD_SETS_MAX>,
        demand: &Demand,
        (activation_us, now): (u64, Stamp),
    ) {
        let travel = demand.travel().unwrap_or(travel_at(sets, self.active));
        let needed = pick(sets, travel, demand.speed_mps());
        if travel_at(sets, needed) != travel_at(sets, self.active) {
            self.change_direction(sets, needed, now.plus_micros(activation_us));
        } else if speed_at(sets, needed) > speed_at(sets, self.active) {
            self.active = needed;
        } else {
            let wanted_mps = demand.speed_mps().max(demand.wanted.linear_mps.abs());
            let relaxed = pick(sets, travel, wanted_mps + HYSTERESIS_MPS);
            if speed_at(sets, relaxed) < speed_at(sets, self.active) {
                self.active = relaxed;
            }
        }
        self.watch_next(sets, demand.wanted.linear_mps.abs(), now);
        if let Some(candidate) = self.candidate
            && matches!(self.candidate_clear_since.age(now), Age::Past(clear_us) if clear_us >= activation_us)
        {
            self.active = candidate;
            self.candidate = None;
        }
    }

    /// Something is inside the candidate set.
    pub fn candidate_blocked(&mut self, now: Stamp) {
        self.candidate_clear_since = now;
    }

    /// Greatest speed that the watched set allows in the wanted direction, m/s.
    #[must_use]
    pub fn cap_mps(&self, sets: &Vec<FieldSet, FIELD_SETS_MAX>, wanted: Twist2, now: Stamp) -> f32 {
        let backward = travel_at(sets, self.active) == Travel::Reverse;
        if wanted.linear_mps != 0.0 && (wanted.linear_mps < 0.0) != backward {
            return 0.0;
        }
        let cap_mps = speed_at(sets, self.active);
        if now < self.held_until { cap_mps.min(self.held_cap_mps) } else { cap_mps }
    }

    fn change_direction(&mut self, sets: &Vec<FieldSet, FIELD_SETS_MAX>, needed: usize, until: Stamp) {
        let reverses =
            travel_at(sets, needed) == Travel::Reverse || travel_at(sets, self.active) == Travel::Reverse;
        self.held_cap_mps =
            if reverses { 0.0 } else { speed_at(sets, self.active).min(speed_at(sets, needed)) };
        self.held_until = until;
        self.active = needed;
        self.candidate = None;
    }

    fn watch_next(&mut self, sets: &Vec<FieldSet, FIELD_SETS_MAX>, wanted_mps: f32, now: Stamp) {
        let active_mps = speed_at(sets, self.active);
        let candidate = if wanted_mps > active_mps {
            let next = pick(sets, travel_at(sets, self.active), active_mps + 1.0e-3);
            (speed_at(sets, next) > active_mps).then_some(next)
        } else {
            None
        };
        if candidate != self.candidate {
            self.candidate_clear_since = now;
        }
        self.candidate = candidate;
    }
}

/// The smallest set for a direction that covers a speed; the largest of that direction when none does. A direction
/// without sets falls back to straight.
fn pick(sets: &Vec<FieldSet, FIELD_SETS_MAX>, travel: Travel, speed_mps: f32) -> usize {
    let of_travel = pick_of(sets, travel, speed_mps).or_else(|| pick_of(sets, Travel::Straight, speed_mps));
    of_travel.unwrap_or(0)
}

fn pick_of(sets: &Vec<FieldSet, FIELD_SETS_MAX>, travel: Travel, speed_mps: f32) -> Option<usize> {
    let mut best: Option<(usize, f32)> = None;
    for (index, set) in sets.iter().enumerate().filter(|(_, set)| set.travel == travel) {
        let covers = set.speed_max_mps >= speed_mps;
        let better = match best {
            None => true,
            Some((_, mps)) if mps >= speed_mps => covers && set.speed_max_mps < mps,
            Some((_, mps)) => set.speed_max_mps > mps,
        };
        if better {
            best = Some((index, set.speed_max_mps));
        }
    }
    best.map(|(index, _)| index)
}

fn speed_at(sets: &Vec<FieldSet, FIELD_SETS_MAX>, index: usize) -> f32 {
    sets.get(index).map_or(0.0, |set| set.speed_max_mps)
}

fn travel_at(sets: &Vec<FieldSet, FIELD_SETS_MAX>, index: usize) -> Travel {
    sets.get(index).map_or(Travel::Straight, |set| set.travel)
}
