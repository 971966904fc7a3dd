//! One run: the judge moves the robot, checks whether it touches anything, and plays the scanner.

use floorguard_navigation::costmap::Beam;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::random::Pcg32;

use super::robot::{DRIVE, Which, jackal};
use super::stack::{PERIOD_S, Stack};
use super::world::World;

/// The scanner of the benchmark: 720 beams over 270°, 0.1 m to 30 m.
const BEAMS: u32 = 720;
const VIEW_RAD: f32 = 1.5 * std::f32::consts::PI;
const RANGE_M: f32 = 30.0;
const NOISE_M: f32 = 0.01;
/// The judge samples this often between two commands.
const SAMPLES: u32 = 5;
const TIME_MAX_S: f32 = 100.0;
/// The goal counts as reached within, metres.
const REACHED_M: f32 = 1.0;
/// The time runs from when the robot has moved so far, metres.
const STARTED_M: f32 = 0.1;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// At the goal, after so many seconds.
    Reached {
        /// Seconds since the robot began to move.
        time_s: f32,
    },
    /// It touched a cylinder.
    Collided {
        /// Seconds since the beginning.
        at_s: f32,
    },
    /// It was still driving after 100 s.
    TimedOut,
}

/// Drives a world; the seed is that of the scanner's noise and of the planner.
#[must_use]
pub fn drive(world: &World, which: Which, seed: u64) -> Outcome {
    let mut random = Pcg32::new(seed, u64::from(world.number));
    let mut stack = Stack::new(which, seed);
    let footprint = jackal();
    let (mut pose, mut twist) = (World::start(), Twist2::ZERO);
    let start = Point2::new(pose.x_m, pose.y_m);
    let mut started_s = None;
    for period in 0..(TIME_MAX_S / PERIOD_S) as u32 {
        let time_s = period as f32 * PERIOD_S;
        let place = Point2::new(pose.x_m, pose.y_m);
        if started_s.is_none() && place.distance(start) > STARTED_M {
            started_s = Some(time_s);
        }
        if place.distance(World::goal()) <= REACHED_M {
            return Outcome::Reached { time_s: time_s - started_s.unwrap_or(0.0) };
        }
        let beams: Vec<Beam> =
            (0..BEAMS).map(|beam| scan(world, (pose.heading_rad, place), beam, &mut random)).collect();
        let request = stack.command(pose, twist, &beams);
        for _ in 0..SAMPLES {
            let step_s = PERIOD_S / SAMPLES as f32;
            twist = DRIVE.reachable(twist, request, step_s);
            pose = pose.after(twist, step_s);
            let touches =
                |(middle, radius_m): &(Point2, f32)| footprint.clearance_m(pose, *middle) < *radius_m;
            if world.cylinders.iter().any(touches) {
                return Outcome::Collided { at_s: time_s };
            }
        }
    }
    Outcome::TimedOut
}

/// One beam in the map.
fn scan(world: &World, (heading_rad, from): (f32, Point2), beam: u32, random: &mut Pcg32) -> Beam {
    let direction_rad = heading_rad - 0.5 * VIEW_RAD + beam as f32 * VIEW_RAD / (BEAMS - 1) as f32;
    let range_m = world.range_m(from, direction_rad);
    let (sin, cos) = libm::sincosf(direction_rad);
    let end = |range_m: f32| Point2::new(from.x_m + range_m * cos, from.y_m + range_m * sin);
    if range_m > RANGE_M {
        Beam::Free(end(RANGE_M))
    } else {
        Beam::Hit(end(range_m + NOISE_M * random.normal()))
    }
}
