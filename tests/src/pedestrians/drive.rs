//! One drive through a crowd, judged by true positions.

use std::collections::{BTreeMap, BTreeSet};

use floorguard_robot::navigator::{GuardModel, LocalPlanning};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::motion::{Footprint, MovingPerson, PermittedMotion as _, PlannedMotion};

use super::crowd::{Behaviour, CROWD_STEP_S, Crowd, RobotBody};
use super::policy::{Driver, Known, Policy};
use super::recording::Recording;
use super::start::Start;

/// A drive that takes longer has failed, seconds.
pub const LIMIT_S: f32 = 60.0;
/// The goal is reached within, metres.
const REACHED_M: f32 = 0.5;
/// Who met the robot is followed for so long after it, seconds.
const AFTER_S: f32 = 40.0;
/// Farther away nobody is known, metres, and what is known is doubtful by so much, metres and m/s.
const SEEN_M: f32 = 10.0;
const DEVIATION_M: f32 = 0.1;
const DEVIATION_MPS: f32 = 0.15;
/// Of somebody who has only just appeared, m/s.
const NEW_DEVIATION_MPS: f32 = 0.7;
/// People who never came nearer to the body than this did not meet it, metres.
const NEAR_M: f32 = 3.0;
/// Who first appears nearer to the body than this did not come there, metres.
const APPEARS_M: f32 = 1.0;
/// Half the breadth of a person, metres.
const BODY_M: f32 = 0.25;
/// An outline that comes towards a person slower than this is walked into, m/s.
const DRIVES_MPS: f32 = 0.05;

/// The robot of the experiment.
pub struct Robot {
    /// Its true outline.
    pub body: Footprint,
    /// What its planners know.
    pub planning: LocalPlanning,
    /// Its guard's rules for people.
    pub guard: GuardModel,
}

/// A drive to be made.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// From where, when and whereto.
    pub start: Start,
    /// What people make of the robot.
    pub behaviour: Behaviour,
    /// Who drives.
    pub policy: Policy,
    /// Of the planner.
    pub seed: u64,
}

/// How a drive went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Driven {
    /// The goal was reached.
    pub is_reached: bool,
    /// Until then, or the limit, seconds.
    pub time_s: f32,
    /// Least distance between a person and the body, metres, ≥ 0.
    pub least_m: f32,
    /// Mean over the people near the robot of the least distance of each, metres.
    pub passing_m: f32,
    /// People who were hit by the moving body.
    pub driven_into: u32,
    /// People who touched the body by their own motion.
    pub walked_into: u32,
    /// Detour of the people near the robot, summed, metres.
    pub detour_m: f32,
    /// Their delay, summed, seconds.
    pub delay_s: f32,
    /// How many came near.
    pub people: u32,
}

struct Run<'a> {
    robot: &'a Robot,
    guard: GuardModel,
    pose: Pose2,
    twist: Twist2,
    held_s: f32,
    /// The nearest that each came, metres, by number of the walk.
    nearest_m: BTreeMap<usize, f32>,
    /// Who appeared beside the robot: the recording begins there, and nobody could keep clear.
    appeared: BTreeSet<usize>,
    driven: Driven,
}

/// Drives; `alone` is the same crowd without a robot, played to its end, to compare how people walk with.
#[must_use]
pub fn drive(robot: &Robot, recording: &Recording, (trial, alone): (&Trial, Option<&Crowd<'_>>)) -> Driven {
    let Trial { start, policy, behaviour, .. } = *trial;
    let mut crowd = Crowd::new(recording, behaviour, start.begins_s);
    let mut driver = Driver::new(&robot.planning, policy, (start.pose, start.goal, trial.seed));
    let mut run = Run {
        robot,
        guard: robot.guard.clone(),
        pose: start.pose,
        twist: Twist2::ZERO,
        held_s: 0.0,
        nearest_m: BTreeMap::new(),
        appeared: BTreeSet::new(),
        driven: Driven::default(),
    };
    let period_s = robot.planning.period_s;
    let halves = (period_s / CROWD_STEP_S).round() as u32;
    for period in 0..(LIMIT_S / period_s) as u32 {
        run.driven.time_s = period as f32 * period_s;
        let here = Point2::new(run.pose.x_m, run.pose.y_m);
        if here.distance(start.goal) < REACHED_M {
            run.driven.is_reached = true;
            break;
        }
        let people = known_people(&crowd, here);
        run.guard.meet(&people, here);
        let known = Known { pose: run.pose, twist: run.twist, people: &people, guard: &run.guard };
        let request = driver.request(&known);
        run.obey(request);
        for _ in 0..halves {
            run.pose = run.pose.after(run.twist, CROWD_STEP_S);
            crowd.step(Some(RobotBody { outline: &robot.body, pose: run.pose, twist: run.twist }));
            run.judge(&crowd);
        }
    }
    let nearest = run.nearest_m.values();
    run.driven.people = run.nearest_m.len() as u32;
    run.driven.least_m = nearest.clone().copied().fold(NEAR_M, f32::min);
    run.driven.passing_m =
        if run.nearest_m.is_empty() { NEAR_M } else { nearest.sum::<f32>() / run.driven.people as f32 };
    if let Some(alone) = alone {
        run.compare(crowd, alone);
    }
    run.driven
}

/// The same crowd without a robot, until everybody who could meet one has left.
#[must_use]
pub fn undisturbed<'a>(recording: &'a Recording, start: &Start) -> Crowd<'a> {
    let mut crowd = Crowd::new(recording, Behaviour::Reacting, start.begins_s);
    for _ in 0..((LIMIT_S + AFTER_S) / CROWD_STEP_S) as u32 {
        crowd.step(None);
    }
    crowd
}

