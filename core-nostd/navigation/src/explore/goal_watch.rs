//! Whether the robot comes nearer to where it goes, and which places were given up.

use floorguard_types::geometry::Point2;
use heapless::Vec;

/// Goals that were given up; of more, the oldest may be tried again.
const GIVEN_UP_MAX: usize = 64;
/// Nearer by less than this is no progress, metres.
const PROGRESS_M: f32 = 0.05;

/// The present goal, and those that were given up.
#[derive(Clone, Debug)]
pub(super) struct GoalWatch {
    goal_in_map: Option<Point2>,
    nearest_m: f32,
    without_progress_s: f32,
    given_up: Vec<Point2, GIVEN_UP_MAX>,
}

impl GoalWatch {
    /// Without a goal.
    pub(super) const fn new() -> Self {
        Self { goal_in_map: None, nearest_m: f32::INFINITY, without_progress_s: 0.0, given_up: Vec::new() }
    }

    /// Where the robot goes.
    pub(super) const fn goal_in_map(&self) -> Option<Point2> {
        self.goal_in_map
    }

    /// The present goal lies within this distance.
    pub(super) fn is_at(&self, place_in_map: Point2, within_m: f32) -> bool {
        self.goal_in_map.is_some_and(|goal| goal.distance(place_in_map) <= within_m)
    }

    /// The robot goes there now; `left_m` away. Another goal within `same_m` of the present one is the same.
    pub(super) fn turn_to(&mut self, goal_in_map: Point2, (left_m, same_m): (f32, f32)) {
        if !self.is_at(goal_in_map, same_m) {
            self.nearest_m = left_m;
            self.without_progress_s = 0.0;
        }
        self.goal_in_map = Some(goal_in_map);
    }

    /// After `passed_s` the goal is `left_m` away. Without progress for `timeout_s` it is given up.
    pub(super) fn progress(&mut self, left_m: f32, (passed_s, timeout_s): (f32, f32)) {
        if left_m < self.nearest_m - PROGRESS_M {
            self.nearest_m = left_m;
            self.without_progress_s = 0.0;
            return;
        }
        self.without_progress_s += passed_s.max(0.0);
        if self.without_progress_s >= timeout_s {
            self.give_up();
        }
    }

    /// Gives up the present goal.
    pub(super) fn give_up(&mut self) {
        let Some(goal) = self.goal_in_map.take() else { return };
        if self.given_up.is_full() {
            self.given_up.remove(0);
        }
        // It fits now.
        let _ = self.given_up.push(goal);
    }

    /// A goal within this distance of one that was given up is given up too.
    pub(super) fn is_given_up(&self, goal_in_map: Point2, within_m: f32) -> bool {
        self.given_up.iter().any(|old| old.distance(goal_in_map) <= within_m)
    }

    /// Everything that was given up may be tried again.
    pub(super) fn try_again(&mut self) {
        self.given_up.clear();
    }
}
