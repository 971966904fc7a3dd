//! Attentive people: who makes no headway takes a detour, and who sees the robot ahead walks round it in time.
//!
//! Social forces balance here and there: a body that is pulled towards its goal and pushed off by somebody who stands
//! in between comes to rest, and would stand there for ever; and they let people walk up to a robot and turn aside only
//! when they touch it. People do neither: they choose the cheapest path, where walking close to walls and to others
//! counts as longer (Hoogendoorn and Bovy, "Pedestrian route-choice and activity scheduling theory and models",
//! Transportation Research B 38, 2004), and begin to walk round each other metres before they meet (Moussaïd, Helbing
//! and Theraulaz, "How simple rules determine pedestrian behavior and crowd disasters", PNAS 108, 2011). Here who has
//! been held up for a moment, or sees the robot ahead, chooses such a path over a raster around the own place;
//! everybody else follows the forces.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use floorguard_types::geometry::Point2;

use super::Person;
use super::bump::RobotShape;
use crate::scene::Scene;

/// Slower than this share of the wanted speed is no headway.
const HELD_UP: f32 = 0.3;
/// Time without headway before a person takes a detour, seconds; the other of two who meet does so later.
const PATIENCE_S: (f32, f32) = (0.8, 0.4);
/// People that differ in this remainder of their numbers differ in patience.
const KINDS_OF_PATIENCE: u32 = 4;
/// A detour is followed for at most so long, seconds.
const WALKS_S: f32 = 8.0;
/// The place that is walked to lies so far ahead on the detour, metres.
const AHEAD_M: f32 = 0.7;
/// Who sees the robot walks round it from this distance on, metres, looks again this often, seconds, and passes it with
/// this gap if there is space, metres.
const SEES_M: f32 = 3.5;
const CHECK_PERIOD_S: f32 = 1.0;
const BESIDE_M: f32 = 0.6;
/// Edge of a cell, metres, and cells from the own place to the edge of the raster: 6 m.
const CELL_M: f32 = 0.2;
const REACH: i32 = 30;
const SIDE: usize = 2 * REACH as usize + 1;
/// Others that walk faster are gone in a moment, m/s.
const STANDS_MPS: f32 = 0.25;
/// Weight of a metre of the detour against a metre that is left behind it.
const DETOUR: f32 = 0.08;
/// Gap to what stands there that is as good as none, metres, and the cost of a path through a gap of nothing, and
/// through what stands there: nobody walks through it who is not in it already.
const CLEARANCE_M: f32 = 0.3;
const TIGHT: f32 = 5.0;
const THROUGH: f32 = 80.0;

/// A person held up this near to an occupied goal goes on to the next one, metres.
const TAKEN_M: f32 = 2.0;

/// Where somebody walks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// Straight to the goal.
    Goal,
    /// To a place on the detour.
    Place(Point2),
    /// The goal is taken: to the next one.
    NextGoal,
}

/// How long a person has made no headway, and the detour taken then.
#[derive(Clone, Debug, Default)]
pub struct Detour {
    held_up_s: f32,
    left_s: f32,
    next_detour_check_s: f32,
    /// Places from the end of the detour to its beginning.
    path: Vec<Point2>,
}

/// What stands around somebody.
#[derive(Clone, Copy)]
pub struct Around<'a> {
    /// Everybody, the one who looks among them.
    pub people: &'a [Person],
    /// Walls and furniture.
    pub scene: &'a Scene,
    /// The robot.
    pub robot: &'a RobotShape<'a>,
}

impl Detour {
    /// Where to walk at this moment.
    pub fn aim(&mut self, person: &Person, (goal, step_s): (Point2, f32), around: Around<'_>) -> Aim {
        let is_held_up = person.velocity.norm() < HELD_UP * person.speed_mps;
        self.held_up_s = if is_held_up { self.held_up_s + step_s } else { 0.0 };
        self.left_s -= step_s;
        if self.left_s < 0.0 {
            self.path.clear();
        }
        let patience_s = PATIENCE_S.0 + PATIENCE_S.1 * (person.id % KINDS_OF_PATIENCE) as f32;
        let has_enough = self.held_up_s >= patience_s;
        if has_enough && person.position.distance(goal) < TAKEN_M && is_taken(person, goal, around) {
            *self = Self::default();
            return Aim::NextGoal;
        }
        self.next_detour_check_s -= step_s;
        let checks = self.next_detour_check_s <= 0.0 && person.sees_robot && bars(around.robot, person, goal);
        if checks || has_enough {
            self.path = path(person, goal, around);
            (self.held_up_s, self.left_s, self.next_detour_check_s) = (0.0, WALKS_S, CHECK_PERIOD_S);
        }
        while self.path.last().is_some_and(|next| next.distance(person.position) < AHEAD_M) {
            self.path.pop();
        }
        self.path.last().map_or(Aim::Goal, |place| Aim::Place(*place))
    }
}

