//! What other sensors than the lidar saw, on its way to the tracker: waits until its turn.
//!
//! A sweep reaches the tracker when its last packet has come, a tenth of a second after it began; what another sensor
//! saw meanwhile is newer or older than that. Here it is put into the order of the measurements, so that what comes out
//! depends on the stamps alone and not on which task ran first (book, Tracking: Late views).

use heapless::Vec;

use super::detection::DetectionOf;
use super::sensors::PeopleSensor;
use super::tracker::{SightingsOf, TrackerOf};
use super::visibility::OpenSpace;
use floorguard_types::profile::{Native, Profile};
use floorguard_types::time::Stamp;

/// People in one view.
pub const VIEW_PEOPLE_MAX: usize = 16;
/// Views that wait: a sweep lasts as long as three scans, and comes as late as one.
pub const VIEWS_WAITING: usize = 8;
/// Who waits longer than this for the lidar waits in vain, µs.
const WAIT_MAX_US: u64 = 200_000;
/// A lidar without a sweep for this long is silent, or there is none: views no longer wait for it, µs. At 300 revolutions a
/// minute a sweep takes 200,000.
const SILENT_US: u64 = 500_000;

/// What a sensor saw at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct PeopleViewOf<P: Profile> {
    /// Who looked.
    pub sensor: PeopleSensor,
    /// When.
    pub stamp: Stamp,
    /// Who was seen, in the fixed frame.
    pub detections: Vec<DetectionOf<P>, VIEW_PEOPLE_MAX>,
    /// Where somebody could have been seen.
    pub open: OpenSpace,
}

/// A view in the memory of the target.
pub type PeopleView = PeopleViewOf<Native>;

impl<P: Profile> PeopleViewOf<P> {
    /// Nobody seen, and nobody to be seen.
    #[must_use]
    pub const fn new(sensor: PeopleSensor) -> Self {
        Self { sensor, stamp: Stamp::ZERO, detections: Vec::new(), open: OpenSpace::BLIND }
    }

    /// Adds a person; false if the list is full.
    pub fn add(&mut self, detection: DetectionOf<P>) -> bool {
        self.detections.push(detection).is_ok()
    }
}

/// Views in the order of their stamps; those of one moment in the order of their arrival.
#[derive(Clone, Debug)]
pub(crate) struct WaitingViews<P: Profile> {
    views: Vec<PeopleViewOf<P>, VIEWS_WAITING>,
    /// End of the newest sweep.
    swept: Option<Stamp>,
    /// Views given to the tracker before their turn because the queue was full, since the start.
    pub(crate) hurried: u32,
}

impl<P: Profile> WaitingViews<P> {
    pub(crate) const fn new() -> Self {
        Self { views: Vec::new(), swept: None, hurried: 0 }
    }

    /// Lets a view wait. When full, the oldest one goes to the tracker at once.
    pub(crate) fn add(&mut self, view: &PeopleViewOf<P>, tracker: &mut TrackerOf<P>) {
        if self.views.is_full() {
            self.hurried = self.hurried.saturating_add(1);
            self.give_first(tracker);
        }
        let place = self.views.iter().position(|other| other.stamp > view.stamp);
        // The list is not full, and the place is within it.
        let _ = self.views.insert(place.unwrap_or(self.views.len()), view.clone());
    }

    /// A sweep ended at `stamp`: gives the tracker what was seen up to then, oldest first. True if there was something.
    pub(crate) fn give_until(&mut self, stamp: Stamp, tracker: &mut TrackerOf<P>) -> bool {
        self.swept = Some(stamp);
        self.give_while(tracker, |view| view.stamp <= stamp)
    }

    /// Gives the tracker what waited too long for the lidar; everything where it is silent or has never sent a sweep.
    /// True if there was something.
    pub(crate) fn give_overdue(&mut self, tracker: &mut TrackerOf<P>) -> bool {
        let Some(newest) = self.views.last().map(|view| view.stamp) else { return false };
        let is_silent = self.swept.is_none_or(|swept| swept.past_us(newest) >= SILENT_US);
        self.give_while(tracker, |view| is_silent || view.stamp.past_us(newest) >= WAIT_MAX_US)
    }

