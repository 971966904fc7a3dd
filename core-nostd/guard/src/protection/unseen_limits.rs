//! How fast the body may go where no sensor sees all of what it goes into: a limit by direction, computed from the coverage of the
//! sensors when the robot is configured (book, Coverage of the sensors: What a hole costs).

use super::sweep::fastest_mps;
use super::swept_outline::BEND_PER_M;
use floorguard_types::geometry::{Point2, Twist2};

/// Slower than this the robot turns on the spot, m/s.
const SPIN_MPS: f32 = 0.05;
/// Slower than this it does not turn, rad/s.
const TURNS_RADPS: f32 = 0.02;
/// What was seen beside the way is still remembered when the robot has gone back so far, metres.
const BACK_M: f32 = 0.3;
/// A robot that has stood for longer does not know what came beside its rear, seconds.
const STOOD_S: f32 = 30.0;

/// Greatest speeds of the fastest point of the body, m/s, > 0; without a limit the greatest number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnseenLimits {
    /// Forward, nearly straight.
    pub forward_mps: f32,
    /// Forward in a bend.
    pub turning_mps: f32,
    /// On the spot.
    pub spinning_mps: f32,
    /// Backwards.
    pub reverse_mps: f32,
    /// In every turn, as long as it is not known what stands beside the rear.
    pub unknown_rear_mps: f32,
    /// It is known when the robot has driven so far ahead, metres; 0: a sensor looks there.
    pub known_after_m: f32,
}

impl UnseenLimits {
    /// Nothing is limited.
    pub const NONE: Self = Self {
        forward_mps: f32::MAX,
        turning_mps: f32::MAX,
        spinning_mps: f32::MAX,
        reverse_mps: f32::MAX,
        unknown_rear_mps: f32::MAX,
        known_after_m: 0.0,
    };

    /// All speeds, with their names.
    #[must_use]
    pub const fn speeds(&self) -> [(&'static str, f32); 5] {
        [
            ("forward", self.forward_mps),
            ("turning", self.turning_mps),
            ("spinning", self.spinning_mps),
            ("reverse", self.reverse_mps),
            ("turning beside an unknown rear", self.unknown_rear_mps),
        ]
    }

    /// The wanted motion at a speed that its direction permits: the same curve, never faster (FG-REQ-063, FG-REQ-064).
    #[must_use]
    pub fn limited(&self, wanted: Twist2, (outline, seen): (&[Point2], &SeenBeside)) -> Twist2 {
        let (speed_mps, turn_radps) = (wanted.linear_mps, wanted.angular_radps);
        let turns = turn_radps.abs() > TURNS_RADPS.max(BEND_PER_M * speed_mps.abs());
        let direction_mps = match (speed_mps < 0.0, turns) {
            (true, _) => self.reverse_mps,
            (false, false) => self.forward_mps,
            (false, true) if speed_mps < SPIN_MPS => self.spinning_mps,
            (false, true) => self.turning_mps,
        };
        let is_unknown = turns && seen.ahead_m() < self.known_after_m;
        let rear_mps = if is_unknown { self.unknown_rear_mps } else { f32::MAX };
        let share = direction_mps.min(rear_mps) / fastest_mps(outline, wanted).max(1.0e-6);
        let share = share.min(1.0);
        Twist2 { linear_mps: speed_mps * share, angular_radps: turn_radps * share }
    }
}

/// What a robot that looks ahead has seen of what is beside its rear now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeenBeside {
    /// So far ahead it has driven since it knew nothing, metres, less what it has gone back.
    pub(crate) ahead_m: f32,
    /// Its bits, inverted: a flipped one means that nothing is known.
    inverted: u32,
    stood_s: f32,
}

impl SeenBeside {
    /// Nothing was seen.
    pub const NOTHING: Self = Self { ahead_m: 0.0, inverted: 0, stood_s: 0.0 };

    fn ahead_m(&self) -> f32 {
        if self.inverted == !self.ahead_m.to_bits() { self.ahead_m } else { 0.0 }
    }

    /// The robot has moved for a time, as its wheels tell. `known_after_m`: more than this, and a little, is not counted.
    pub fn follow(&mut self, twist: Twist2, (step_s, known_after_m): (f32, f32)) {
        let stands = twist.linear_mps.abs() < SPIN_MPS && twist.angular_radps.abs() < TURNS_RADPS;
        self.stood_s = if stands { (self.stood_s + step_s).min(STOOD_S) } else { 0.0 };
        let ahead_m = (self.ahead_m() + twist.linear_mps * step_s).min(known_after_m + BACK_M).max(0.0);
        self.ahead_m = if self.stood_s < STOOD_S { ahead_m } else { 0.0 };
        self.inverted = !self.ahead_m.to_bits();
    }
}
