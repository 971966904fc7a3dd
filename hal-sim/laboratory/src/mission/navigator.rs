//! Decides where to drive next: tours with re-planning, one tour, lanes, or at random.

use std::collections::VecDeque;
use std::time::Instant;

use floorguard_cleaning::{Pass, PassPlaces, PassShape, PlanCells, Planner, choose_pass};
use floorguard_navigation::{FollowConfig, Following, PathSearch, SearchCell, Stretch, follow};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::random::Pcg32;

use super::config::Strategy;
use super::promise::Promise;
use floorguard_robot::site::Localiser;
use floorguard_robot::site::{CELL_M, Floor};
use floorguard_robot::site::{Lane, lanes};

/// Nodes of a tour: 1,024 cells, the robot, and the end of the path.
const NODES: usize = 1_026;
/// Re-planning interval, s (book, Cleaning: Re-planning).
const REPLAN_S: f32 = 5.0;
/// After so many visits a cell is given up, and reported.
pub const VISITS_MAX: u8 = 40;
/// With more doubt about the position than this, metres, a pass would prove little: the robot first turns once round to
/// see where it is.
const SCAN_AROUND_ABOVE_M: f32 = 0.05;
/// Later passes over a cell run this far to the left and to the right of it in turn, metres, for the rim that the ones
/// before may have missed.
const SIDE_STEP_M: f32 = 0.035;

/// A lane that was broken off begins again so far back, and so much farther on for every attempt before, metres.
const LANE_BACK_M: f32 = 0.05;
const LANE_SKIP_M: f32 = 0.05;
/// How far beside, metres.
const LANE_SIDE_M: f32 = 0.03;
/// What is left of a lane is not worth driving below this, metres.
const LANE_LEFT_M: f32 = 0.03;
/// Attempts at a lane before its rest is left out.
const LANE_TRIES_MAX: u8 = 12;

/// A pass begins and ends 10 mm outside the cell. A turn in its middle leaves 14 mm of clearance at the corners, less
/// than the 35 mm beside a straight pass, and is worth it where it saves 20 mm: measured in rooms with 5 and 20 % of
/// dirty cells.
const PASS: PassShape = PassShape { cell_m: CELL_M, margin_m: 0.01, turn_cost_m: 0.02 };

/// A planner with its memory.
type TourPlanner = Planner<Vec<SearchCell>, Vec<u16>, NODES>;

/// Drives a mission.
pub struct Navigator {
    strategy: Strategy,
    config: FollowConfig,
    planner: TourPlanner,
    routes: PathSearch<Vec<SearchCell>>,
    waypoints: VecDeque<Point2>,
    stretch_from: Point2,
    stretch_age_s: f32,
    target: Option<usize>,
    pass_begins_at: usize,
    next_plan_s: f32,
    lanes: VecDeque<(Lane, u8)>,
    lane: Option<(Lane, u8)>,
    heading_rad: f32,
    backing_left_m: f32,
    looking_left_rad: f32,
    has_scanned_around: bool,
    leavings: u8,
    random: Pcg32,
    /// Visits of every cell.
    pub visits: Vec<u8>,
    shape: PassShape,
    /// Re-plannings that changed the path.
    pub replannings: u32,
    /// All re-plannings.
    pub plans: u32,
    /// Longest re-planning after the first, s of the computer.
    pub slowest_replan_s: f64,
    /// First planning, s of the computer.
    pub first_plan_s: f64,
}

/// What the navigator wants.
pub enum NavigationRequest {
    /// Drive.
    Drive(Twist2),
    /// The mission is over.
    Done,
}

