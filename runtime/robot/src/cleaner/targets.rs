//! Where the mission goes next: the tour over what is dirty, what is postponed, and the lanes of a mission without a belief.

use floorguard_cleaning::{Lane, PlanCells};
use floorguard_mapping::NO_SLOT;
use floorguard_types::geometry::{Point2, Pose2, wrap_angle};
use floorguard_types::motion::{Gear, Waypoint};

use super::mission::Cleaner;
use super::path_finder::{STEP_M, Search};
use super::plan::MissionStrategy;
use super::progress::MissionPhase;
use super::surroundings::Surroundings;
use super::track::Track;
use super::visits::{CLUSTER_M, way_left_m};
use crate::site::cells_around;

/// A cell that nobody can get to now is tried again after this, seconds.
const POSTPONED_S: f32 = 12.0;
/// After so many visits a cell is given up, and reported.
pub(super) const VISITS_MAX: u8 = 12;
/// After tries in vain the robot waits this long before the next, seconds.
const TRY_AGAIN_S: f32 = 1.0;
/// Distance of a departure: the robot drives off the last cells, so that the brush leaves them, metres.
const DEPARTURE_M: f32 = 0.9;
/// Completed departures after which a mission ends, and how long it tries while people or objects block the way, seconds.
const DEPARTURES_MAX: u8 = 6;
const DEPARTURES_FOR_S: f32 = 120.0;
/// Held again within this distance, the robot does something else first, metres.
const SAME_PLACE_M: f32 = 0.3;
/// Waypoints that are left on the last straight, over the dirt.
const PASS_LEGS: usize = 1;
/// Held for this long at a place, the robot goes elsewhere first, seconds.
const STAYS_S: f32 = 5.0;
/// Cells of the tour that are tried before the robot waits.
const TRIES: usize = 4;
/// A lane may be entered so far before or behind its begin, and beside it, metres; and so far across it, radians.
const ENTRY_M: f32 = 0.3;
const BESIDE_M: f32 = 0.1;
const ALONG_RAD: f32 = 0.2;

/// Departures from the last cells of a mission.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Departures {
    /// Driven to the end of the path; interrupted ones do not count.
    completed: u8,
    /// Time of the first attempt, seconds.
    since_s: Option<f32>,
}

impl Cleaner {
    pub(super) fn arrive(&mut self) {
        self.track = Track::default();
        self.lanes.finish();
        if let Some(target) = self.target.take() {
            let around: Vec<usize> = self.cells_within(target, CLUSTER_M).collect();
            around.into_iter().for_each(|cell| self.passes[cell] = self.passes[cell].saturating_add(1));
            self.tours.finish(target);
        } else if !self.near.is_leaving {
            self.departures.completed = self.departures.completed.saturating_add(1);
        }
    }

    /// The tour over what is dirty; a cell that became clean meanwhile is no target any more.
    pub(super) fn replan(&mut self, pose: Pose2, now_s: f32) {
        self.tours.plan_later(now_s);
        let here = Point2::new(pose.x_m, pose.y_m);
        let Some(cell) = self.ground.floor.nearest_passable(here) else { return };
        let floor = &self.ground.floor;
        let dirty = self.localiser.dirty(&self.rule);
        for (cell, is_wanted) in self.wanted.iter_mut().enumerate() {
            *is_wanted = floor.reachable[cell] && self.tours.may_visit(cell) && dirty.contains(cell);
        }
        let all_wanted = &self.wanted;
        let wanted = |cell: usize| all_wanted[cell];
        let passable = |cell: usize| floor.passable[cell] || floor.reachable[cell];
        // A tour that does not fit its memory is the one before, without what is clean by now.
        let _ = self.tours.replan((cell, now_s), &PlanCells { wanted, passable }, 500);
        // A pass that has begun is not broken off while any of its dirt is left.
        let map = &self.localiser.map;
        let is_gone = |target: usize| {
            let is_decided = map.get(target).is_some_and(|dirt| dirt.slot == NO_SLOT);
            is_decided && !self.is_wanted_within(target, CLUSTER_M)
        };
        if self.target.is_some_and(is_gone) {
            self.target = None;
            self.track = Track::default();
        }
    }

