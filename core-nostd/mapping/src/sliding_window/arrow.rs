//! Where people walk: positions of a person in two different sweeps.
//!
//! The published arrow takes two readings that follow each other (Dalmedico et al. 2019). Readings of
//! neighbouring columns lie on different parts of the body, so that their difference shows the sweep and not the person:
//! here all returns of one sweep make one sighting, and two sightings of different sweeps make an arrow.

use floorguard_types::geometry::Point2;
use floorguard_types::number::nearest_f32;
use floorguard_types::time::Stamp;
use heapless::Vec;

use super::capacities::PERSON_BOXES_MAX;

/// Standard deviation of a sighting for a tracker, metres: half a body, seen from one side.
pub const SIGHTING_SIGMA_M: f32 = 0.15;
/// Two sightings make an arrow if they lie so far apart in time, seconds.
const INTERVAL_S: core::ops::RangeInclusive<f32> = 0.1..=2.0;
/// Faster people are two people, m/s.
const SPEED_MAX_MPS: f32 = 2.5;
/// Returns of one sweep that lie so far apart are of one person, metres: a stride.
const BODY_M: f32 = 0.8;
/// A sweep has left a person from whom no return came for so long: two scans of ten a second, microseconds.
const PASSED_US: u64 = 250_000;
/// Fewer returns are no person.
const RETURNS_MIN: u16 = 5;
/// A person of unknown velocity walks no faster than this most of the time, m/s.
const WALK_MPS: f32 = 0.8;

/// A person as one sweep saw them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sighting {
    /// Mean place of the returns, in odometry.
    pub position_in_odometry: Point2,
    /// Mean time of the returns.
    pub stamp: Stamp,
    /// How many.
    pub returns: u16,
}

/// Where a person is, and how they walk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovementArrow {
    /// The newer sighting, in odometry.
    pub position_in_odometry: Point2,
    /// Velocity along x and y of odometry, m/s.
    pub velocity_x_mps: f32,
    /// See `velocity_x_mps`.
    pub velocity_y_mps: f32,
    /// Of the newer sighting.
    pub stamp: Stamp,
}

impl MovementArrow {
    /// Speed, m/s.
    #[must_use]
    pub fn speed_mps(&self) -> f32 {
        Point2::new(self.velocity_x_mps, self.velocity_y_mps).norm()
    }

    /// Direction of the walk in odometry, radians.
    #[must_use]
    pub fn heading_rad(&self) -> f32 {
        libm::atan2f(self.velocity_y_mps, self.velocity_x_mps)
    }
}

/// A person whom the sweep has left behind: a detection for a tracker.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassedPerson {
    /// When the last return came.
    pub stamp: Stamp,
    /// Where the person was then: the mean of the returns, moved on by the velocity if that is known, in odometry.
    pub position_in_odometry: Point2,
    /// Standard deviation, metres: greater where the velocity is unknown.
    pub sigma_m: f32,
    /// How many returns.
    pub returns: u16,
}

/// Returns of a person in the sweep so far.
#[derive(Clone, Copy, Debug)]
struct Gathered {
    sum: Point2,
    /// Sum of times since the first return, seconds.
    seconds: f32,
    first: Stamp,
    last: Stamp,
    returns: u16,
    /// It was given to the tracker.
    is_given: bool,
}

impl Gathered {
    fn sighting(&self) -> Sighting {
        let share = 1.0 / nearest_f32(self.returns.max(1));
        let micros = floorguard_types::number::saturating_u64(self.seconds * share * 1.0e6);
        Sighting {
            position_in_odometry: Point2::new(self.sum.x_m * share, self.sum.y_m * share),
            stamp: self.first.plus_micros(micros),
            returns: self.returns,
        }
    }
}

/// Sightings of two sweeps.
///
/// ```
/// use floorguard_mapping::sliding_window::MovementArrows;
/// use floorguard_types::{geometry::Point2, time::Stamp};
///
/// let mut arrows = MovementArrows::new();
/// arrows.take(Point2::new(2.0, 0.0), Stamp::from_micros(1_000_000));
/// arrows.end_sweep();
/// arrows.take(Point2::new(2.0, 0.5), Stamp::from_micros(1_500_000));
/// arrows.end_sweep();
/// let arrow = arrows.arrows()[0];
/// assert!((arrow.speed_mps() - 1.0).abs() < 1.0e-3);
/// ```
#[derive(Clone, Debug, Default)]
pub struct MovementArrows {
    gathered: Vec<Gathered, PERSON_BOXES_MAX>,
    before: Vec<Sighting, PERSON_BOXES_MAX>,
    arrows: Vec<MovementArrow, PERSON_BOXES_MAX>,
    dropped: u32,
}

