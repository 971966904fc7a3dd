//! Decides where to drive next: tours with re-planning, one tour, lanes, or at random.

use std::collections::VecDeque;
use std::time::Instant;

use floorguard_cleaning::{
    Lane, LaneAttempt, LaneQueue, LaneRules, PassPlaces, PassShape, PlanCells, Planner, VisitPlan,
    choose_pass,
};
use floorguard_navigation::{FollowConfig, Following, PathSearch, SearchCell, Stretch, follow};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::random::Pcg32;

use super::config::Strategy;
use super::promise::Promise;
use super::random_drive::RandomDrive;
use super::routes::Routes;
use floorguard_robot::site::{CELL_M, Floor, Localiser, lanes};

/// Nodes of a tour: 1,024 cells, the robot, and the end of the path.
const NODES: usize = 1_026;
/// After so many visits a cell is given up, and reported.
pub const VISITS_MAX: u8 = 40;
/// With more doubt about the position than this, metres, a pass would prove little: the robot first turns once round to
/// see where it is.
const SCAN_AROUND_ABOVE_M: f32 = 0.05;
/// Later passes over a cell run this far to the left and to the right of it in turn, metres, for the rim that the ones
/// before may have missed.
const SIDE_STEP_M: f32 = 0.035;

/// A lane that was broken off is driven again this far beside itself, metres.
const LANE_SIDE_M: f32 = 0.03;
/// When it is driven again.
const LANES: LaneRules =
    LaneRules { back_m: 0.05, skip_m: 0.05, left_min_m: 0.03, off_max_m: 0.1, tries_max: 12 };

/// A pass begins and ends 10 mm outside the cell. A turn in its middle leaves 14 mm of clearance at the corners, less
/// than the 35 mm beside a straight pass, and is worth it where it saves 20 mm: measured in rooms with 5 and 20 % of
/// dirty cells.
const PASS: PassShape = PassShape { cell_m: CELL_M, margin_m: 0.01, turn_cost_m: 0.02 };

/// Tours with their memory.
type Tours = VisitPlan<Vec<SearchCell>, Vec<u16>, Vec<u8>, NODES>;