    /// A person or an object stands on the path: another path if there is one. Who walks is gone in a moment; only what
    /// stays sends the robot to another cell first.
    pub(super) fn go_round(&mut self, pose: Pose2, now_s: f32) {
        self.detours += 1;
        let here = Point2::new(pose.x_m, pose.y_m);
        let gear = self.track.rest().first().map(|at| at.gear);
        self.refused.note(self.held_by, (gear, here), now_s);
        let again = self.held_at.filter(|(before, _)| before.distance(here) < SAME_PLACE_M);
        let (_, since_s) = *self.held_at.insert(again.unwrap_or((here, now_s)));
        let Some(target) = self.target else {
            // A lane is waited for a little: any other way costs two turns.
            if self.plan.strategy != MissionStrategy::Systematic || now_s - since_s > STAYS_S {
                self.held_at = None;
                self.track = Track::default();
            }
            return;
        };
        if now_s - since_s > STAYS_S {
            self.held_at = None;
            self.track = Track::default();
            self.postpone(target, now_s);
        } else if self.track.rest().len() > PASS_LEGS {
            // A pass that has begun is waited for: any other path would begin it again.
            self.plan_to(target, pose, now_s);
        }
    }

    /// Leaves a cell and the dirt around it for later.
    pub(super) fn postpone(&mut self, cell: usize, now_s: f32) {
        self.obstructed[cell] = true;
        self.target = None;
        let around: Vec<usize> =
            self.cells_within(cell, CLUSTER_M).filter(|near| self.wanted[*near] || *near == cell).collect();
        self.postponed.retain(|(other, until_s)| !around.contains(other) && *until_s > now_s);
        self.postponed.extend(around.into_iter().map(|near| (near, now_s + POSTPONED_S)));
    }

    /// Some cell within a distance of this one is still to be cleaned.
    pub(super) fn is_wanted_within(&self, cell: usize, distance_m: f32) -> bool {
        self.cells_within(cell, distance_m).any(|near| self.wanted[near])
    }

    pub(super) fn cells_within(&self, cell: usize, distance_m: f32) -> impl Iterator<Item = usize> {
        cells_around(self.ground.raster(), self.ground.raster().centre(cell), distance_m)
    }

    /// Finds something to do; false: wait, or the mission is over.
    pub(super) fn choose(&mut self, pose: Pose2, now_s: f32) -> bool {
        if now_s < self.try_s {
            return false;
        }
        if self.plan.strategy == MissionStrategy::Systematic {
            return self.next_lane(pose, now_s);
        }
        // What the brush has just passed over is no target any more.
        self.replan(pose, now_s);
        self.postponed.retain(|(_, until_s)| *until_s > now_s);
        if self.plan_best_pass(pose, now_s) {
            self.departures = Departures::default();
            return true;
        }
        // Nothing near can be passed over now: the way to what is farther, in the order of the tour.
        for _ in 0..TRIES {
            let is_postponed = |cell: &usize| self.postponed.iter().any(|(other, _)| other == cell);
            let open = || self.tours.tour().filter(|cell| !is_postponed(cell));
            // What a pass has left is done on a second round: at once it would cost a turn, among the same people.
            let fresh = open().find(|cell| self.passes[*cell] == 0);
            let Some(cell) = fresh.or_else(|| open().next()) else { break };
            if self.plan_to(cell, pose, now_s) {
                self.departures = Departures::default();
                return true;
            }
            self.postpone(cell, now_s);
        }
        self.try_s = now_s + TRY_AGAIN_S;
        if self.tours.tour().next().is_some() {
            return false;
        }
        self.end(pose, now_s)
    }

