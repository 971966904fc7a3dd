//! People by the legs that any two-dimensional scanner sees, at whatever height it is and whether or not its motion is
//! known. Source: book, Legs: Any scanner.

use super::gait::Gaits;
use super::places::Places;
use crate::legs::{LEGS_RECOGNISED_M, Leg, LegDetectorOf, LegTracker};
use crate::tracking::{PeopleSensor, PeopleViewOf};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::profile::{Native, Profile};
use floorguard_types::sensing::ScanOf;

/// Returns this near to a person who has walked are the person's, metres.
const BODY_M: f32 = 0.5;

/// Share of the returns that lie where something has stood before, while a scanner of unknown motion stands.
const STANDING_MIN: f32 = 0.7;
/// Fewer observations at a place say nothing about it: a robot that comes along has seen nothing through it as yet.
const OBSERVATIONS_MIN: f32 = 10.0;
/// Score from which a segment is followed, a probability of a quarter: what is no leg does not last.
const SCORE_MIN: f32 = -0.55;
/// Reliability that a leg of a person needs. With the one of the published code, 0.7, most legs of a scanner that the
/// committee was not trained for are lost.
const RELIABILITY_MIN: f32 = 0.35;

/// Where a scanner is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScannerPose {
    /// In a frame that stands, such as that of odometry.
    InFixedFrame(Pose2),
    /// On a robot whose motion is not known: the frame moves with it.
    OnMovingRobot(Pose2),
}

/// The legs that one scanner sees, the places around it, and the people that the legs make up. Unlike
/// [`PeopleByLegsOf`](crate::legs::PeopleByLegsOf) it knows nothing of the scanner, and learns the furniture as it goes.
#[derive(Clone, Debug)]
pub struct PeopleByAnyScannerOf<P: Profile> {
    detector: LegDetectorOf<P>,
    tracker: LegTracker,
    places: Places,
    gaits: Gaits,
    view: PeopleViewOf<P>,
    /// Segments of the newest scan that were examined.
    pub segments: u32,
    /// Legs left out because the list was full, since the start.
    pub dropped_legs: u32,
    /// People left out because the list was full, since the start.
    pub dropped: u32,
}

/// The same in the memory of the target.
pub type PeopleByAnyScanner = PeopleByAnyScannerOf<Native>;

impl<P: Profile> Default for PeopleByAnyScannerOf<P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: Profile> PeopleByAnyScannerOf<P> {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        let mut detector = LegDetectorOf::new();
        detector.limits.score_min = SCORE_MIN;
        Self {
            detector,
            tracker: LegTracker::with_reliability(RELIABILITY_MIN),
            places: Places::new(),
            gaits: Gaits::new(),
            view: PeopleViewOf::new(PeopleSensor::Scanner),
            segments: 0,
            dropped_legs: 0,
            dropped: 0,
        }
    }

    /// Takes in a scan; positions come out in the frame of the scanner's pose. While a scanner of unknown motion moves,
    /// only a gait shows who walks. Cost: beams × places along a ray, and tracks × legs.
    pub fn process(&mut self, scan: &ScanOf<P>, pose: ScannerPose) -> &PeopleViewOf<P> {
        let (scanner, is_known) = match pose {
            ScannerPose::InFixedFrame(scanner) => (scanner, true),
            ScannerPose::OnMovingRobot(scanner) => (scanner, false),
        };
        self.places.look(scan, scanner);
        // A scanner that moves unknown to us sees what moves with it where it was; a pose that earlier scans do not fit is
        // not relied on.
        let is_fixed = self.places.settled_share() > STANDING_MIN || is_known && self.places.is_settled();
        let Self { detector, places, .. } = self;
        let evidence = |points: &[Point2]| {
            places.evidence(points).filter(|place| is_fixed && place.observations >= OBSERVATIONS_MIN)
        };
        let found = detector.process_by(scan, without_map(), evidence);
        self.segments = found.segments;
        self.dropped_legs = self.dropped_legs.saturating_add(found.dropped);
        self.detector.move_legs(|place| scanner.transform(place));
        self.tracker.update(scan.stamp, self.detector.legs());
        self.gaits.forget(scan.stamp);
        self.describe(scan, scanner, is_fixed);
        let gaits = &self.gaits;
        self.places.learn(scan, |place| gaits.is_near_walker(place, BODY_M));
        &self.view
    }

    /// Writes down the people of the newest scan. In a frame that is not fixed everything moves, so that says nothing.
    fn describe(&mut self, scan: &ScanOf<P>, scanner: Pose2, is_fixed: bool) {
        let Self { tracker, gaits, view, dropped, .. } = self;
        view.stamp = scan.stamp;
        view.detections.clear();
        view.open.measure(scan, scanner, LEGS_RECOGNISED_M);
        tracker.people(|person| {
            let has_walked = tracker.seen_pair(person.legs).is_some_and(|pair| gaits.see(&pair));
            let mut detection = person.detection(Point2::new(scanner.x_m, scanner.y_m));
            detection.moving = (has_walked || !is_fixed).then_some(has_walked);
            // Pairs that are only remembered are no sighting.
            if tracker.is_seen_now(person.legs) && !view.add(detection) {
                *dropped = dropped.saturating_add(1);
            }
        });
    }

    /// The legs of the newest scan, in the fixed frame.
    #[must_use]
    pub fn legs(&self) -> &[Leg] {
        self.detector.legs()
    }

    /// The legs that are followed, for display.
    #[must_use]
    pub const fn tracker(&self) -> &LegTracker {
        &self.tracker
    }
}

