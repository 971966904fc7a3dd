//! What the lidar saw of the height of the body, on its way from the perception ring to the planner of a drive.

use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;

use embassy_sync::blocking_mutex::Mutex;
use floorguard_host::executor::PriorityLock;
use floorguard_perception::people::{RingAngles, SeenReturn, SweepContext, returns_in_base};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::Sweep;

/// One column in this many is passed on: at 6 m they are 6 cm apart.
const COLUMN_INTERVAL: usize = 3;
/// Farther returns are left out, metres: they are no obstacle yet.
const RANGE_MAX_M: f32 = 8.0;
/// A lidar sees its own robot's edge; returns this near to the outline are part of it, metres.
const BODY_MARGIN_M: f32 = 0.1;

/// The returns of a sweep around the robot.
#[derive(Clone, Debug, Default)]
pub struct SpaceSight {
    /// The robot at the end of the sweep, odometry frame.
    pub base_in_odometry: Pose2,
    /// In the robot's frame at the end of the sweep.
    pub returns: Vec<SeenReturn>,
}

/// The newest sweep; the writer never waits for the reader.
#[derive(Clone)]
pub struct SpaceInbox(Arc<Mutex<PriorityLock, RefCell<Option<SpaceSight>>>>);

impl Default for SpaceInbox {
    fn default() -> Self {
        Self(Arc::new(Mutex::new(RefCell::default())))
    }
}

impl fmt::Debug for SpaceInbox {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let waits = self.0.lock(|newest| newest.borrow().is_some());
        write!(out, "SpaceInbox {}", if waits { "with a sweep" } else { "without a sweep" })
    }
}

impl SpaceInbox {
    /// Replaces the sweep that waits.
    pub fn put(&self, sight: SpaceSight) {
        self.0.lock(|newest| *newest.borrow_mut() = Some(sight));
    }

    /// The sweep that waits, once.
    #[must_use]
    pub fn take(&self) -> Option<SpaceSight> {
        self.0.lock(|newest| newest.borrow_mut().take())
    }
}

/// The corners between which the body lies, robot's frame.
#[derive(Clone, Copy, Debug)]
pub struct BodyExtent {
    low: Point2,
    high: Point2,
}

impl BodyExtent {
    /// Of an outline.
    #[must_use]
    pub fn of(outline: &[Point2]) -> Self {
        let grown = |corner: &Point2, by_m: f32| Point2::new(corner.x_m + by_m, corner.y_m + by_m);
        let lower =
            |low: Point2, corner: Point2| Point2::new(low.x_m.min(corner.x_m), low.y_m.min(corner.y_m));
        let higher =
            |high: Point2, corner: Point2| Point2::new(high.x_m.max(corner.x_m), high.y_m.max(corner.y_m));
        Self {
            low: outline.iter().map(|corner| grown(corner, -BODY_MARGIN_M)).fold(Point2::default(), lower),
            high: outline.iter().map(|corner| grown(corner, BODY_MARGIN_M)).fold(Point2::default(), higher),
        }
    }

    fn holds(&self, seen: &SeenReturn) -> bool {
        let place = seen.end_in_base;
        (self.low.x_m..=self.high.x_m).contains(&place.x_m)
            && (self.low.y_m..=self.high.y_m).contains(&place.y_m)
    }
}

/// What of a sweep lies around the robot.
#[must_use]
pub fn sight_of(
    sweep: &Sweep,
    context: &SweepContext,
    (angles, body): (&RingAngles, &BodyExtent),
) -> SpaceSight {
    let returns = returns_in_base(sweep, (&context.sensor_in_base, context.twist), angles, COLUMN_INTERVAL);
    let is_around = |seen: &SeenReturn| {
        let (from, end) = (seen.sensor_in_base, seen.end_in_base);
        let distance_m = libm::hypotf(end.x_m - from.x_m, end.y_m - from.y_m);
        distance_m <= RANGE_MAX_M && !body.holds(seen)
    };
    SpaceSight { base_in_odometry: context.base_in_odom, returns: returns.filter(is_around).collect() }
}
