//! Legs that move against each other: a walk that shows from any sensor, whatever moves it. Source: book, Legs: Gait.
//!
//! The distance between two legs of furniture stays what it is, even before a robot whose motion is unknown. That between
//! the feet of a walker grows and shrinks with every step.

use heapless::Vec;

use crate::legs::{LEG_TRACKS_MAX, SeenPair};
use floorguard_types::geometry::Point2;
use floorguard_types::time::{Age, Stamp};

/// A swing of the distance between two feet, metres: more than twice the noise of both places.
const SWING_MIN_M: f32 = 0.12;
/// Swings, growing and shrinking by turns, that make a walk.
const SWINGS_MIN: u8 = 3;
/// A swing that came later than this after the one before is the first of a new walk, µs.
const SWING_MAX_US: u64 = 2_000_000;
/// The middle of a pair is this near to where it was in the scan before, metres.
const NEAR_M: f32 = 0.4;
/// A distance that changes by more than this from one scan to the next is that of other legs, metres.
const JUMP_MAX_M: f32 = 0.4;
/// A pair that was not seen for this long is forgotten, µs.
const FORGOTTEN_US: u64 = 1_000_000;

/// How two legs move against each other.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Walker {
    newest: SeenPair,
    /// Least and greatest distance since the last swing.
    low_m: f32,
    high_m: f32,
    /// The distance grew in the last swing.
    grew: Option<bool>,
    swings: u8,
    swung: Stamp,
    has_walked: bool,
}

/// The pairs of one scanner.
#[derive(Clone, Debug, Default)]
pub(super) struct Gaits {
    walkers: Vec<Walker, LEG_TRACKS_MAX>,
}

impl Gaits {
    pub(super) const fn new() -> Self {
        Self { walkers: Vec::new() }
    }

    /// Takes in two legs; true if they have walked. The nearest pair of the scans before is the same.
    pub(super) fn see(&mut self, seen: &SeenPair) -> bool {
        let distance_m = |walker: &Walker| walker.newest.middle.distance(seen.middle);
        let known = self.walkers.iter_mut().filter(|walker| walker.newest.stamp != seen.stamp);
        let nearest = known.min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
        if let Some(walker) = nearest.filter(|walker| distance_m(walker) < NEAR_M) {
            walker.see(seen);
            return walker.has_walked;
        }
        // Out of space: the pair is new and has not walked.
        let _ = self.walkers.push(Walker::new(seen));
        false
    }

    /// Somebody who has walked was seen this near to a place a moment ago.
    pub(super) fn is_near_walker(&self, place: Point2, within_m: f32) -> bool {
        self.walkers.iter().any(|walker| walker.has_walked && walker.newest.middle.distance(place) < within_m)
    }

    /// Forgets pairs that were not seen for long.
    pub(super) fn forget(&mut self, now: Stamp) {
        self.walkers.retain(|walker| match walker.newest.stamp.age(now) {
            Age::Past(age_us) => age_us <= FORGOTTEN_US,
            Age::Future(_) => false,
        });
    }
}

impl Walker {
    const fn new(seen: &SeenPair) -> Self {
        let SeenPair { distance_m, stamp, .. } = *seen;
        Self {
            newest: *seen,
            low_m: distance_m,
            high_m: distance_m,
            grew: None,
            swings: 0,
            swung: stamp,
            has_walked: false,
        }
    }

    fn see(&mut self, seen: &SeenPair) {
        let SeenPair { distance_m, stamp, .. } = *seen;
        if (distance_m - self.newest.distance_m).abs() > JUMP_MAX_M {
            *self = Self { has_walked: self.has_walked, ..Self::new(seen) };
            return;
        }
        self.newest = *seen;
        self.low_m = self.low_m.min(distance_m);
        self.high_m = self.high_m.max(distance_m);
        let grew = distance_m - self.low_m >= SWING_MIN_M && self.grew != Some(true);
        let shrank = self.high_m - distance_m >= SWING_MIN_M && self.grew != Some(false);
        if grew || shrank {
            let is_soon = self.swung.past_us(stamp) <= SWING_MAX_US;
            self.swings = if is_soon { self.swings.saturating_add(1) } else { 1 };
            (self.grew, self.swung) = (Some(grew), stamp);
            (self.low_m, self.high_m) = (distance_m, distance_m);
            self.has_walked |= self.swings >= SWINGS_MIN;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a pair that passes the sensor has walked after four seconds, with this distance of its legs at a time.
    fn has_walked(distance_m: impl Fn(f32) -> f32) -> bool {
        let mut gaits = Gaits::new();
        (1..40_u64).fold(false, |walked, scan| {
            let seconds = 0.1 * scan as f32;
            let stamp = Stamp::from_micros(scan * 100_000);
            gaits.forget(stamp);
            let middle = Point2::new(2.0, 1.0 - 0.5 * seconds);
            walked | gaits.see(&SeenPair { middle, distance_m: distance_m(seconds), stamp })
        })
    }

    #[test]
    fn steps_walk_and_rigid_legs_do_not() {
        assert!(has_walked(|seconds| 0.35 + 0.2 * libm::sinf(9.0 * seconds)));
        // Legs of a chair with noise of some centimetres; a door that opens slowly; a pair that begins anew.
        assert!(!has_walked(|seconds| 0.4 + 0.06 * libm::sinf(40.0 * seconds)));
        assert!(!has_walked(|seconds| 0.2 + 0.2 * seconds));
        assert!(!has_walked(|seconds| if seconds % 0.5 < 0.25 { 0.2 } else { 0.9 }));
    }
}
