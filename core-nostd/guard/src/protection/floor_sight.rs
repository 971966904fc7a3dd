//! What the floor camera tells the rings: objects on the floor ahead, and whether the floor is known at all.
//!
//! It can only tighten. An object of two centimetres on the path is no reason for an emergency stop, but none to drive
//! over it either: the robot may be only so fast that it stands before it. Where a camera is configured and its floor
//! is not known, nobody drives faster than the guard lets in a warning zone; a robot without one is as before.

use floorguard_types::geometry::Point2;
use floorguard_types::time::{Age, Stamp};
use heapless::Vec;

use super::Advice;

/// Objects in one report; more are dropped farthest first, because the nearest one decides.
pub const FLOOR_OBSTACLES_MAX: usize = 8;
/// A sight this old says nothing any more, µs: fifteen frames of a camera at 30 Hz.
pub const SIGHT_MAX_US: u64 = 500_000;
/// Lower objects are driven over, metres (book, Guard: Floor camera speed).
pub const OBSTACLE_HEIGHT_MIN_M: f32 = 0.014;

/// One object on the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloorObstacle {
    /// Its nearest point, in the robot's frame.
    pub position: Point2,
    /// Half of its width across the robot, metres.
    pub half_width_m: f32,
    /// Height above the floor, metres.
    pub height_m: f32,
}

/// One look at the floor. Who has a camera publishes one at the start, on which nothing is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FloorSight {
    /// When the picture was taken.
    pub stamp: Stamp,
    /// False where the camera is dark, frozen, silent, or shows no floor: it is unknown, neither free nor clean.
    pub is_known: bool,
    /// Objects that several frames showed, nearest first.
    pub obstacles: Vec<FloorObstacle, FLOOR_OBSTACLES_MAX>,
    /// What the robot makes of it.
    pub limits: FloorLimits,
}

/// What turns a sight into a limit. The default lets nothing move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloorLimits {
    /// Half of the robot's width with a margin, metres.
    pub half_width_m: f32,
    /// Where the body ends in front, metres before the robot's origin.
    pub front_m: f32,
    /// Braking that is reached, m/s².
    pub braking_mps2: f32,
    /// From the decision to the brake's effect, with the age of a frame, seconds.
    pub response_s: f32,
    /// Speed over unknown floor, m/s.
    pub unknown_speed_mps: f32,
}

/// Keeps this far from an object, metres.
const MARGIN_M: f32 = 0.05;

impl FloorSight {
    /// The highest speed that it allows; `None` for no limit.
    #[must_use]
    pub fn speed_limit_mps(&self, now: Stamp) -> Option<f32> {
        let limits = &self.limits;
        let is_fresh = matches!(self.stamp.age(now), Age::Past(age_us) if age_us <= SIGHT_MAX_US);
        if !is_fresh || !self.is_known {
            return Some(limits.unknown_speed_mps);
        }
        let on_path = self.obstacles.iter().filter(|obstacle| {
            obstacle.height_m >= OBSTACLE_HEIGHT_MIN_M
                && obstacle.position.x_m > limits.front_m - MARGIN_M
                && obstacle.position.y_m.abs() - obstacle.half_width_m < limits.half_width_m
        });
        let free_m = on_path.map(|obstacle| obstacle.position.x_m - limits.front_m - MARGIN_M);
        free_m.min_by(f32::total_cmp).map(|free_m| limits.stops_within_mps(free_m.max(0.0)))
    }
}

impl FloorLimits {
    /// The speed from which the robot stands within a distance: the root of `v²/2b + v t = s`.
    fn stops_within_mps(&self, distance_m: f32) -> f32 {
        let lost = self.braking_mps2 * self.response_s;
        libm::sqrtf(lost * lost + 2.0 * self.braking_mps2 * distance_m) - lost
    }
}

/// The advice with what the camera adds; without a camera it stays as it is.
#[must_use]
pub fn with_floor(mut advice: Advice, sight: Option<&FloorSight>, now: Stamp) -> Advice {
    let limit = sight.and_then(|sight| sight.speed_limit_mps(now));
    advice.speed_limit_mps = match (advice.speed_limit_mps, limit) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    };
    advice
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: FloorLimits = FloorLimits {
        half_width_m: 0.45,
        front_m: 0.95,
        braking_mps2: 0.8,
        response_s: 0.25,
        unknown_speed_mps: 0.3,
    };
    const NOW: Stamp = Stamp::from_micros(10_000_000);

    fn sight(obstacles: &[(f32, f32, f32)]) -> FloorSight {
        let obstacle = |(x_m, y_m, height_m): &(f32, f32, f32)| FloorObstacle {
            position: Point2::new(*x_m, *y_m),
            half_width_m: 0.03,
            height_m: *height_m,
        };
        FloorSight {
            stamp: NOW,
            is_known: true,
            obstacles: obstacles.iter().map(obstacle).collect(),
            limits: LIMITS,
        }
    }

    fn limit(sight: FloorSight) -> Option<f32> {
        with_floor(Advice::default(), Some(&sight), NOW).speed_limit_mps
    }

    /// The robot stops before the nearest obstacle on its path; what lies beside it or is flat does not
    /// count.
    #[test]
    fn stops_before_obstacles_on_the_path() {
        let found = limit(sight(&[(1.6, 0.2, 0.02), (1.2, 0.6, 0.05), (1.1, 0.0, 0.008)])).unwrap();
        let distance_m = found * found / (2.0 * 0.8) + found * 0.25;
        assert!((distance_m - 0.6).abs() < 1e-3, "{found} m/s needs {distance_m} m");
        assert_eq!(limit(sight(&[(0.96, 0.0, 0.05)])), Some(0.0));
        assert_eq!(limit(sight(&[(1.2, 0.6, 0.05)])), None);
        assert_eq!(limit(sight(&[(0.2, 0.0, 0.05)])), None, "under the robot");
    }

    #[test]
    fn unknown_floor_is_driven_over_slowly() {
        let unknown = FloorSight { is_known: false, ..sight(&[]) };
        let old = FloorSight { stamp: Stamp::from_micros(9_400_000), ..sight(&[]) };
        let early = FloorSight { stamp: Stamp::from_micros(10_000_001), ..sight(&[]) };
        for bad in [unknown, old, early] {
            assert_eq!(limit(bad.clone()), Some(0.3), "{bad:?}");
        }
        assert_eq!(limit(sight(&[])), None);
    }

    /// It never loosens what perception says, and a robot without a camera is as before.
    #[test]
    fn only_tightens() {
        let slow = || Advice { speed_limit_mps: Some(0.1), ..Advice::default() };
        let with = |sight: FloorSight| with_floor(slow(), Some(&sight), NOW).speed_limit_mps;
        assert_eq!(with(sight(&[])), Some(0.1));
        assert_eq!(with(sight(&[(2.0, 0.0, 0.05)])), Some(0.1));
        assert_eq!(with_floor(slow(), None, NOW), slow());
    }
}