impl Navigator {
    /// Ready to start.
    pub fn new(
        floor: &Floor,
        strategy: Strategy,
        (config, brush_m): (FollowConfig, f32),
        random: Pcg32,
    ) -> Self {
        let count = floor.cells.cell_count();
        let search = || PathSearch::new(floor.cells, vec![SearchCell::EMPTY; count]);
        let start = Point2::new(floor.start.x_m, floor.start.y_m);
        let lanes = if strategy == Strategy::Systematic {
            lanes(floor, brush_m, start).into_iter().map(|lane| (lane, 0)).collect()
        } else {
            VecDeque::new()
        };
        Self {
            strategy,
            config,
            planner: Planner::new(search(), vec![0; NODES * NODES], random.clone()),
            routes: search(),
            waypoints: VecDeque::new(),
            stretch_from: start,
            stretch_age_s: 0.0,
            target: None,
            pass_begins_at: 0,
            next_plan_s: 0.0,
            lanes,
            lane: None,
            heading_rad: 0.0,
            backing_left_m: 0.0,
            looking_left_rad: 0.0,
            has_scanned_around: false,
            leavings: 0,
            random,
            visits: vec![0; count],
            shape: PASS,
            replannings: 0,
            plans: 0,
            slowest_replan_s: 0.0,
            first_plan_s: 0.0,
        }
    }

    /// Lanes that are not finished, the current one included.
    pub fn lanes_left(&self) -> usize {
        self.lanes.len() + usize::from(self.lane.is_some())
    }

    /// Goes on after a power cut: what was planned is lost, what was tried is not. `self` is as new.
    pub fn resume(&mut self, (lanes_left, visits): (usize, &[(u32, u8)]), before: &Self) {
        let done = self.lanes.len().saturating_sub(lanes_left);
        self.lanes.drain(..done);
        for &(cell, count) in visits {
            if let Some(place) = self.visits.get_mut(cell as usize) {
                *place = count;
            }
        }
        (self.replannings, self.slowest_replan_s) = (before.replannings, before.slowest_replan_s);
        self.first_plan_s = before.first_plan_s;
    }

    /// What to do from this pose at this time.
    pub fn next_request(
        &mut self,
        (floor, localiser, promise): (&Floor, &mut Localiser, &Promise),
        (pose, now_s): (Pose2, f32),
        period_s: f32,
    ) -> NavigationRequest {
        if self.backing_left_m > 0.0 {
            self.backing_left_m -= 0.05 * period_s;
            return NavigationRequest::Drive(Twist2 { linear_mps: -0.05, angular_radps: 0.0 });
        }
        if self.strategy == Strategy::Random {
            return NavigationRequest::Drive(self.random_drive(floor, pose, period_s));
        }
        let is_first = self.strategy == Strategy::NoReplanning && self.plans == 0;
        if (self.strategy == Strategy::Guarantee && now_s >= self.next_plan_s) || is_first {
            self.replan((floor, localiser, promise), (pose, now_s));
        }
        if self.looking_left_rad > 0.0 {
            self.looking_left_rad -= self.config.turn_radps * period_s;
            return NavigationRequest::Drive(Twist2 {
                linear_mps: 0.0,
                angular_radps: self.config.turn_radps,
            });
        }
        // A stretch that ends at once is followed by the next; four are more than ever follow each other.
        for _ in 0..4 {
            if self.waypoints.is_empty() && !self.choose_next((floor, localiser, promise), (pose, now_s)) {
                return NavigationRequest::Done;
            }
            let Some(&to) = self.waypoints.front() else { break };
            match follow(pose, Stretch { from: self.stretch_from, to }, &self.config, period_s) {
                Following::Drive(twist) => {
                    self.stretch_age_s += period_s;
                    self.give_up_if_stuck(Point2::new(pose.x_m, pose.y_m), to);
                    return NavigationRequest::Drive(twist);
                }
                Following::Arrived => self.arrive(to),
            }
        }
        NavigationRequest::Drive(Twist2::ZERO)
    }

    fn arrive(&mut self, to: Point2) {
        self.waypoints.pop_front();
        self.stretch_from = to;
        self.stretch_age_s = 0.0;
        if self.waypoints.is_empty() {
            self.finish_visit();
        }
    }

    fn finish_visit(&mut self) {
        self.has_scanned_around = false;
        if let Some(target) = self.target.take() {
            self.visits[target] = self.visits[target].saturating_add(1);
            if self.planner.tour().next() == Some(target) {
                self.planner.drop_first();
            }
        }
    }