/// Drives a mission.
pub struct Navigator {
    strategy: Strategy,
    config: FollowConfig,
    plan: Tours,
    routes: Routes,
    waypoints: VecDeque<Point2>,
    stretch_from: Point2,
    stretch_age_s: f32,
    target: Option<usize>,
    pass_begins_at: usize,
    lanes: LaneQueue<Vec<LaneAttempt>>,
    random_drive: RandomDrive,
    backing_left_m: f32,
    looking_left_rad: f32,
    has_scanned_around: bool,
    leavings: u8,
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
            lanes(floor, brush_m, start).into_iter().map(LaneAttempt::from).collect()
        } else {
            vec![]
        };
        let planner = Planner::new(search(), vec![0; NODES * NODES], random.clone());
        Self {
            strategy,
            config,
            plan: VisitPlan::new(planner, vec![0; count], VISITS_MAX),
            routes: Routes::new(search()),
            waypoints: VecDeque::new(),
            stretch_from: start,
            stretch_age_s: 0.0,
            target: None,
            pass_begins_at: 0,
            lanes: LaneQueue::new(lanes),
            random_drive: RandomDrive::new(config, random),
            backing_left_m: 0.0,
            looking_left_rad: 0.0,
            has_scanned_around: false,
            leavings: 0,
            shape: PASS,
            replannings: 0,
            plans: 0,
            slowest_replan_s: 0.0,
            first_plan_s: 0.0,
        }
    }

    /// Lanes that are not finished, the current one included.
    pub fn lanes_left(&self) -> usize {
        self.lanes.left()
    }

    /// Visits of every cell.
    pub fn visits(&self) -> &[u8] {
        self.plan.visits()
    }

    /// Goes on after a power cut: what was planned is lost, what was tried is not. `self` is as new.
    pub fn resume(&mut self, (lanes_left, visits): (usize, &[(u32, u8)]), before: &Self) {
        self.lanes.keep_last(lanes_left);
        visits.iter().for_each(|&(cell, count)| self.plan.set_visits(cell as usize, count));
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
            return NavigationRequest::Drive(self.random_drive.twist(floor, pose, period_s));
        }
        let is_first = self.strategy == Strategy::NoReplanning && self.plans == 0;
        if (self.strategy == Strategy::Guarantee && self.plan.is_due(now_s)) || is_first {
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
            self.plan.finish(target);
        }
    }

    /// A stretch that takes four times as long as it should ends the visit.
    fn give_up_if_stuck(&mut self, here: Point2, to: Point2) {
        let expected = self.stretch_from.distance(to) / self.config.speed_mps + 6.0;
        if self.stretch_age_s > 4.0 * expected {
            self.lanes.break_off(here, &LANES);
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
        self.lanes.break_off(Point2::new(pose.x_m, pose.y_m), &LANES);
        self.waypoints.clear();
        self.finish_visit();
        self.plan.plan_at(0.0);
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
        let dirty = localiser.dirty(&rule);
        // A visit that has begun is finished unless its cell has become clean meanwhile, and the tour goes on from its
        // end: turning away from half of the visits cost a tenth of the distance and a quarter of the visits.
        let is_passing = self.waypoints.len() <= self.pass_begins_at;
        let visiting = self.target.filter(|&target| is_passing || dirty.contains(target));
        let here = visiting.and_then(|_| self.waypoints.back().copied()).unwrap_or(here);
        let Some(cell) = floor.nearest_passable(here) else { return };
        let wanted = |cell: usize| floor.reachable[cell] && visiting != Some(cell) && dirty.contains(cell);
        let begin = Instant::now();
        let cells = PlanCells { wanted, passable: |c: usize| floor.passable[c] };
        let experiments = if self.plans == 0 { 20_000 } else { 500 };
        let report = self.plan.replan((cell, now_s), &cells, experiments);
        let took = begin.elapsed().as_secs_f64();
        if self.plans == 0 {
            self.first_plan_s = self.first_plan_s.max(took);
        } else {
            self.slowest_replan_s = self.slowest_replan_s.max(took);
            self.replannings += u32::from(report.is_ok_and(|r| r.path_changed && r.added > 0));
        }
        self.plans += 1;
        if visiting.is_none() && self.target.is_some() && self.plan.tour().next() != self.target {
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
        if self.plan.tour().next().is_none() && self.strategy == Strategy::Guarantee {
            self.replan((floor, localiser, promise), (pose, now_s));
            if self.plan.tour().next().is_none() {
                // The last cells are decided only when the brush has left them.
                if localiser.active_cells() == 0 || self.leavings >= 40 {
                    return false;
                }
                self.leavings += 1;
                self.waypoints.extend(self.routes.away(floor, pose));
                self.plan.plan_at(f32::MAX);
                return !self.waypoints.is_empty();
            }
        }
        self.plan.plan_soon(now_s);
        let targets = {
            let mut tour = self.plan.tour();
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
        // The first pass goes over the middle of the cell, the next ones beside it where there is space.
        let visits = self.plan.visits_of(target);
        let beside = chosen
            .map(|pass| Lane { from: pass.entry, to: pass.exit }.attempt(visits, SIDE_STEP_M, is_clear));
        match beside {
            Some(pass) => {
                self.waypoints.extend(self.routes.between(floor, here, pass.from));
                self.waypoints.push_back(pass.to);
                self.pass_begins_at = 1;
            }
            None => {
                self.plan.give_up(target);
                self.finish_visit();
                self.waypoints.push_back(here);
            }
        }
    }

    fn next_lane(&mut self, floor: &Floor, pose: Pose2) -> bool {
        let Some(LaneAttempt { lane, tries }) = self.lanes.advance() else { return false };
        let lane = lane.attempt(tries, LANE_SIDE_M, |a, b| floor.is_clear(a, b));
        let here = Point2::new(pose.x_m, pose.y_m);
        self.waypoints.extend(self.routes.between(floor, here, lane.from));
        self.waypoints.push_back(lane.to);
        true
    }
}
