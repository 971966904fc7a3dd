//! Where and when a drive begins: on a circle around the busiest place, at a moment at which people are there.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;

use super::recording::Recording;

/// From the middle to start and goal, metres: the drive goes right through.
pub const RADIUS_M: f32 = 6.5;
/// At the start nobody is nearer to the robot's base point, metres.
const CLEAR_M: f32 = 2.0;
/// People within the circle at the start at least.
const PEOPLE_MIN: usize = 3;
/// Recording that must be left, seconds.
const LEFT_S: f32 = 60.0;
/// Moments that are tried.
const TRIES: u32 = 10_000;

/// A drive to come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Where the robot is, headed for the goal.
    pub pose: Pose2,
    /// Where it shall be.
    pub goal: Point2,
    /// Seconds of the recording.
    pub begins_s: f32,
}

/// A start of a recording; `None`: the recording has no such moment.
#[must_use]
pub fn draw(recording: &Recording, seed: u64) -> Option<Start> {
    let mut random = Pcg32::new(seed, 0x5045);
    let middle = recording.middle;
    (0..TRIES).find_map(|_| {
        let begins_s = random.uniform_between(0.0, (recording.ends_s - LEFT_S).max(0.0));
        let from_rad = random.uniform_between(-core::f32::consts::PI, core::f32::consts::PI);
        let (sin, cos) = libm::sincosf(from_rad);
        let at = |by_m: f32| Point2::new(middle.x_m + by_m * cos, middle.y_m + by_m * sin);
        let place = at(RADIUS_M);
        let within = recording.at(begins_s).filter(|other| other.distance(middle) < RADIUS_M).count();
        let is_clear = recording.at(begins_s).all(|other| other.distance(place) > CLEAR_M);
        let pose = Pose2::new(place.x_m, place.y_m, from_rad + core::f32::consts::PI);
        (within >= PEOPLE_MIN && is_clear).then_some(Start { pose, goal: at(-RADIUS_M), begins_s })
    })
}
