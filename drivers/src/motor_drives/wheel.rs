//! One wheel as its controller reports it.

use floorguard_types::number::{saturating_i32, saturating_i64_of_f64, truncating_i32};
use floorguard_types::time::{Age, Stamp};

/// A controller that was not heard for so long is gone, microseconds: two and a half heartbeats of the slowest.
pub(super) const LOST_US: u64 = 250_000;

/// What a controller does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Condition {
    /// It was not heard.
    #[default]
    Unknown,
    /// No torque.
    Off,
    /// Follows speeds.
    On,
    /// Its watchdog has expired: it stopped by itself.
    Expired,
    /// It cannot; a code.
    Fault(u16),
}

/// What was heard of a wheel, forward counted as the wheel rolls, not as its motor turns.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wheel {
    pub heard: Option<Stamp>,
    pub condition: Condition,
    pub speed_mps: f32,
    /// Steps since the first report; goes on where a controller begins anew.
    pub total: i32,
    /// As reported last.
    position: Option<i32>,
    /// When.
    counted: Stamp,
    pub has_new_speed: bool,
    pub has_new_count: bool,
}

impl Wheel {
    /// A position; a motor that is mounted the other way round counts backwards.
    pub fn count(&mut self, position: i32, is_reversed: bool, now: Stamp) {
        let moved = self.position.map_or(0, |before| position.wrapping_sub(before));
        let forward = if is_reversed { moved.wrapping_neg() } else { moved };
        self.total = self.total.wrapping_add(forward);
        (self.position, self.counted, self.has_new_count) = (Some(position), now, true);
    }

    /// The same for a position in turns.
    pub fn count_turns(&mut self, turns: f32, counts_per_turn: f32, (is_reversed, now): (bool, Stamp)) {
        let steps = saturating_i64_of_f64(f64::from(turns) * f64::from(counts_per_turn));
        self.count(truncating_i32(steps), is_reversed, now);
    }

    pub const fn speed(&mut self, speed_mps: f32) {
        (self.speed_mps, self.has_new_speed) = (speed_mps, true);
    }

    /// Where the wheel is by now: controllers do not measure at the same moment.
    pub fn total_at(&self, now: Stamp, counts_per_m: f32) -> i32 {
        let ahead_s = match self.counted.age(now) {
            Age::Past(us) if us < LOST_US => now.seconds_since(self.counted),
            _ => 0.0,
        };
        self.total.wrapping_add(saturating_i32(self.speed_mps * ahead_s * libm::fabsf(counts_per_m)))
    }

    /// What was heard is too old.
    pub fn is_lost(&self, now: Stamp) -> bool {
        self.heard.is_some_and(|heard| !matches!(heard.age(now), Age::Past(us) if us < LOST_US))
    }

    /// Nothing is known any more; the wheel may turn any way meanwhile.
    pub fn forget(&mut self) {
        *self = Self { total: self.total, ..Self::default() };
    }
}
