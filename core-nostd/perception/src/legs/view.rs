//! From a scan to what the scanner says about people: pairs of legs, and where legs could have been seen.

use super::detector::{Leg, LegDetectorOf};
use super::tracks::LegTracker;
use crate::tracking::{PeopleSensor, PeopleViewOf};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::profile::{Native, Profile};
use floorguard_types::sensing::ScanOf;

/// Farther away a leg has too few returns to be recognised with some certainty, metres: three at 0.5° on 0.1 m.
pub const LEGS_RECOGNISED_M: f32 = 4.0;

/// Legs of one scanner, and the people they belong to.
#[derive(Clone, Debug)]
pub struct PeopleByLegsOf<P: Profile> {
    detector: LegDetectorOf<P>,
    tracker: LegTracker,
    view: PeopleViewOf<P>,
    /// People left out because the list was full, since the start.
    pub dropped: u32,
    /// Segments of the newest scan that were examined.
    pub segments: u32,
    /// Legs left out because the list was full, since the start.
    pub dropped_legs: u32,
}

/// The same in the memory of the target.
pub type PeopleByLegs = PeopleByLegsOf<Native>;

impl<P: Profile> Default for PeopleByLegsOf<P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: Profile> PeopleByLegsOf<P> {
    /// Nobody yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            detector: LegDetectorOf::near_floor(),
            tracker: LegTracker::new(),
            view: PeopleViewOf::new(PeopleSensor::Scanner),
            dropped: 0,
            segments: 0,
            dropped_legs: 0,
        }
    }

    /// Takes in a scan, taken by a scanner at `sensor_in_odom`. The map tells of a point of the sensor's frame whether
    /// something stands there; `None` where no map is known.
    pub fn process(
        &mut self,
        scan: &ScanOf<P>,
        sensor_in_odom: Pose2,
        map: Option<impl Fn(Point2) -> bool>,
    ) -> &PeopleViewOf<P> {
        let found = self.detector.process(scan, map);
        self.segments = found.segments;
        self.dropped_legs = self.dropped_legs.saturating_add(found.dropped);
        self.detector.move_legs(|place| sensor_in_odom.transform(place));
        self.tracker.update(scan.stamp, self.detector.legs());
        let Self { tracker, view, dropped, .. } = self;
        view.stamp = scan.stamp;
        view.detections.clear();
        view.open.measure(scan, sensor_in_odom, LEGS_RECOGNISED_M);
        let sensor = Point2::new(sensor_in_odom.x_m, sensor_in_odom.y_m);
        tracker.people(|person| {
            // Pairs that are only remembered are no sighting.
            if tracker.is_seen_now(person.legs) && !view.add(person.detection(sensor)) {
                *dropped = dropped.saturating_add(1);
            }
        });
        view
    }

    /// The legs of the newest scan, in the fixed frame.
    #[must_use]
    pub fn legs(&self) -> &[Leg] {
        self.detector.legs()
    }

    /// The legs themselves, for display.
    #[must_use]
    pub const fn tracker(&self) -> &LegTracker {
        &self.tracker
    }
}