    /// A stretch that takes four times as long as it should ends the visit.
    fn give_up_if_stuck(&mut self, here: Point2, to: Point2) {
        let expected = self.stretch_from.distance(to) / self.config.speed_mps + 6.0;
        if self.stretch_age_s > 4.0 * expected {
            self.resume_lane(here);
            self.waypoints.clear();
            self.stretch_age_s = 0.0;
            self.finish_visit();
        }
    }

    /// Something is on the path: back off and plan again.
    pub fn bumped(&mut self, pose: Pose2) {
        let was_backing = self.backing_left_m > 0.0;
        self.backing_left_m = if was_backing { 0.0 } else { 0.08 };
        if was_backing {
            return;
        }
        self.resume_lane(Point2::new(pose.x_m, pose.y_m));
        self.waypoints.clear();
        self.finish_visit();
        self.next_plan_s = 0.0;
    }

    /// Time that a person costs does not count against the stretch.
    pub fn waited(&mut self, period_s: f32) {
        self.stretch_age_s = (self.stretch_age_s - period_s).max(0.0);
    }

    fn replan(
        &mut self,
        (floor, localiser, promise): (&Floor, &mut Localiser, &Promise),
        (pose, now_s): (Pose2, f32),
    ) {
        let here = Point2::new(pose.x_m, pose.y_m);
        let rule = promise.rule(&localiser.map);
        let grazed = localiser.grazed(&rule);
        let is_dirty = |cell: usize| {
            localiser.map.get(cell).is_some_and(|dirt| rule.needs_cleaning(dirt))
                || grazed.binary_search(&cell).is_ok()
        };
        // A visit that has begun is finished unless its cell has become clean meanwhile, and the tour goes on from its
        // end: turning away from half of the visits cost a tenth of the distance and a quarter of the visits.
        let is_passing = self.waypoints.len() <= self.pass_begins_at;
        let visiting = self.target.filter(|&target| is_passing || is_dirty(target));
        let here = visiting.and_then(|_| self.waypoints.back().copied()).unwrap_or(here);
        let Some(cell) = floor.nearest_passable(here) else { return };
        let wanted = |cell: usize| {
            floor.reachable[cell]
                && self.visits[cell] < VISITS_MAX
                && visiting != Some(cell)
                && is_dirty(cell)
        };
        let begin = Instant::now();
        let cells = PlanCells { wanted, passable: |c: usize| floor.passable[c] };
        let report = self.planner.replan(cell, &cells, if self.plans == 0 { 20_000 } else { 500 });
        let took = begin.elapsed().as_secs_f64();
        if self.plans == 0 {
            self.first_plan_s = self.first_plan_s.max(took);
        } else {
            self.slowest_replan_s = self.slowest_replan_s.max(took);
            self.replannings += u32::from(report.is_ok_and(|r| r.path_changed && r.added > 0));
        }
        self.plans += 1;
        self.next_plan_s = now_s + REPLAN_S;
        if visiting.is_none() && self.target.is_some() && self.planner.tour().next() != self.target {
            self.target = None;
            self.waypoints.clear();
        }
    }

    /// Fills the waypoints; `false`: nothing is left to do.
    fn choose_next(
        &mut self,
        (floor, localiser, promise): (&Floor, &mut Localiser, &Promise),
        (pose, now_s): (Pose2, f32),
    ) -> bool {
        self.stretch_from = Point2::new(pose.x_m, pose.y_m);
        self.stretch_age_s = 0.0;
        if self.strategy == Strategy::Systematic {
            return self.next_lane(floor, pose);
        }
        if self.planner.tour().next().is_none() && self.strategy == Strategy::Guarantee {
            self.replan((floor, localiser, promise), (pose, now_s));
            if self.planner.tour().next().is_none() {
                // The last cells are decided only when the brush has left them.
                if localiser.active_cells() == 0 || self.leavings >= 40 {
                    return false;
                }
                self.leavings += 1;
                self.leave(floor, pose);
                self.next_plan_s = f32::MAX;
                return !self.waypoints.is_empty();
            }
        }
        self.next_plan_s = self.next_plan_s.min(now_s + REPLAN_S);
        let targets = {
            let mut tour = self.planner.tour();
            (tour.next(), tour.next())
        };
        let (Some(target), next) = targets else { return false };
        let may_scan = self.strategy == Strategy::Guarantee && !self.has_scanned_around;
        if may_scan && localiser.doubt_m() > SCAN_AROUND_ABOVE_M {
            self.has_scanned_around = true;
            self.looking_left_rad = std::f32::consts::TAU;
            return true;
        }
        self.visit(floor, pose, (target, next.map(|cell| floor.cells.centre(cell))));
        true
    }

