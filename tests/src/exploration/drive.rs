//! A robot that explores: it follows shortest paths over known floor, scans as it goes, and decides again every metre and a half.

use std::f32::consts::PI;

use floorguard_navigation::costmap::Costs;
use floorguard_navigation::{PathSearch, SearchCell};
use floorguard_types::geometry::{Point2, Pose2};

use super::building::{Building, Known};
use super::rules::{Choice, Rules, Target};

/// A scan every so many metres.
const SCAN_M: f32 = 0.2;
/// A decision every so many metres: three seconds at 0.5 m/s, as the published launch file.
const DECIDE_M: f32 = 1.5;
/// A decision takes so long, whether the robot moves or not: the published rate, seconds.
const DECISION_S: f32 = 3.0;
/// Who moves less for the same target is there, metres.
const THERE_M: f32 = 0.3;
/// A frontier whose middle moved by more was another one, metres.
const SAME_M: f32 = 1.0;
/// Decisions in a building at most.
const DECISIONS_MAX: u32 = 1_500;

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Explored {
    /// Share of the reachable floor that is known.
    pub covered_share: f64,
    /// Driven, metres.
    pub way_m: f64,
    /// Decisions.
    pub decisions: u32,
    /// The rules themselves found that nothing is left.
    pub has_ended: bool,
    /// Where the robot was each time that a target was done: reached, seen from afar, or left for another.
    pub view_points: Vec<Point2>,
}

struct Drive<'a> {
    building: &'a Building,
    known: Known,
    search: PathSearch<Vec<SearchCell>>,
    robot: Point2,
    heading_rad: f32,
    explored: Explored,
}

/// Explores a building from its start to the end, or to a limit of decisions.
///
/// # Errors
/// The building makes no raster.
pub fn explore(building: &Building, rules: Rules) -> anyhow::Result<Explored> {
    let geometry = &building.geometry;
    let mut choice = Choice::new(rules, geometry)?;
    let search = PathSearch::new(*geometry, vec![SearchCell::EMPTY; geometry.cell_count()]);
    let known = Known::new(geometry)?;
    let explored = Explored {
        covered_share: 0.0,
        way_m: 0.0,
        decisions: 0,
        has_ended: false,
        view_points: vec![building.start],
    };
    let mut drive = Drive { building, known, search, robot: building.start, heading_rad: 0.0, explored };
    // It turns once on the spot.
    drive.scan(0.0);
    drive.scan(PI);
    let (mut target, mut looked): (Option<Target>, bool) = (None, false);
    for _ in 0..DECISIONS_MAX {
        drive.known.refresh(geometry);
        drive.explored.decisions += 1;
        let next = choice.next(drive.known.costmap(geometry), drive.robot, DECISION_S);
        let is_done = |old: &Target| next.is_none_or(|new| new.frontier.distance(old.frontier) > SAME_M);
        if target.as_ref().is_some_and(is_done) {
            drive.explored.view_points.push(drive.robot);
        }
        let Some(next) = next else {
            drive.explored.has_ended = true;
            break;
        };
        let is_same = target.replace(next).is_some_and(|old| old.frontier.distance(next.frontier) <= SAME_M);
        let is_there = drive.follow(next.place) < THERE_M;
        if is_there && is_same && looked {
            choice.give_up();
            drive.explored.view_points.push(drive.robot);
        } else if is_there {
            // There already, and still a frontier: a turn shows what lies behind, or nothing does.
            drive.scan(drive.heading_rad + PI);
        }
        looked = is_there;
    }
    drive.explored.covered_share = building.covered_share(&drive.known);
    Ok(drive.explored)
}

impl Drive<'_> {
    fn scan(&mut self, heading_rad: f32) {
        self.building.scan(Pose2::new(self.robot.x_m, self.robot.y_m, heading_rad), &mut self.known);
    }

    /// Towards a place for as long as a decision holds; metres driven.
    fn follow(&mut self, place: Point2) -> f32 {
        let geometry = &self.building.geometry;
        let (Some(goal), Some(mut here)) = (geometry.cell_at(place), geometry.cell_at(self.robot)) else {
            return 0.0;
        };
        let costs = self.known.costs();
        self.search.run_until(goal, |cell| costs[cell] < Costs::INSCRIBED, |cell| cell == here);
        let (mut went_m, mut since_scan_m) = (0.0, 0.0);
        while went_m < DECIDE_M
            && let Some(next) = self.search.towards_start(here)
        {
            let (from, to) = (geometry.centre(here), geometry.centre(next));
            went_m += from.distance(to);
            since_scan_m += from.distance(to);
            self.heading_rad = libm::atan2f(to.y_m - from.y_m, to.x_m - from.x_m);
            (self.robot, here) = (to, next);
            if since_scan_m >= SCAN_M {
                since_scan_m = 0.0;
                self.scan(self.heading_rad);
            }
        }
        self.scan(self.heading_rad);
        self.explored.way_m += f64::from(went_m);
        went_m
    }
}
