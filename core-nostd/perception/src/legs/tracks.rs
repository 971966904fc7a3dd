//! Leg tracks, and which two belong to one person. Source: book, Legs: Leg tracks. The closest partner is the partner
//! (the published code takes the last one within reach).

use heapless::Vec;

use super::detector::{LEGS_MAX, Leg};
use crate::tracking::{AppearanceOf, ConstantVelocity, DetectionOf, Surroundings};
use floorguard_types::geometry::Point2;
use floorguard_types::profile::Profile;
use floorguard_types::time::{Age, Stamp};

/// Legs followed at once.
pub const LEG_TRACKS_MAX: usize = 64;
/// Reliability that a leg of a person needs, as published.
const RELIABILITY_MIN: f32 = 0.7;
/// A leg that nobody saw for this long is given up, µs.
const TIMEOUT_US: u64 = 500_000;
/// A measurement farther from every track than this begins a new one, metres.
const JUMP_MAX_M: f32 = 0.75;
/// Legs farther apart than this belong to two people, metres.
const SEPARATION_M: f32 = 1.0;
/// A foot stops and starts with every step: acceleration density, m²/s³.
const DENSITY: f32 = 4.0;
/// Measurement noise, metres (covariance 0.0025 m²).
const SIGMA_M: f32 = 0.05;
/// The scalar filter of the reliability: first variance, growth a scan, noise of a classifier's probability.
const RELIABILITY_VARIANCE: f32 = 4.0;
const RELIABILITY_GROWTH: f32 = 0.002;
const RELIABILITY_NOISE: f32 = 10.0;

/// A followed leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegTrack {
    /// Unique since the start.
    pub id: u32,
    /// Position and velocity.
    pub state: ConstantVelocity,
    /// Belief that it is a leg, 0…1: filtered probability of the classifier.
    pub reliability: f32,
    /// Newest sighting.
    pub last_seen: Stamp,
    reliability_variance: f32,
}

/// Two legs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersonByLegs {
    /// Middle between the legs.
    pub position: Point2,
    /// The smaller reliability of both.
    pub reliability: f32,
    /// The legs, the older one first.
    pub legs: [u32; 2],
}

/// Two legs that were both seen in one scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenPair {
    /// Middle between them.
    pub middle: Point2,
    /// From one to the other, metres.
    pub distance_m: f32,
    /// The scan.
    pub stamp: Stamp,
}

impl PersonByLegs {
    /// Standard deviation of the position, metres (covariance (0.3 / reliability)²).
    #[must_use]
    pub fn sigma_m(&self) -> f32 {
        0.3 / self.reliability.max(0.1)
    }

    /// As a sighting, of a scanner at `sensor`.
    #[must_use]
    pub fn detection<P: Profile>(&self, sensor: Point2) -> DetectionOf<P> {
        DetectionOf {
            position: self.position,
            distance_m: self.position.distance(sensor),
            sigma_m: self.sigma_m(),
            likeness: self.reliability,
            points: 2,
            moving: None,
            surroundings: Surroundings::OPEN,
            appearance: AppearanceOf::UNKNOWN,
        }
    }
}

/// The legs of one scanner, in a fixed frame.
#[derive(Clone, Debug)]
pub struct LegTracker {
    /// Reliability that a leg of a person needs.
    reliability_min: f32,
    tracks: Vec<LegTrack, LEG_TRACKS_MAX>,
    next_id: u32,
    now: Option<Stamp>,
    /// Legs not followed because the list was full, since the start.
    pub dropped: u32,
    /// Scans refused because they were older than the newest one.
    pub late: u32,
}

impl Default for LegTracker {
    fn default() -> Self {
        Self::new()
    }
}

impl LegTracker {
    /// Nobody yet.
    #[must_use]
    pub const fn new() -> Self {
        Self::with_reliability(RELIABILITY_MIN)
    }

    /// Nobody yet; a leg of a person needs this reliability, 0…1.
    #[must_use]
    pub const fn with_reliability(reliability_min: f32) -> Self {
        Self { reliability_min, tracks: Vec::new(), next_id: 1, now: None, dropped: 0, late: 0 }
    }

    /// The legs, oldest first.
    #[must_use]
    pub fn tracks(&self) -> &[LegTrack] {
        &self.tracks
    }

    /// Takes in the legs of a scan, positions in the fixed frame. Tracks × legs × the smaller of both comparisons.
    pub fn update(&mut self, stamp: Stamp, legs: &[Leg]) {
        if let Some(now) = self.now {
            if !matches!(now.age(stamp), Age::Past(_)) {
                self.late = self.late.saturating_add(1);
                return;
            }
            let seconds = stamp.seconds_since(now);
            for track in &mut self.tracks {
                track.state.advance(seconds, DENSITY);
                track.reliability_variance += RELIABILITY_GROWTH;
            }
        }
        self.now = Some(stamp);
        let used = self.associate(stamp, legs);
        self.tracks.retain(|track| match track.last_seen.age(stamp) {
            Age::Past(age_us) => age_us <= TIMEOUT_US,
            Age::Future(_) => true,
        });
        for (leg, _) in legs.iter().zip(used).filter(|(_, used)| !used) {
            self.begin(stamp, leg);
        }
    }