impl MovementArrows {
    /// Without any sighting.
    #[must_use]
    pub const fn new() -> Self {
        Self { gathered: Vec::new(), before: Vec::new(), arrows: Vec::new(), dropped: 0 }
    }

    /// Takes a return within a person's box, in odometry. What is not finite, or belongs to a seventeenth person, is dropped
    /// and counted.
    pub fn take(&mut self, position_in_odometry: Point2, stamp: Stamp) {
        if !position_in_odometry.norm().is_finite() {
            self.dropped = self.dropped.saturating_add(1);
            return;
        }
        let is_same =
            |one: &&mut Gathered| one.sighting().position_in_odometry.distance(position_in_odometry) < BODY_M;
        if let Some(same) = self.gathered.iter_mut().find(is_same) {
            same.sum.x_m += position_in_odometry.x_m;
            same.sum.y_m += position_in_odometry.y_m;
            same.seconds += stamp.seconds_since(same.first);
            same.returns = same.returns.saturating_add(1);
            same.last = stamp;
            return;
        }
        let first = Gathered {
            sum: position_in_odometry,
            seconds: 0.0,
            first: stamp,
            last: stamp,
            returns: 1,
            is_given: false,
        };
        if self.gathered.push(first).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// The next person whom the sweep has left behind, each once a sweep; `None` when all were given. A sweep takes seconds: at its
    /// end the first people of it would be too old for a tracker. Cost: 16 comparisons.
    pub fn next_passed(&mut self, now: Stamp) -> Option<PassedPerson> {
        let is_passed = |one: &&mut Gathered| {
            !one.is_given && one.returns >= RETURNS_MIN && one.last.past_us(now) >= PASSED_US
        };
        let passed = self.gathered.iter_mut().find(is_passed)?;
        passed.is_given = true;
        let (sighting, last) = (passed.sighting(), passed.last);
        let since_s = last.seconds_since(sighting.stamp);
        let known = self.before.iter().filter_map(|before| arrow(before, &sighting));
        let slowest = known.min_by(|a, b| a.speed_mps().total_cmp(&b.speed_mps()));
        let velocity = slowest.map_or((0.0, 0.0), |arrow| (arrow.velocity_x_mps, arrow.velocity_y_mps));
        let mean = sighting.position_in_odometry;
        Some(PassedPerson {
            stamp: last,
            position_in_odometry: Point2::new(
                mean.x_m + velocity.0 * since_s,
                mean.y_m + velocity.1 * since_s,
            ),
            sigma_m: SIGHTING_SIGMA_M + if slowest.is_some() { 0.0 } else { WALK_MPS * since_s },
            returns: sighting.returns,
        })
    }

    /// Ends the sweep: the motor reverses. Sightings become arrows with the nearest plausible ones of the sweep before. Cost:
    /// 256 comparisons at most.
    pub fn end_sweep(&mut self) {
        self.arrows.clear();
        let mut now = Vec::<Sighting, PERSON_BOXES_MAX>::new();
        for gathered in self.gathered.iter().take(PERSON_BOXES_MAX) {
            let sighting = gathered.sighting();
            let near = self.before.iter().filter_map(|before| arrow(before, &sighting));
            let slowest = near.min_by(|a, b| a.speed_mps().total_cmp(&b.speed_mps()));
            if let Some(arrow) = slowest {
                // As many arrows as sightings at most: never full.
                let _full = self.arrows.push(arrow);
            }
            let _full = now.push(sighting);
        }
        self.gathered.clear();
        self.before = now;
    }

    /// The arrows of the newest sweep.
    #[must_use]
    pub fn arrows(&self) -> &[MovementArrow] {
        &self.arrows
    }

    /// The sightings of the newest sweep: detections for a tracker, with [`SIGHTING_SIGMA_M`].
    #[must_use]
    pub fn sightings(&self) -> &[Sighting] {
        &self.before
    }

    /// Returns that were dropped.
    #[must_use]
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }
}