/// Somebody or the robot stands where this one wants to go.
fn is_taken(person: &Person, goal: Point2, around: Around<'_>) -> bool {
    count(person, goal, around) >= THROUGH
}

/// The robot stands on the straight path to the goal, near enough to be walked round.
fn bars(robot: &RobotShape<'_>, person: &Person, goal: Point2) -> bool {
    let (middle, radius_m) = (robot.pose.transform(robot.seen_as.0), robot.seen_as.1);
    let to_goal_m = person.position.distance(goal).max(0.01);
    let (ux, uy) =
        ((goal.x_m - person.position.x_m) / to_goal_m, (goal.y_m - person.position.y_m) / to_goal_m);
    let (dx, dy) = (middle.x_m - person.position.x_m, middle.y_m - person.position.y_m);
    let (along_m, aside_m) = (dx * ux + dy * uy, (dy * ux - dx * uy).abs());
    along_m > 0.0 && along_m < SEES_M.min(to_goal_m + radius_m) && aside_m < radius_m + person.kind.radius_m()
}

/// The cheapest path to the goal, or to the place of the raster that is nearest to it; from its end to its
/// beginning.
fn path(person: &Person, goal: Point2, around: Around<'_>) -> Vec<Point2> {
    let index = |(x, y): (i32, i32)| (y + REACH) as usize * SIDE + (x + REACH) as usize;
    let place = |(x, y): (i32, i32)| {
        Point2::new(person.position.x_m + x as f32 * CELL_M, person.position.y_m + y as f32 * CELL_M)
    };
    // Cost, the cell before, and the cost of a path through the cell, for each cell; costs in hundredths of a
    // metre.
    let mut costs = vec![(u32::MAX, (0, 0)); SIDE * SIDE];
    let mut counts = vec![0.0_f32; SIDE * SIDE];
    let mut open = BinaryHeap::from([(Reverse(0_u32), (0, 0))]);
    costs[index((0, 0))] = (0, (0, 0));
    let mut best = ((0, 0), f32::INFINITY);
    while let Some((Reverse(cost), cell)) = open.pop() {
        if cost > costs[index(cell)].0 {
            continue;
        }
        let worth = place(cell).distance(goal) * 100.0 + DETOUR * cost as f32;
        if worth < best.1 {
            best = (cell, worth);
        }
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)] {
            let next = (cell.0 + dx, cell.1 + dy);
            if next.0.abs() > REACH || next.1.abs() > REACH {
                continue;
            }
            let at = index(next);
            if counts[at] == 0.0 {
                counts[at] = count(person, place(next), around);
            }
            let step = CELL_M * if dx != 0 && dy != 0 { core::f32::consts::SQRT_2 } else { 1.0 };
            let next_cost = cost.saturating_add((100.0 * step * counts[at]) as u32);
            if next_cost < costs[at].0 {
                costs[at] = (next_cost, cell);
                open.push((Reverse(next_cost), next));
            }
        }
    }
    let mut path = Vec::new();
    let mut cell = best.0;
    while cell != (0, 0) {
        path.push(place(cell));
        cell = costs[index(cell)].1;
    }
    path
}

/// Cost factor of a path through a place, 1 in the open.
fn count(person: &Person, place: Point2, around: Around<'_>) -> f32 {
    let radius_m = person.kind.radius_m();
    let wall_m = around.scene.nearest_obstacle(place).map_or(f32::INFINITY, |(_, gap_m)| gap_m) - radius_m;
    let stands = |other: &&Person| other.id != person.id && other.velocity.norm() < STANDS_MPS;
    let others = around.people.iter().filter(stands);
    let gap_m = others.map(|other| other.position.distance(place) - other.kind.radius_m() - radius_m);
    let robot_m = around.robot.gap_m(place) - radius_m;
    let gap_m = gap_m.fold(wall_m, f32::min);
    if gap_m.min(robot_m) < 0.0 {
        return THROUGH;
    }
    let tight = (1.0 - gap_m / CLEARANCE_M).max(1.0 - robot_m / BESIDE_M).max(0.0);
    1.0 + (TIGHT - 1.0) * tight
}

