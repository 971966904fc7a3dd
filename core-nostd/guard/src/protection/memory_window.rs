//! Where the window of the memory lies: ahead of the robot, and around it while it backs over ground that it has not come over.
//!
//! The lidar sees low objects from afar alone, behind the robot as ahead of it. A robot that goes back the way it came needs
//! nothing from behind; one that backs from where it was switched on, or after a turn, does.

use super::local_memory::CELL_M;
use floorguard_types::geometry::Twist2;

/// The middle of the window lies so far ahead of the robot's origin, metres, where the ground ahead matters.
const AHEAD_M: f32 = 1.35;
/// And so far where the robot backs onto ground that it has never come over, metres: the lowest ring meets the top of a box of 10 cm at
/// 2.6 m from the lidar, 2.1 m behind the origin.
const AROUND_M: f32 = 0.0;
/// So much of the ground behind is known, metres: as much as the robot has come ahead, at most this.
const KNOWN_MAX_M: f32 = 3.0;
/// With less of it left the window goes back, metres. A robot that has backed by the rest sees again what leaves the window ahead.
const KNOWN_LEAST_M: f32 = 1.5;
/// A turn by one radian takes so much of what is known behind, metres: half a turn takes all of it.
const TURN_TAKES_M: f32 = 1.0;
/// Slower than this it does not back, m/s.
const BACKS_MPS: f32 = 0.01;
/// Slower than this it does not drive ahead, m/s: the wheels say that it does so a little while it turns on the spot, or its steering goes
/// from one end to the other.
const COMES_MPS: f32 = 0.05;

/// Where the window lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemoryWindow {
    /// Ahead of the origin, metres.
    middle_m: f32,
    /// Ground behind that the robot has come over, metres.
    known_m: f32,
}

impl MemoryWindow {
    /// Of a robot that has not moved.
    pub const BEGUN: Self = Self { middle_m: AHEAD_M, known_m: 0.0 };

    /// Its middle, ahead of the robot's origin, metres.
    pub const fn middle_m(&self) -> f32 {
        self.middle_m
    }

    /// The robot has moved for a time, seconds. The window moves by a cell at most, so that no step costs more than another.
    pub fn follow(&mut self, twist: Twist2, step_s: f32) {
        let come_m = twist.linear_mps * step_s - TURN_TAKES_M * (twist.angular_radps * step_s).abs();
        let known_m = self.known_m + come_m;
        self.known_m = if known_m.is_nan() { 0.0 } else { known_m.clamp(0.0, KNOWN_MAX_M) };
        let share = (self.known_m / KNOWN_LEAST_M).min(1.0);
        let wanted_m = if twist.linear_mps > COMES_MPS {
            AHEAD_M
        } else if twist.linear_mps < -BACKS_MPS {
            self.middle_m.min(AROUND_M + share * (AHEAD_M - AROUND_M))
        } else {
            self.middle_m
        };
        let step_m = (wanted_m - self.middle_m).clamp(-CELL_M, CELL_M);
        self.middle_m = (self.middle_m + step_m).clamp(AROUND_M, AHEAD_M);
    }
}
