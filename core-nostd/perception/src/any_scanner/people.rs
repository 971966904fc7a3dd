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

/// Reliability that a leg needs, the balance of precision and recall of its committee: a leg of a scanner that nobody
/// trained for is rarely sure.
const RELIABILITY_MIN: f32 = 0.5;

/// Legs of one scanner, the places around it, and the people to whom the legs belong. Unlike
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
        Self {
            detector: LegDetectorOf::new(),
            tracker: LegTracker::with_reliability(RELIABILITY_MIN),
            places: Places::new(),
            gaits: Gaits::new(),
            view: PeopleViewOf::new(PeopleSensor::Scanner),
            segments: 0,
            dropped_legs: 0,
            dropped: 0,
        }
    }

    /// Takes in a scan, taken by a scanner at this pose of the fixed frame. Where the pose is not known, that of the
    /// sensor itself will do: what walks is known by its gait, and places count only while the scanner stands.
    pub fn process(&mut self, scan: &ScanOf<P>, scanner_in_fixed: Pose2) -> &PeopleViewOf<P> {
        self.places.look(scan, scanner_in_fixed);
        let found =
            self.detector.process_by(scan, None::<fn(Point2) -> bool>, |points| self.places.evidence(points));
        self.segments = found.segments;
        self.dropped_legs = self.dropped_legs.saturating_add(found.dropped);
        self.detector.move_legs(|place| scanner_in_fixed.transform(place));
        self.tracker.update(scan.stamp, self.detector.legs());
        self.gaits.forget(scan.stamp);
        let Self { tracker, gaits, view, dropped, .. } = self;
        view.stamp = scan.stamp;
        view.detections.clear();
        view.open.measure(scan, scanner_in_fixed, LEGS_RECOGNISED_M);
        let scanner = Point2::new(scanner_in_fixed.x_m, scanner_in_fixed.y_m);
        tracker.people(|person| {
            let has_walked = tracker.seen_pair(person.legs).is_some_and(|pair| gaits.see(&pair));
            let mut detection = person.detection(scanner);
            // Who swings the legs walks, wherever the sensor goes; who does not may stand.
            detection.moving = has_walked.then_some(true);
            // Pairs that are only remembered are no sighting.
            if tracker.is_seen_now(person.legs) && !view.add(detection) {
                *dropped = dropped.saturating_add(1);
            }
        });
        let gaits = &self.gaits;
        self.places.learn(scan, |place| gaits.is_near_walker(place, BODY_M));
        &self.view
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