    /// The nearest pair first, each track and each leg once.
    fn associate(&mut self, stamp: Stamp, legs: &[Leg]) -> [bool; LEGS_MAX] {
        let mut used = [false; LEGS_MAX];
        for _ in 0..LEG_TRACKS_MAX {
            let mut nearest: Option<(f32, usize, usize)> = None;
            for (row, track) in self.tracks.iter().enumerate().filter(|(_, track)| track.last_seen != stamp) {
                for (column, (leg, used)) in legs.iter().zip(used).enumerate() {
                    let distance_m = track.state.position.distance(leg.position);
                    let better = nearest.is_none_or(|(other, ..)| distance_m < other);
                    if !used && distance_m < JUMP_MAX_M && better {
                        nearest = Some((distance_m, row, column));
                    }
                }
            }
            let Some((_, row, column)) = nearest else { break };
            if let (Some(track), Some(leg), Some(used)) =
                (self.tracks.get_mut(row), legs.get(column), used.get_mut(column))
            {
                track.see(stamp, leg);
                *used = true;
            }
        }
        used
    }

    fn begin(&mut self, stamp: Stamp, leg: &Leg) {
        let fresh = LegTrack {
            id: self.next_id,
            state: ConstantVelocity::new(leg.position, Point2::default(), 0.1, 1.0),
            reliability: leg.probability,
            last_seen: stamp,
            reliability_variance: RELIABILITY_VARIANCE,
        };
        if self.tracks.push(fresh).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        } else {
            self.next_id = self.next_id.wrapping_add(1).max(1);
        }
    }

    /// One at least of two legs was seen in the newest scan.
    #[must_use]
    pub fn is_seen_now(&self, legs: [u32; 2]) -> bool {
        let mut seen = self.tracks.iter().filter(|track| Some(track.last_seen) == self.now);
        seen.any(|track| legs.contains(&track.id))
    }

    /// Two legs as they are, if both were seen in the newest scan.
    #[must_use]
    pub fn seen_pair(&self, legs: [u32; 2]) -> Option<SeenPair> {
        let stamp = self.now?;
        let place = |id: u32| {
            let mut seen = self.tracks.iter().filter(|track| track.last_seen == stamp);
            seen.find(|track| track.id == id).map(|track| track.state.position)
        };
        let [one, other] = legs;
        let (one, other) = (place(one)?, place(other)?);
        let middle = Point2::new(0.5 * (one.x_m + other.x_m), 0.5 * (one.y_m + other.y_m));
        Some(SeenPair { middle, distance_m: one.distance(other), stamp })
    }

    /// Pairs legs into people, the closest two first; hands out each person.
    pub fn people(&self, mut found: impl FnMut(PersonByLegs)) {
        let mut taken = [false; LEG_TRACKS_MAX];
        for _ in 0..LEG_TRACKS_MAX / 2 {
            let mut closest: Option<(f32, usize, usize)> = None;
            for (row, (one, used)) in self.tracks.iter().zip(taken).enumerate() {
                if used || one.reliability <= self.reliability_min {
                    continue;
                }
                for (column, (other, used)) in
                    self.tracks.iter().zip(taken).enumerate().skip(row.saturating_add(1))
                {
                    let distance_m = one.state.position.distance(other.state.position);
                    let fits = !used && other.reliability > self.reliability_min && distance_m < SEPARATION_M;
                    if fits && closest.is_none_or(|(nearest_m, ..)| distance_m < nearest_m) {
                        closest = Some((distance_m, row, column));
                    }
                }
            }
            let Some((_, row, column)) = closest else { break };
            for index in [row, column] {
                if let Some(slot) = taken.get_mut(index) {
                    *slot = true;
                }
            }
            if let (Some(one), Some(other)) = (self.tracks.get(row), self.tracks.get(column)) {
                let (a, b) = (one.state.position, other.state.position);
                found(PersonByLegs {
                    position: Point2::new(0.5 * (a.x_m + b.x_m), 0.5 * (a.y_m + b.y_m)),
                    reliability: one.reliability.min(other.reliability),
                    legs: [one.id, other.id],
                });
            }
        }
    }
}

impl LegTrack {
    fn see(&mut self, stamp: Stamp, leg: &Leg) {
        self.state.correct(leg.position, SIGMA_M);
        self.last_seen = stamp;
        let gain = self.reliability_variance / (self.reliability_variance + RELIABILITY_NOISE);
        self.reliability += gain * (leg.probability - self.reliability);
        self.reliability_variance *= 1.0 - gain;
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    fn leg(x_m: f32, y_m: f32) -> Leg {
        Leg { position: Point2::new(x_m, y_m), probability: 0.95, points: 8 }
    }

    /// Two people side by side, 0.3 m between the legs of each, 0.9 m from one to the other.
    #[test]
    fn closest_legs_pair_and_keep_identity() {
        let mut tracker = LegTracker::new();
        for step in 0..40_u64 {
            let along_m = 0.04 * step as f32;
            let legs = [0.0, 0.3, 0.9, 1.2].map(|y_m| leg(along_m, y_m));
            tracker.update(Stamp::from_micros(step * 40_000), &legs);
        }
        let mut people = Vec::new();
        tracker.people(|person| people.push(person));
        people.sort_by(|a, b| a.position.y_m.total_cmp(&b.position.y_m));
        assert_eq!(people.len(), 2);
        assert!((people[0].position.y_m - 0.15).abs() < 0.02 && (people[1].position.y_m - 1.05).abs() < 0.02);
        assert_eq!((people[0].legs, people[1].legs), ([1, 2], [3, 4]));
        assert!((tracker.tracks()[0].state.velocity.x_m - 1.0).abs() < 0.1);
    }

    #[test]
    fn lost_leg_is_dropped_old_scan_refused() {
        let mut tracker = LegTracker::new();
        tracker.update(Stamp::from_micros(100_000), &[leg(1.0, 0.0)]);
        tracker.update(Stamp::from_micros(50_000), &[leg(2.0, 0.0)]);
        assert_eq!((tracker.tracks().len(), tracker.late), (1, 1));
        tracker.update(Stamp::from_micros(700_000), &[]);
        assert!(tracker.tracks().is_empty());
    }
}