/// Everybody near, as a tracker would know them: without noise, but not the future.
fn known_people(crowd: &Crowd<'_>, here: Point2) -> Vec<MovingPerson> {
    let near = crowd.walkers.values().filter(|walker| walker.place.distance(here) < SEEN_M);
    near.map(|walker| {
        let (velocity_in_map_mps, is_sure) = walker.known_velocity();
        MovingPerson {
            position_in_map: walker.place,
            velocity_in_map_mps,
            position_deviation_m: DEVIATION_M,
            velocity_deviation_mps: if is_sure { DEVIATION_MPS } else { NEW_DEVIATION_MPS },
        }
    })
    .collect()
}

impl Run<'_> {
    /// What drive and guard make of a request for a period.
    fn obey(&mut self, request: Twist2) {
        let planning = &self.robot.planning;
        let reachable = |request| planning.drive.reachable(self.twist, request, planning.period_s);
        let twist = reachable(request);
        let permission = self.guard.permission(PlannedMotion { pose_in_map: self.pose, twist, in_s: 0.0 });
        if permission.held_s > 0.0 {
            self.held_s = permission.held_s;
        }
        let share = permission.share;
        self.twist = if self.held_s > 0.0 {
            reachable(Twist2::ZERO)
        } else if share < 1.0 {
            reachable(Twist2 {
                linear_mps: share * twist.linear_mps,
                angular_radps: share * twist.angular_radps,
            })
        } else {
            twist
        };
        self.held_s -= planning.period_s;
    }

    /// Distances and contacts at this moment.
    fn judge(&mut self, crowd: &Crowd<'_>) {
        for (number, walker) in &crowd.walkers {
            let gap_m = (self.robot.body.clearance_m(self.pose, walker.place) - BODY_M).max(0.0);
            if walker.is_new() && gap_m < APPEARS_M {
                self.appeared.insert(*number);
            }
            if gap_m > NEAR_M || self.appeared.contains(number) {
                continue;
            }
            let before_m = self.nearest_m.get(number).copied().unwrap_or(f32::INFINITY);
            self.nearest_m.insert(*number, before_m.min(gap_m));
            if gap_m > 0.0 || before_m <= 0.0 {
                continue;
            }
            if self.approaches(walker.place) {
                self.driven.driven_into += 1;
            } else {
                self.driven.walked_into += 1;
            }
        }
    }

    /// The body's own motion brings its outline nearer to a place.
    fn approaches(&self, place: Point2) -> bool {
        const MOMENT_S: f32 = 0.01;
        let gap_m = |pose| self.robot.body.clearance_m(pose, place);
        let (now, before) = (self.pose, self.pose.after(self.twist, -MOMENT_S));
        gap_m(before) - gap_m(now) > DRIVES_MPS * MOMENT_S
    }

    /// Follows everybody who was there to the end, without the robot, and compares with the crowd that met none.
    fn compare(&mut self, mut crowd: Crowd<'_>, alone: &Crowd<'_>) {
        for _ in 0..(AFTER_S / CROWD_STEP_S) as u32 {
            crowd.step(None);
        }
        for number in self.nearest_m.keys() {
            if let (Some(passage), Some(free)) = (crowd.passages.get(number), alone.passages.get(number)) {
                self.driven.detour_m += passage.way_m - free.way_m;
                self.driven.delay_s += passage.time_s - free.time_s;
            }
        }
    }
}