/// The arrow of two sightings; `None` if they cannot be one person.
fn arrow(before: &Sighting, after: &Sighting) -> Option<MovementArrow> {
    let seconds = after.stamp.seconds_since(before.stamp);
    if !INTERVAL_S.contains(&seconds) {
        return None;
    }
    let (from, to) = (before.position_in_odometry, after.position_in_odometry);
    let arrow = MovementArrow {
        position_in_odometry: to,
        velocity_x_mps: (to.x_m - from.x_m) / seconds,
        velocity_y_mps: (to.y_m - from.y_m) / seconds,
        stamp: after.stamp,
    };
    (arrow.speed_mps() <= SPEED_MAX_MPS).then_some(arrow)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep(arrows: &mut MovementArrows, places: &[(f32, f32)], millis: u64) {
        for (x_m, y_m) in places {
            arrows.take(Point2::new(*x_m, *y_m), Stamp::from_micros(1_000 * millis));
        }
        arrows.end_sweep();
    }

    #[test]
    fn implausible_pairs_give_no_arrow() {
        let mut arrows = MovementArrows::new();
        sweep(&mut arrows, &[(2.0, 0.0)], 1_000);
        assert!(arrows.arrows().is_empty() && arrows.sightings().len() == 1);
        sweep(&mut arrows, &[(2.0, 2.0)], 1_500);
        assert!(arrows.arrows().is_empty(), "4 m/s");
        sweep(&mut arrows, &[(2.0, 2.0)], 1_550);
        assert!(arrows.arrows().is_empty(), "50 ms");
        sweep(&mut arrows, &[(2.0, 2.0)], 3_600);
        assert!(arrows.arrows().is_empty(), "2.05 s");
        sweep(&mut arrows, &[(2.0, 2.5)], 4_600);
        assert!((arrows.arrows()[0].heading_rad() - core::f32::consts::FRAC_PI_2).abs() < 1e-6);
        arrows.take(Point2::new(f32::NAN, 0.0), Stamp::ZERO);
        assert_eq!(arrows.dropped(), 1);
    }

    /// Each person once, soon after the sweep has left them; moved on where two sweeps show how they walk.
    #[test]
    fn passed_people_are_given_once() {
        let mut arrows = MovementArrows::new();
        for (begin_ms, from_m) in [(0, 0.0), (1_500, 0.6)] {
            for scan in 0..6_u64 {
                let along_m = from_m + 0.04 * scan as f32;
                arrows.take(Point2::new(2.0, along_m), Stamp::from_micros(1_000 * (begin_ms + 100 * scan)));
            }
            assert_eq!(arrows.next_passed(Stamp::from_micros(1_000 * (begin_ms + 700))), None);
            let now = Stamp::from_micros(1_000 * (begin_ms + 750));
            let person = arrows.next_passed(now).unwrap();
            assert_eq!((person.stamp, person.returns), (Stamp::from_micros(1_000 * (begin_ms + 500)), 6));
            let (behind_m, sigma_m) = if begin_ms == 0 { (0.1, 0.35) } else { (0.0, 0.15) };
            let at_m = from_m + 0.2 - behind_m;
            assert!((person.position_in_odometry.y_m - at_m).abs() < 1e-3, "{person:?}");
            assert!((person.sigma_m - sigma_m).abs() < 1e-3, "{person:?}");
            assert_eq!(arrows.next_passed(now), None);
            arrows.end_sweep();
        }
        arrows.take(Point2::new(2.0, 0.0), Stamp::ZERO);
        assert_eq!(arrows.next_passed(Stamp::from_micros(9_000_000)), None, "one return is no person");
    }

    #[test]
    fn two_people_keep_their_arrows() {
        let mut arrows = MovementArrows::new();
        sweep(&mut arrows, &[(2.0, 1.0), (2.1, 1.0), (2.0, -1.0)], 0);
        sweep(&mut arrows, &[(2.0, -0.5), (2.0, 0.5), (2.1, 0.5)], 1_000);
        let speeds: std::vec::Vec<f32> = arrows.arrows().iter().map(|arrow| arrow.velocity_y_mps).collect();
        assert_eq!(speeds.len(), 2);
        assert!((speeds[0] - 0.5).abs() < 1e-5 && (speeds[1] + 0.5).abs() < 1e-5);
    }
}
