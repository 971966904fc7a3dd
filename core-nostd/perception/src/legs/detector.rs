//! From a scan to its legs.

use heapless::Vec;

use super::cues::{PlaceEvidence, leg_cues};
use super::features::leg_features;
use super::segments::SegmentsOf;
use super::stumps::{KnownPlaces, leg_score, leg_score_near_floor};
use crate::shapes::person_model::probability;
use floorguard_types::geometry::Point2;
use floorguard_types::number::{nearest_f32, truncating_u16};
use floorguard_types::profile::{Native, Profile};
use floorguard_types::sensing::ScanOf;

/// What may be a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegLimits {
    /// Returns nearer to each other than this belong together, metres. The published code has 0.06; coarse beams need
    /// more, and the labels of the training scans were made with this.
    pub gap_m: f32,
    /// Segments with fewer returns are dropped (3 for scanners of 0.5°; book, Legs: Segments).
    pub points_min: usize,
    /// Segments farther than this have too few returns, metres.
    pub range_max_m: f32,
    /// Wider segments are walls, whatever else they look like, metres: nobody needs to look closer at them.
    pub width_max_m: f32,
    /// Score from which a segment is a leg.
    pub score_min: f32,
}

impl LegLimits {
    /// The values of the parameters' own documentation.
    pub const DEFAULT: Self =
        Self { gap_m: 0.13, points_min: 3, range_max_m: 10.0, width_max_m: 0.8, score_min: 0.0 };
}

impl Default for LegLimits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Mean of its returns, sensor frame, metres.
    pub position: Point2,
    /// Probability that it is one.
    pub probability: f32,
    /// Its returns.
    pub points: u16,
}

/// Legs kept of a scan; the farthest are dropped first and counted.
pub const LEGS_MAX: usize = 64;

/// The legs of a scan.
#[derive(Clone, Copy, Debug)]
pub struct LegOutput<'a> {
    /// Legs, in the order of the beams.
    pub legs: &'a [Leg],
    /// Segments that were examined.
    pub segments: u32,
    /// Legs dropped because the list was full.
    pub dropped: u32,
}

/// Working memory; one a scanner.
///
/// ```
/// use floorguard_perception::legs::LegDetector;
/// use floorguard_types::{geometry::Point2, sensing::{BeamReturn, Scan}};
///
/// // A wall 3 m away is wider than any leg: it is not even looked at.
/// let mut scan = Scan { first_angle_rad: -0.3, step_rad: 0.01, ..Scan::EMPTY };
/// scan.beams.extend((0..60).map(|_| BeamReturn::Hit(3_000)));
/// let mut detector = Box::new(LegDetector::new());
/// let output = detector.process(&scan, None::<fn(Point2) -> bool>);
/// assert_eq!((output.legs.len(), output.segments), (0, 0));
/// ```
#[derive(Clone, Debug)]
pub struct LegDetectorOf<P: Profile> {
    /// What may be a leg.
    pub limits: LegLimits,
    /// The scanner is a coarse one near the floor: a committee of its own judges where no map is known.
    pub near_floor: bool,
    segments: SegmentsOf<P>,
    legs: Vec<Leg, LEGS_MAX>,
}

/// A detector in the memory of the target.
pub type LegDetector = LegDetectorOf<Native>;

impl<P: Profile> Default for LegDetectorOf<P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: Profile> LegDetectorOf<P> {
    /// With the default limits.
    #[must_use]
    pub const fn new() -> Self {
        Self { limits: LegLimits::DEFAULT, near_floor: false, segments: SegmentsOf::new(), legs: Vec::new() }
    }

    /// With the default limits, for a coarse scanner near the floor, such as a safety scanner.
    #[must_use]
    pub const fn near_floor() -> Self {
        let mut detector = Self::new();
        detector.near_floor = true;
        detector
    }

    /// Takes in a scan. The map tells of a point of the sensor's frame whether something stands there, which is then no
    /// leg; `None` where no map is known.
    pub fn process(&mut self, scan: &ScanOf<P>, map: Option<impl Fn(Point2) -> bool>) -> LegOutput<'_> {
        self.process_by(scan, map, |_| None)
    }

    /// The same by what earlier scans showed at the places of the segments, too, points of the sensor's frame.
    pub fn process_by(
        &mut self,
        scan: &ScanOf<P>,
        map: Option<impl Fn(Point2) -> bool>,
        evidence: impl Fn(&[Point2]) -> Option<PlaceEvidence>,
    ) -> LegOutput<'_> {
        self.segments.cut(scan, self.limits.gap_m);
        self.legs.clear();
        let (mut examined, mut dropped) = (0_u32, 0_u32);
        for segment in self.segments.iter().filter(|segment| segment.points.len() >= self.limits.points_min) {
            let position = centre(segment.points);
            let width_m =
                segment.points.first().zip(segment.points.last()).map_or(0.0, |(a, b)| a.distance(*b));
            if position.norm() > self.limits.range_max_m || width_m > self.limits.width_max_m {
                continue;
            }
            let Some(features) = leg_features(&segment) else { continue };
            examined = examined.saturating_add(1);
            let score = if self.near_floor && map.is_none() {
                leg_score_near_floor(&features)
            } else {
                let place = evidence(segment.points);
                let known = KnownPlaces { map: map.is_some(), before: place.is_some() };
                leg_score(&leg_cues(&features, place), known)
            };
            if score < self.limits.score_min || map.as_ref().is_some_and(|knows| knows(position)) {
                continue;
            }
            let points = truncating_u16(segment.points.len());
            let leg = Leg { position, probability: probability(2.0 * score), points };
            if let Err(leg) = self.legs.push(leg) {
                dropped = dropped.saturating_add(1);
                let farthest =
                    self.legs.iter_mut().max_by(|a, b| a.position.norm().total_cmp(&b.position.norm()));
                if let Some(slot) = farthest.filter(|slot| slot.position.norm() > leg.position.norm()) {
                    *slot = leg;
                }
            }
        }
        LegOutput { legs: &self.legs, segments: examined, dropped }
    }

    /// The legs of the newest scan.
    #[must_use]
    pub fn legs(&self) -> &[Leg] {
        &self.legs
    }

    /// Turns the positions of the newest scan's legs into another frame.
    pub fn move_legs(&mut self, into: impl Fn(Point2) -> Point2) {
        for leg in &mut self.legs {
            leg.position = into(leg.position);
        }
    }
}

/// Mean of some points.
fn centre(points: &[Point2]) -> Point2 {
    let count = nearest_f32(points.len().max(1));
    let sum = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.x_m, y + point.y_m));
    Point2::new(sum.0 / count, sum.1 / count)
}
