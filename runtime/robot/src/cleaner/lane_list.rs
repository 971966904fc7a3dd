//! The lanes of a mission that drives over everything: which are left, and which comes next.
//!
//! A lane that was broken off goes on later where it ended; one that cannot be got to now is tried again.

use floorguard_cleaning::Lane;
use floorguard_types::geometry::{Point2, Pose2, wrap_angle};

use super::progress::LaneCount;

/// A lane that nobody can get to now, or on which somebody stands, is tried again after this, seconds.
const LATER_S: f32 = 12.0;
/// Attempts without coming forward before a lane is given up.
const TRIES_MAX: u8 = 8;
/// It begins again so far back, metres.
const BACK_M: f32 = 0.3;
/// What is left is not worth driving below this, metres.
const LEFT_MIN_M: f32 = 0.3;
/// Farther beside the lane the robot was not on it, metres.
const OFF_MAX_M: f32 = 0.3;
/// An attempt that comes this far is none in vain, metres.
const FORWARD_M: f32 = 1.0;
/// Turning by a radian costs as much as so many metres.
const TURN_M_PER_RAD: f32 = 1.0;

#[derive(Clone, Copy, Debug)]
struct OpenLane {
    lane: Lane,
    tries: u8,
    /// Not before, seconds of the mission.
    from_s: f32,
}

/// The lanes that are left, and the one that is driven.
#[derive(Clone, Debug, Default)]
pub(super) struct LaneList {
    open: Vec<OpenLane>,
    driving: Option<OpenLane>,
    count: LaneCount,
}

impl LaneList {
    /// All of them are to be driven.
    pub(super) fn new(lanes: Vec<Lane>) -> Self {
        let count = LaneCount { planned: lanes.len() as u32, driven: 0 };
        let open = lanes.into_iter().map(|lane| OpenLane { lane, tries: 0, from_s: 0.0 });
        Self { open: open.collect(), driving: None, count }
    }

    /// Planned and driven.
    pub(super) const fn count(&self) -> LaneCount {
        self.count
    }

    /// Nothing is left to drive.
    pub(super) fn is_over(&self) -> bool {
        self.open.is_empty() && self.driving.is_none()
    }

    /// The lane that is got to soonest from a pose in the map frame; it is driven from now on.
    pub(super) fn advance(&mut self, pose: Pose2, now_s: f32) -> Option<Lane> {
        let here = Point2::new(pose.x_m, pose.y_m);
        let far_m = |lane: &Lane| {
            let heading_rad = libm::atan2f(lane.to.y_m - lane.from.y_m, lane.to.x_m - lane.from.x_m);
            let way_m = here.distance(lane.from);
            let bearing_rad = libm::atan2f(lane.from.y_m - here.y_m, lane.from.x_m - here.x_m);
            let turn_rad = if way_m > 0.5 {
                wrap_angle(bearing_rad - pose.heading_rad).abs() + wrap_angle(heading_rad - bearing_rad).abs()
            } else {
                wrap_angle(heading_rad - pose.heading_rad).abs()
            };
            way_m + TURN_M_PER_RAD * turn_rad
        };
        let ready = self.open.iter().enumerate().filter(|(_, open)| open.from_s <= now_s);
        let (index, _) = ready.min_by(|(_, a), (_, b)| far_m(&a.lane).total_cmp(&far_m(&b.lane)))?;
        let next = self.open.swap_remove(index);
        self.driving = Some(next);
        Some(next.lane)
    }

    /// The lane was driven to its end.
    pub(super) fn finish(&mut self) {
        self.count.driven += u32::from(self.driving.take().is_some());
    }

    /// The lane was broken off at a place in the map frame, or nothing leads to it: what is left of it is driven later.
    pub(super) fn break_off(&mut self, here: Point2, now_s: f32) {
        let Some(OpenLane { lane, tries, .. }) = self.driving.take() else { return };
        let length_m = lane.from.distance(lane.to).max(1.0e-3);
        let (ux, uy) = ((lane.to.x_m - lane.from.x_m) / length_m, (lane.to.y_m - lane.from.y_m) / length_m);
        let (dx, dy) = (here.x_m - lane.from.x_m, here.y_m - lane.from.y_m);
        let (along_m, off_m) = (dx * ux + dy * uy, (dx * uy - dy * ux).abs());
        let done_m = if off_m < OFF_MAX_M { (along_m - BACK_M).clamp(0.0, length_m) } else { 0.0 };
        let tries = if done_m > FORWARD_M { 0 } else { tries + 1 };
        if length_m - done_m - BACK_M < LEFT_MIN_M && done_m > 0.0 {
            self.count.driven += 1;
        } else if tries < TRIES_MAX {
            let from = Point2::new(lane.from.x_m + done_m * ux, lane.from.y_m + done_m * uy);
            self.open.push(OpenLane { lane: Lane { from, ..lane }, tries, from_s: now_s + LATER_S });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lane(y_m: f32) -> Lane {
        Lane { from: Point2::new(0.0, y_m), to: Point2::new(6.0, y_m) }
    }

    #[test]
    fn broken_lane_goes_on_later() {
        let mut list = LaneList::new(vec![lane(0.0), lane(2.0)]);
        assert_eq!(list.advance(Pose2::default(), 0.0), Some(lane(0.0)), "the nearest");
        list.break_off(Point2::new(3.3, 0.1), 10.0);
        assert_eq!(list.advance(Pose2::default(), 10.0), Some(lane(2.0)), "the other one meanwhile");
        list.finish();
        assert_eq!((list.advance(Pose2::default(), 11.0), list.is_over()), (None, false));
        let rest = list.advance(Pose2::default(), 10.0 + LATER_S).unwrap();
        assert!((rest.from.x_m - 3.0).abs() < 1e-5 && rest.to == lane(0.0).to, "{rest:?}");
        list.finish();
        assert!(list.is_over() && list.count() == LaneCount { planned: 2, driven: 2 });
    }

    #[test]
    fn lane_in_vain_is_given_up() {
        let mut list = LaneList::new(vec![lane(0.0)]);
        for attempt in 0..TRIES_MAX {
            let now_s = f32::from(attempt) * LATER_S;
            assert!(list.advance(Pose2::default(), now_s).is_some(), "{attempt}");
            list.break_off(Point2::new(-1.0, 3.0), now_s);
        }
        assert!(list.is_over() && list.count() == LaneCount { planned: 1, driven: 0 });
    }
}