/// No map: nothing is furniture by it.
fn without_map() -> Option<impl Fn(Point2) -> bool> {
    Some(|_: Point2| false).filter(|_| false)
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use super::*;
    use floorguard_types::sensing::{BeamReturn, Scan};
    use floorguard_types::time::Stamp;

    /// Two legs of 6 cm radius, the second one this far behind and beside the first, before a wall; the whole scene moves
    /// towards the scanner with this speed.
    fn scan(seconds: f32, apart: [f32; 2], speed_mps: f32) -> Scan {
        let stamp = Stamp::from_micros((1.0e6 * (1.0 + seconds)) as u64);
        let mut scan = Scan { stamp, first_angle_rad: -1.0, step_rad: 0.005, ..Scan::EMPTY };
        let ahead_m = 2.5 - speed_mps * seconds;
        let legs = [[ahead_m, -0.1], [ahead_m + apart[0], apart[1]]];
        for index in 0..400 {
            let bearing_rad = -1.0 + 0.005 * index as f32;
            let (sin, cos) = libm::sincosf(bearing_rad);
            let wall_m = (4.0 - speed_mps * seconds) / cos;
            let range_m = legs.iter().fold(wall_m, |nearest_m, [x_m, y_m]| {
                let (along_m, across_m) = (x_m * cos + y_m * sin, y_m * cos - x_m * sin);
                let half_m2 = 0.06 * 0.06 - across_m * across_m;
                if half_m2 > 0.0 { nearest_m.min(along_m - libm::sqrtf(half_m2)) } else { nearest_m }
            });
            scan.beams.push(BeamReturn::Hit((range_m * 1.0e3) as u16)).expect("room");
        }
        scan
    }

    /// The judgement of the motion of everybody who is seen, over four seconds.
    fn motions(apart: impl Fn(f32) -> [f32; 2], speed_mps: f32) -> std::vec::Vec<Option<bool>> {
        let mut people = Box::new(PeopleByAnyScanner::new());
        let moments = (0..60).map(|step| 0.066 * step as f32);
        moments
            .flat_map(|seconds| {
                let scan = scan(seconds, apart(seconds), speed_mps);
                let view = people.process(&scan, ScannerPose::OnMovingRobot(Pose2::default()));
                view.detections.iter().map(|person| person.moving).collect::<std::vec::Vec<_>>()
            })
            .collect()
    }

    /// A post and another one beside it come nearer with everything else: nobody walks. Feet that swing are a walk, though the
    /// middle between them stays where it is.
    #[test]
    fn before_unknown_motion_only_a_gait_walks() {
        let rigid = motions(|_| [0.2, 0.15], 0.3);
        assert!(rigid.len() > 20 && !rigid.contains(&Some(true)), "{rigid:?}");
        let walking = motions(|seconds| [0.35 * libm::sinf(6.0 * seconds), 0.15], 0.3);
        assert!(walking.contains(&Some(true)), "{walking:?}");
    }
}