    /// Nothing is left: the last cells are decided only when the brush has left them.
    pub(super) fn end(&mut self, pose: Pose2, now_s: f32) -> bool {
        let since_s = *self.departures.since_s.get_or_insert(now_s);
        let is_in_vain = self.departures.completed >= DEPARTURES_MAX || now_s - since_s > DEPARTURES_FOR_S;
        if self.localiser.active_cells() == 0 || is_in_vain {
            self.phase = MissionPhase::Done;
            return false;
        }
        let here = Point2::new(pose.x_m, pose.y_m);
        let is_far = |pose: Pose2| Point2::new(pose.x_m, pose.y_m).distance(here) > DEPARTURE_M;
        self.search((pose, now_s), (|_: Pose2| Some(0.0), is_far)).is_some_and(|path| {
            self.track = Track::new(path);
            self.near.is_leaving = false;
            self.tours.plan_at(now_s);
            true
        })
    }

    /// The next lane that can be got to; one that nobody can get to now is tried again later.
    pub(super) fn next_lane(&mut self, pose: Pose2, now_s: f32) -> bool {
        let here = Point2::new(pose.x_m, pose.y_m);
        // Whatever ended the path before its end, as a person who stood on it.
        self.lanes.break_off(here, now_s);
        for _ in 0..TRIES {
            let Some(lane) = self.lanes.advance(pose, now_s) else { break };
            if let Some(path) = self.path_along(lane, (pose, now_s)) {
                self.near.is_leaving = false;
                self.track = Track::new(path);
                return true;
            }
            self.lanes.break_off(here, now_s);
        }
        self.try_s = now_s + TRY_AGAIN_S;
        if self.lanes.is_over() {
            self.phase = MissionPhase::Done;
        }
        false
    }

    /// The path to the begin of a lane, and along it.
    fn path_along(&mut self, Lane { from, to }: Lane, (pose, now_s): (Pose2, f32)) -> Option<Vec<Waypoint>> {
        let heading_rad = libm::atan2f(to.y_m - from.y_m, to.x_m - from.x_m);
        let on_lane = Pose2::new(from.x_m, from.y_m, heading_rad);
        let length_m = from.distance(to);
        let cell = self.ground.floor.nearest_passable(from)?;
        let (ground, guess, speed_mps) = (&self.ground, &mut self.guess, self.path_finder.pace().speed_mps);
        let around = Surroundings::new(ground, (&self.obstacles, now_s), pose).after(self.refused);
        guess.run(cell, |cell| ground.floor.passable[cell] || ground.floor.reachable[cell]);
        let left_s = |pose: Pose2| {
            let way_m = way_left_m((ground, guess), Point2::new(pose.x_m, pose.y_m), from);
            let turn_rad = wrap_angle(pose.heading_rad - heading_rad).abs();
            Some((way_m / speed_mps).max(turn_rad))
        };
        let is_goal = |pose: Pose2| {
            let in_lane = on_lane.inverse().compose(pose);
            let along_m = -ENTRY_M..=ENTRY_M.min(length_m);
            along_m.contains(&in_lane.x_m)
                && in_lane.y_m.abs() < BESIDE_M
                && in_lane.heading_rad.abs() < ALONG_RAD
        };
        let slowness = |pose: Pose2, gear: Gear| around.slowness(pose, gear);
        let mut path = self.path_finder.find(pose, &Search { slowness, left_s, is_goal })?;
        let entry_m = path.last().map_or(0.0, |last| on_lane.inverse().compose(last.pose_in_map).x_m);
        let steps = ((length_m - entry_m) / STEP_M).ceil().max(1.0) as u32;
        path.extend((1..=steps).map(|step| {
            let along_m = (entry_m + step as f32 * STEP_M).min(length_m.max(entry_m));
            Waypoint { pose_in_map: on_lane.compose(Pose2::new(along_m, 0.0, 0.0)), gear: Gear::Ahead }
        }));
        Some(path)
    }
}
