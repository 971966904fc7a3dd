//! The end of a drive: one goal, or a tour of places to look from, one after another. One that cannot be reached is left out, and
//! the tour goes on.

use std::collections::VecDeque;

use floorguard_types::geometry::{Pose2, wrap_angle};

use super::drive::Navigator;
use super::guard_model::place_of;
use super::progress::{NavigationPhase, TourProgress};
use super::reasons::is_standing;

/// At each place the robot stands for so long: more than ten sweeps of a lidar, and as many views of every other sensor, seconds.
const LOOK_S: f32 = 3.0;

/// What is left of a tour.
#[derive(Clone, Debug)]
pub(super) struct Tour {
    rest: VecDeque<Pose2>,
    arrived_s: Option<f32>,
    /// How far it is.
    pub(super) progress: TourProgress,
}

impl Tour {
    /// Of the places behind the first goal; `None` without any.
    pub(super) fn of(places: &[[f32; 3]]) -> Option<Self> {
        if places.is_empty() {
            return None;
        }
        let rest: VecDeque<Pose2> =
            places.iter().map(|[x_m, y_m, heading_rad]| Pose2::new(*x_m, *y_m, *heading_rad)).collect();
        let progress = TourProgress { places: rest.len() as u32 + 1, ..TourProgress::default() };
        Some(Self { rest, arrived_s: None, progress })
    }

    /// The robot stands at a place of the tour and looks.
    pub(super) const fn is_looking(&self) -> bool {
        self.arrived_s.is_some()
    }

    /// In one sentence, at the end.
    pub(super) fn words(&self) -> String {
        let TourProgress { places, seen_from, left_out } = self.progress;
        match left_out {
            0 => format!("looked from all {places} places of the tour"),
            count => format!("looked from {seen_from} of {places} places, no way was found to {count}"),
        }
    }
}

impl Navigator {
    /// True while the robot stands at a place of a tour and looks. After that the next place becomes the goal.
    pub(super) fn observe_here(&mut self, pose: Pose2, now_s: f32) -> bool {
        let is_there = self.is_at_goal(pose) && is_standing(self.senses.motion().twist);
        let Some(tour) = &mut self.tour else { return false };
        if !is_there {
            tour.arrived_s = None;
            return false;
        }
        let since_s = *tour.arrived_s.get_or_insert(now_s);
        if now_s - since_s < LOOK_S {
            return true;
        }
        tour.progress.seen_from = tour.progress.seen_from.saturating_add(1);
        self.go_to_next();
        false
    }

    pub(super) fn is_at_goal(&self, pose: Pose2) -> bool {
        let goal = self.plan.goal_pose();
        let turn_rad = wrap_angle(goal.heading_rad - pose.heading_rad).abs();
        let off_m = place_of(pose).distance(place_of(goal));
        off_m <= self.plan.settings.within_m && turn_rad <= self.plan.settings.within_rad
    }

    /// The robot stands at a goal that was given.
    pub(super) fn has_arrived(&mut self, pose: Pose2) -> bool {
        let stands = is_standing(self.senses.motion().twist);
        let is_free = self.exploring.is_none() && self.tour.is_none();
        let is_there = is_free && stands && self.is_at_goal(pose);
        if is_there && !self.goes_on_to_dock(pose) {
            self.phase = NavigationPhase::Reached;
        }
        is_there
    }

    /// A place that no way leads to is left out, and the tour goes on. Without any place to look from the drive has failed.
    pub(super) fn leave_out_unreachable(&mut self) {
        let is_stuck = matches!(self.phase, NavigationPhase::Unreachable | NavigationPhase::NeedsHelp);
        let Some(tour) = self.tour.as_mut().filter(|_| is_stuck) else { return };
        if tour.rest.is_empty() && tour.progress.seen_from == 0 {
            return;
        }
        tour.progress.left_out = tour.progress.left_out.saturating_add(1);
        self.go_to_next();
    }

    /// The next place becomes the goal; behind the last one the tour has come to its end, and its words say what it left out.
    fn go_to_next(&mut self) {
        let Some(tour) = &mut self.tour else { return };
        tour.arrived_s = None;
        match tour.rest.pop_front() {
            Some(next) => {
                self.plan.goal = [next.x_m, next.y_m, next.heading_rad];
                self.begin_anew(NavigationPhase::Starting);
            }
            None => self.phase = NavigationPhase::Reached,
        }
    }
}