    fn visit(&mut self, floor: &Floor, pose: Pose2, (target, next): (usize, Option<Point2>)) {
        let here = Point2::new(pose.x_m, pose.y_m);
        let is_clear = |a: Point2, b: Point2| floor.is_clear(a, b);
        self.target = Some(target);
        let centre = floor.cells.centre(target);
        let chosen = choose_pass(PassPlaces { from: here, centre, towards: next }, &self.shape, is_clear);
        match chosen.map(|pass| side_step(pass, self.visits[target], is_clear)) {
            Some(pass) => {
                self.route(floor, here, pass.entry);
                self.waypoints.push_back(pass.exit);
                self.pass_begins_at = 1;
            }
            None => {
                self.visits[target] = VISITS_MAX;
                self.finish_visit();
                self.waypoints.push_back(here);
            }
        }
    }

    fn next_lane(&mut self, floor: &Floor, pose: Pose2) -> bool {
        self.lane = self.lanes.pop_front();
        let Some(((from, to), tries)) = self.lane else { return false };
        let (from, to) = beside((from, to), tries, |a, b| floor.is_clear(a, b));
        self.route(floor, Point2::new(pose.x_m, pose.y_m), from);
        self.waypoints.push_back(to);
        true
    }

    /// A lane that was broken off is driven on from where the robot is: what is left of it must not stay dirty.
    fn resume_lane(&mut self, here: Point2) {
        let Some(((from, to), tries)) = self.lane.take() else { return };
        let length_m = from.distance(to).max(1e-6);
        let (ux, uy) = ((to.x_m - from.x_m) / length_m, (to.y_m - from.y_m) / length_m);
        let (dx, dy) = (here.x_m - from.x_m, here.y_m - from.y_m);
        let (along_m, off_m) = (dx * ux + dy * uy, (dx * uy - dy * ux).abs());
        // On the way to the lane nothing of it is done; the same place is left out only after several attempts.
        let done_m = if off_m < 0.1 && along_m > 0.0 {
            along_m - LANE_BACK_M + f32::from(tries) * LANE_SKIP_M
        } else {
            f32::from(tries) * LANE_SKIP_M
        };
        let done_m = done_m.max(0.0);
        if tries < LANE_TRIES_MAX && length_m - done_m > LANE_LEFT_M {
            let on = Point2::new(from.x_m + done_m * ux, from.y_m + done_m * uy);
            self.lanes.push_front(((on, to), tries + 1));
        }
    }

    /// Drives to some place at least 0.4 m away.
    fn leave(&mut self, floor: &Floor, pose: Pose2) {
        let here = Point2::new(pose.x_m, pose.y_m);
        for attempt in 0..64 {
            let angle = pose.heading_rad + 0.4 * attempt as f32;
            let distance = 0.5 + 0.01 * attempt as f32;
            let there = Point2::new(here.x_m + distance * angle.cos(), here.y_m + distance * angle.sin());
            if floor.is_clear(here, there) {
                self.waypoints.push_back(there);
                return;
            }
        }
        let Some(cell) = floor.nearest_passable(here) else { return };
        let mut far = None;
        self.routes.run_until(
            cell,
            |c| floor.passable[c],
            |c| {
                let is_far = floor.cells.centre(c).distance(here) > 0.4;
                far = is_far.then_some(c);
                is_far
            },
        );
        if let Some(far) = far {
            self.route(floor, here, floor.cells.centre(far));
        }
    }