#[cfg(test)]
mod tests {
    use floorguard_types::geometry::Pose2;

    use super::super::{Crowd, PersonKind};
    use super::*;
    use crate::robot::RobotParameters;
    use crate::scenario::Scenario;

    /// Three minutes of twenty people around a robot that stands on their path: the longest that somebody who wants to
    /// walk stands at a place, seconds, and the share of the time with somebody this near to the robot.
    fn three_minutes(robot: Pose2, attentive: bool) -> (u32, f32) {
        let parameters = RobotParameters::default();
        let scenario = Scenario::named("busy-supermarket").unwrap();
        let scene = scenario.scene.build();
        let shape = RobotShape {
            pose: robot,
            outline: &parameters.footprint,
            seen_as: (Point2::new(0.25, 0.0), 0.85),
        };
        let mut crowd = Crowd::new(scenario.people(1)).with_attention(attentive);
        let mut stands: Vec<(Point2, u32, u32)> = crowd.people.iter().map(|p| (p.position, 0, 0)).collect();
        let mut near = 0;
        for step in 0..18_000_u64 {
            crowd.step(step * 10_000, 0.01, &scene, &shape);
            let walks = |person: &&Person| person.speed_mps > 0.0 && person.starts_us < step * 10_000;
            near += u32::from(crowd.people.iter().filter(walks).any(|p| shape.gap_m(p.position) < 0.3));
            if !step.is_multiple_of(100) {
                continue;
            }
            for (person, (place, now_s, longest_s)) in crowd.people.iter().zip(&mut stands) {
                let is_there = walks(&person) && person.position.distance(*place) < 0.1;
                *now_s = if is_there { *now_s + 1 } else { 0 };
                *longest_s = (*longest_s).max(*now_s);
                *place = person.position;
            }
        }
        (stands.iter().map(|stand| stand.2).max().unwrap_or(0), near as f32 / 18_000.0)
    }

    #[test]
    fn no_person_stands_forever_few_approach() {
        for robot in [Pose2::new(5.0, 0.0, 0.0), Pose2::new(10.0, 5.2, 0.0)] {
            let (stands_s, near) = three_minutes(robot, true);
            assert!(stands_s <= 8, "somebody stands for {stands_s} s");
            assert!(near < 0.02, "for {near} of the time somebody is close to {robot:?}");
        }
        let (stands_s, near) = three_minutes(Pose2::new(10.0, 5.2, 0.0), false);
        assert!(stands_s > 60 && near > 0.04, "forces alone: {stands_s} s, {near}");
    }

    /// Somebody stands where another one wants to go: it is no goal any more.
    #[test]
    fn occupied_goal_is_skipped() {
        let parameters = RobotParameters::default();
        let scenario = Scenario::named("busy-supermarket").unwrap();
        let shape = RobotShape {
            pose: Pose2::new(14.0, 6.0, 0.0),
            outline: &parameters.footprint,
            seen_as: (Point2::new(0.25, 0.0), 0.85),
        };
        let mut walker = scenario.people(1).remove(0);
        // In a wheelchair nobody gets so near to somebody that the goal counts as reached.
        walker.kind = PersonKind::Wheelchair;
        walker.position = Point2::new(9.0, 0.0);
        let taken = Point2::new(5.3, 0.0);
        walker.goals = vec![taken, Point2::new(12.0, 0.0)];
        let stander = Person { id: 2, position: taken, speed_mps: 0.0, goals: Vec::new(), ..walker.clone() };
        let mut crowd = Crowd::new(vec![walker, stander]).with_attention(true);
        let scene = scenario.scene.build();
        let mut farthest_m = 0.0_f32;
        for step in 0..2_500_u64 {
            crowd.step(step * 10_000, 0.01, &scene, &shape);
            farthest_m = farthest_m.max(crowd.people[0].position.x_m);
        }
        assert!(farthest_m > 11.0, "{farthest_m}");
    }
}