    fn give_while(&mut self, tracker: &mut TrackerOf<P>, is_due: impl Fn(&PeopleViewOf<P>) -> bool) -> bool {
        let mut any = false;
        for _ in 0..VIEWS_WAITING {
            if !self.views.first().is_some_and(&is_due) {
                break;
            }
            self.give_first(tracker);
            any = true;
        }
        any
    }

    fn give_first(&mut self, tracker: &mut TrackerOf<P>) {
        let Some(view) = self.views.first() else { return };
        let seen = SightingsOf { sensor: view.sensor, stamp: view.stamp, detections: &view.detections };
        tracker.take(&seen, |point| view.open.is_visible(point));
        let mut first = true;
        self.views.retain(|_| !core::mem::take(&mut first));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracking::{Appearance, Detection, Tracker, TrackerParameters};
    use floorguard_types::geometry::Point2;

    fn legs(at_us: u64, x_m: f32) -> PeopleView {
        let mut view = PeopleView::new(PeopleSensor::Scanner);
        view.stamp = Stamp::from_micros(at_us);
        let position = Point2::new(x_m, 0.0);
        let detection = Detection {
            position,
            distance_m: x_m,
            sigma_m: 0.3,
            likeness: 0.9,
            points: 2,
            moving: None,
            surroundings: crate::tracking::Surroundings::OPEN,
            appearance: Appearance::UNKNOWN,
        };
        assert!(view.add(detection));
        view
    }

    /// Whatever the order of arrival, the tracker gets them in the order of their stamps.
    #[test]
    fn the_order_of_arrival_does_not_matter() {
        let stamps = [0, 40_000, 80_000, 120_000, 160_000_u64];
        let orders = [[0, 1, 2, 3, 4], [4, 3, 2, 1, 0], [2, 0, 4, 1, 3]];
        let follow = |order: [usize; 5]| {
            let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
            let mut waiting = WaitingViews::new();
            for index in order {
                waiting.add(&legs(stamps[index], 2.0 + 0.05 * index as f32), &mut tracker);
            }
            assert!(tracker.tracks().is_empty());
            assert!(waiting.give_until(Stamp::from_micros(120_000), &mut tracker));
            assert_eq!(waiting.views.len(), 1, "what is newer waits on");
            tracker.tracks().to_vec()
        };
        let [first, second, third] = orders.map(follow);
        assert_eq!(first.len(), 1);
        assert!(first == second && first == third);
    }

    #[test]
    fn silent_lidar_blocks_nothing_and_queue_is_bounded() {
        let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
        let mut waiting = WaitingViews::new();
        waiting.give_until(Stamp::ZERO, &mut tracker);
        for scan in 1..20_u64 {
            waiting.add(&legs(scan * 40_000, 2.0), &mut tracker);
            let given = waiting.give_overdue(&mut tracker);
            assert_eq!(given, scan >= 6, "scan {scan}");
            // Half a second after the only sweep no view waits any longer.
            assert_eq!(waiting.views.is_empty(), scan >= 13, "scan {scan}");
        }
        assert_eq!(tracker.tracks().len(), 1);
        assert_eq!(waiting.hurried, 0);
        for _ in 0..=VIEWS_WAITING {
            waiting.add(&legs(900_000, 2.0), &mut tracker);
        }
        assert_eq!((waiting.views.len(), waiting.hurried), (VIEWS_WAITING, 1));
    }

    /// A robot without a lidar follows legs at once.
    #[test]
    fn without_a_lidar_nothing_waits() {
        let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
        let mut waiting = WaitingViews::new();
        waiting.add(&legs(40_000, 2.0), &mut tracker);
        assert!(waiting.give_overdue(&mut tracker) && waiting.views.is_empty());
        assert_eq!(tracker.tracks().len(), 1);
    }
}
