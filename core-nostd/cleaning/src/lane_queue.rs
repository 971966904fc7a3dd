//! Straight lanes and the order in which they are driven.

use floorguard_types::geometry::Point2;

/// A straight stretch to be driven, in the map frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lane {
    /// Where it begins.
    pub from: Point2,
    /// Where it ends.
    pub to: Point2,
}

impl Lane {
    /// Length and direction; a lane of no length has no direction.
    fn direction(&self) -> (f32, [f32; 2]) {
        let length_m = self.from.distance(self.to).max(1e-6);
        (length_m, [(self.to.x_m - self.from.x_m) / length_m, (self.to.y_m - self.from.y_m) / length_m])
    }

    /// The lane moved to its left, or by a negative distance to its right, metres.
    #[must_use]
    pub fn beside(self, side_m: f32) -> Self {
        let (_, [ux, uy]) = self.direction();
        let shift = |point: Point2| Point2::new(point.x_m - uy * side_m, point.y_m + ux * side_m);
        Self { from: shift(self.from), to: shift(self.to) }
    }

    /// The n-th attempt at it: on itself, then `side_m` to the left and to the right of it in turn, where `is_clear` says
    /// that the robot can drive straight.
    ///
    /// ```
    /// use floorguard_cleaning::Lane;
    /// use floorguard_types::geometry::Point2;
    ///
    /// let lane = Lane { from: Point2::new(0.0, 0.0), to: Point2::new(2.0, 0.0) };
    /// assert_eq!(lane.attempt(0, 0.1, |_, _| true), lane);
    /// assert_eq!(lane.attempt(1, 0.1, |_, _| true).from, Point2::new(0.0, 0.1));
    /// assert_eq!(lane.attempt(1, 0.1, |_, _| false), lane);
    /// ```
    #[must_use]
    pub fn attempt(self, number: u8, side_m: f32, is_clear: impl Fn(Point2, Point2) -> bool) -> Self {
        let moved = match number % 3 {
            0 => return self,
            1 => self.beside(side_m),
            _ => self.beside(-side_m),
        };
        if is_clear(moved.from, moved.to) { moved } else { self }
    }
}

/// A lane, and how often it was broken off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaneAttempt {
    /// What of it is left.
    pub lane: Lane,
    /// Attempts before this one.
    pub tries: u8,
}

/// When a lane that was broken off is driven on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneRules {
    /// It begins again so far back, metres.
    pub back_m: f32,
    /// So much farther on for every attempt before, metres.
    pub skip_m: f32,
    /// What is left is not worth driving below this, metres.
    pub left_min_m: f32,
    /// Farther beside the lane the robot was not on it, metres.
    pub off_max_m: f32,
    /// Attempts before the rest is left out.
    pub tries_max: u8,
}

/// The lanes of a mission in their order. `S` stores them.
#[derive(Clone, Debug)]
pub struct LaneQueue<S> {
    lanes: S,
    /// The lane after the one that is driven.
    next: usize,
    is_driving: bool,
}

impl<S: AsRef<[LaneAttempt]> + AsMut<[LaneAttempt]>> LaneQueue<S> {
    /// All of them are to be driven.
    #[must_use]
    pub const fn new(lanes: S) -> Self {
        Self { lanes, next: 0, is_driving: false }
    }

    /// Lanes that are not finished, the one that is driven included.
    #[must_use]
    pub fn left(&self) -> usize {
        self.lanes.as_ref().len().saturating_sub(self.next).saturating_add(usize::from(self.is_driving))
    }

    /// Leaves out all but the last ones: they were driven before.
    pub fn keep_last(&mut self, count: usize) {
        self.next = self.next.max(self.lanes.as_ref().len().saturating_sub(count));
        self.is_driving = false;
    }

    /// The next lane, which is driven from now on; `None`: there is none left.
    pub fn advance(&mut self) -> Option<LaneAttempt> {
        let lane = self.lanes.as_ref().get(self.next).copied();
        self.is_driving = lane.is_some();
        self.next = self.next.saturating_add(usize::from(self.is_driving));
        lane
    }

    /// The lane that is driven was broken off where the robot is: what is left of it becomes the next one.
    pub fn break_off(&mut self, here: Point2, rules: &LaneRules) {
        let current = self.next.saturating_sub(1);
        let Some(slot) = self.lanes.as_mut().get_mut(current).filter(|_| self.is_driving) else { return };
        self.is_driving = false;
        let LaneAttempt { lane, tries } = *slot;
        let (length_m, [ux, uy]) = lane.direction();
        let (dx, dy) = (here.x_m - lane.from.x_m, here.y_m - lane.from.y_m);
        let (along_m, off_m) = (dx * ux + dy * uy, libm::fabsf(dx * uy - dy * ux));
        // On the way to the lane nothing of it is done; the same place is left out only after several attempts.
        let skipped_m = f32::from(tries) * rules.skip_m;
        let is_on_lane = off_m < rules.off_max_m && along_m > 0.0;
        let done_m = if is_on_lane { along_m - rules.back_m + skipped_m } else { skipped_m }.max(0.0);
        if tries < rules.tries_max && length_m - done_m > rules.left_min_m {
            let on = Point2::new(lane.from.x_m + done_m * ux, lane.from.y_m + done_m * uy);
            *slot = LaneAttempt { lane: Lane { from: on, ..lane }, tries: tries.saturating_add(1) };
            self.next = current;
        }
    }
}

impl From<Lane> for LaneAttempt {
    fn from(lane: Lane) -> Self {
        Self { lane, tries: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULES: LaneRules =
        LaneRules { back_m: 0.05, skip_m: 0.05, left_min_m: 0.03, off_max_m: 0.1, tries_max: 2 };

    fn lane(y_m: f32) -> Lane {
        Lane { from: Point2::new(0.0, y_m), to: Point2::new(2.0, y_m) }
    }

    #[test]
    fn a_broken_lane_goes_on_where_it_ended() {
        let mut queue = LaneQueue::new([lane(0.0), lane(1.0)].map(LaneAttempt::from));
        assert_eq!(queue.advance().map(|attempt| attempt.lane), Some(lane(0.0)));
        assert_eq!(queue.left(), 2);
        queue.break_off(Point2::new(1.0, 0.02), &RULES);
        let rest = queue.advance().unwrap();
        assert!((rest.lane.from.x_m - 0.95).abs() < 1e-6 && rest.tries == 1, "{rest:?}");
        // Beside the lane nothing more of it is done, but the place itself is skipped.
        queue.break_off(Point2::new(1.5, 0.5), &RULES);
        let rest = queue.advance().unwrap();
        assert!((rest.lane.from.x_m - 1.0).abs() < 1e-6 && rest.tries == 2, "{rest:?}");
        queue.break_off(Point2::new(1.5, 0.0), &RULES);
        assert_eq!(queue.advance().map(|attempt| attempt.lane), Some(lane(1.0)), "given up");
        assert_eq!((queue.left(), queue.advance(), queue.left()), (1, None, 0));
    }

    #[test]
    fn finished_lanes_stay_out_after_a_restart() {
        let mut queue = LaneQueue::new([lane(0.0), lane(1.0), lane(2.0)].map(LaneAttempt::from));
        queue.keep_last(2);
        assert_eq!((queue.left(), queue.advance().map(|attempt| attempt.lane)), (2, Some(lane(1.0))));
        queue.break_off(Point2::new(1.999, 1.0), &RULES);
        assert_eq!(queue.left(), 2, "5 cm of it are driven again");
    }
}