    /// Waypoints from here to there around obstacles.
    fn route(&mut self, floor: &Floor, here: Point2, there: Point2) {
        if floor.is_clear(here, there) {
            self.waypoints.push_back(there);
            return;
        }
        let (Some(from), Some(to)) = (floor.nearest_passable(here), floor.nearest_passable(there)) else {
            self.waypoints.push_back(there);
            return;
        };
        self.routes.run_until(to, |c| floor.passable[c], |c| c == from);
        let mut cells = vec![from];
        let mut cell = from;
        for _ in 0..floor.cells.cell_count() {
            let Some(next) = self.routes.towards_start(cell) else { break };
            cells.push(next);
            cell = next;
        }
        let points: Vec<Point2> = cells.iter().map(|&c| floor.cells.centre(c)).chain([there]).collect();
        // Pulls the string tight: on to the last point that is in clear sight.
        let mut anchor = here;
        let mut index = 0;
        while index < points.len() {
            let last = (index..points.len()).rev().find(|&i| floor.is_clear(anchor, points[i]));
            let next = last.unwrap_or(index);
            anchor = points[next];
            self.waypoints.push_back(anchor);
            index = next + 1;
        }
    }

    fn random_drive(&mut self, floor: &Floor, pose: Pose2, period_s: f32) -> Twist2 {
        let error = floorguard_types::geometry::wrap_angle(self.heading_rad - pose.heading_rad);
        if error.abs() > 0.05 {
            let rate = (error / period_s).clamp(-self.config.turn_radps, self.config.turn_radps);
            return Twist2 { linear_mps: 0.0, angular_radps: rate };
        }
        let ahead = |angle: f32| {
            let point = Point2::new(pose.x_m + 0.02 * angle.cos(), pose.y_m + 0.02 * angle.sin());
            floor.clearance.clearance_m(point)
        };
        let here = floor.clearance.clearance_m(Point2::new(pose.x_m, pose.y_m));
        // Stops 0.05 m before an obstacle; where it stands nearer, any escape path is good.
        let limit = floor.robot_radius_m + 0.05;
        let is_open = |angle: f32| ahead(angle) >= limit || ahead(angle) > here;
        if is_open(self.heading_rad) {
            return Twist2 { linear_mps: self.config.speed_mps, angular_radps: 0.0 };
        }
        for _ in 0..32 {
            let angle = self.random.uniform_between(-std::f32::consts::PI, std::f32::consts::PI);
            if is_open(angle) {
                self.heading_rad = angle;
                break;
            }
        }
        Twist2::ZERO
    }
}

/// A lane that was broken off is driven a little beside itself, to the right and to the left in turn.
fn beside((from, to): Lane, tries: u8, is_clear: impl Fn(Point2, Point2) -> bool) -> Lane {
    let side_m = match tries % 3 {
        0 => return (from, to),
        1 => LANE_SIDE_M,
        _ => -LANE_SIDE_M,
    };
    let length_m = from.distance(to).max(1e-6);
    let (ux, uy) = ((to.x_m - from.x_m) / length_m, (to.y_m - from.y_m) / length_m);
    let shift = |point: Point2| Point2::new(point.x_m - uy * side_m, point.y_m + ux * side_m);
    let shifted = (shift(from), shift(to));
    if is_clear(shifted.0, shifted.1) { shifted } else { (from, to) }
}

/// The first pass goes over the middle of the cell, the next ones beside it where there is space.
fn side_step(pass: Pass, visits: u8, is_clear: impl Fn(Point2, Point2) -> bool) -> Pass {
    let side_m = match visits % 3 {
        0 => return pass,
        1 => SIDE_STEP_M,
        _ => -SIDE_STEP_M,
    };
    let length_m = pass.entry.distance(pass.exit).max(1e-6);
    let (ux, uy) = ((pass.exit.x_m - pass.entry.x_m) / length_m, (pass.exit.y_m - pass.entry.y_m) / length_m);
    let beside = |point: Point2| Point2::new(point.x_m - uy * side_m, point.y_m + ux * side_m);
    let beside = Pass { entry: beside(pass.entry), exit: beside(pass.exit) };
    if is_clear(beside.entry, beside.exit) { beside } else { pass }
}
