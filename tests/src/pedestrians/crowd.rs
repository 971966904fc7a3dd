//! The people around the robot: as they were recorded, or on their recorded way with social forces.

use std::collections::BTreeMap;

use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::motion::Footprint;

use super::recording::{Recording, Walk};
use super::social_force::{RELAX_S, Repellent, SPEED_MAX, repulsion, robot_repulsion};

/// The crowd moves on by this, seconds.
pub const CROWD_STEP_S: f32 = 0.05;
/// What is known of somebody's velocity is the mean of so many steps: a tracker does not know the next one.
const KNOWN_STEPS: usize = 8;
/// Somebody on the way walks to where the recording is this much later, seconds.
const AHEAD_S: f32 = 1.0;
/// Slower than this the recording stands, m/s; and back to where it stands people go at most so fast, m/s.
const STANDS_MPS: f32 = 0.2;
const BACK_MPS: f32 = 0.5;

/// What people make of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Behaviour {
    /// Nothing: they walk as recorded, through it if need be.
    Recorded,
    /// Each wants to walk as recorded, and social forces act.
    Reacting,
}

/// Somebody in the scene.
#[derive(Clone, Debug)]
pub struct Walker {
    /// Middle of the body.
    pub place: Point2,
    /// m/s, true.
    pub velocity: Point2,
    /// Time on the recorded way, seconds.
    own_s: f32,
    entered_s: f32,
    way_m: f32,
    /// The last places, newest last.
    trail: Vec<Point2>,
}

impl Walker {
    /// The velocity as a tracker knows it, and whether it has seen enough to.
    #[must_use]
    pub fn known_velocity(&self) -> (Point2, bool) {
        let (Some(from), Some(to)) = (self.trail.first(), self.trail.last()) else {
            return (Point2::default(), false);
        };
        let time_s = CROWD_STEP_S * (self.trail.len() - 1).max(1) as f32;
        let velocity = Point2::new((to.x_m - from.x_m) / time_s, (to.y_m - from.y_m) / time_s);
        (velocity, self.trail.len() > KNOWN_STEPS / 2)
    }

    /// In the scene for no longer than a step.
    #[must_use]
    pub const fn is_new(&self) -> bool {
        self.trail.len() < 2
    }

    fn remember(&mut self) {
        self.trail.push(self.place);
        if self.trail.len() > KNOWN_STEPS + 1 {
            self.trail.remove(0);
        }
    }
}

/// Somebody who has left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// How long it took, seconds.
    pub time_s: f32,
    /// How long the way was, metres.
    pub way_m: f32,
}

/// The robot as the crowd feels it.
#[derive(Clone, Copy, Debug)]
pub struct RobotBody<'a> {
    /// Its outline.
    pub outline: &'a Footprint,
    /// Where it is.
    pub pose: Pose2,
    /// How it moves.
    pub twist: Twist2,
}

/// Everybody from one moment of a recording on.
#[derive(Clone, Debug)]
pub struct Crowd<'a> {
    recording: &'a Recording,
    behaviour: Behaviour,
    begins_s: f32,
    steps: u32,
    next: usize,
    /// By number of the walk.
    pub walkers: BTreeMap<usize, Walker>,
    /// Who has left, by number of the walk.
    pub passages: BTreeMap<usize, Passage>,
}

impl<'a> Crowd<'a> {
    /// Who is there at a moment of the recording, seconds.
    #[must_use]
    pub fn new(recording: &'a Recording, behaviour: Behaviour, begins_s: f32) -> Self {
        let (walkers, passages) = (BTreeMap::new(), BTreeMap::new());
        let mut crowd = Self { recording, behaviour, begins_s, steps: 0, next: 0, walkers, passages };
        crowd.enter();
        crowd
    }

    /// Seconds of the recording.
    #[must_use]
    pub fn now_s(&self) -> f32 {
        self.begins_s + CROWD_STEP_S * self.steps as f32
    }

    /// Those who come, at their recorded places.
    fn enter(&mut self) {
        let now_s = self.now_s();
        while let Some(walk) = self.recording.walks.get(self.next).filter(|walk| walk.begins_s <= now_s) {
            let own_s = now_s - walk.begins_s;
            if own_s < walk.lasts_s() {
                let walker = Walker {
                    place: walk.after(own_s),
                    velocity: walk.velocity_after(own_s),
                    own_s,
                    entered_s: now_s,
                    way_m: 0.0,
                    trail: Vec::new(),
                };
                self.walkers.insert(self.next, walker);
            }
            self.next += 1;
        }
    }

    /// One step of everybody.
    pub fn step(&mut self, robot: Option<RobotBody<'_>>) {
        self.steps += 1;
        match self.behaviour {
            Behaviour::Recorded => self.replay(),
            Behaviour::Reacting => self.react(robot),
        }
        let now_s = self.now_s();
        let (walks, passages) = (&self.recording.walks, &mut self.passages);
        self.walkers.retain(|number, walker| {
            let stays = walker.own_s < walks[*number].lasts_s();
            if !stays {
                passages.insert(*number, Passage { time_s: now_s - walker.entered_s, way_m: walker.way_m });
            }
            walker.remember();
            stays
        });
        self.enter();
    }

    fn replay(&mut self) {
        let now_s = self.now_s();
        for (number, walker) in &mut self.walkers {
            let walk = &self.recording.walks[*number];
            let before = walker.place;
            walker.own_s = now_s - walk.begins_s;
            (walker.place, walker.velocity) = (walk.after(walker.own_s), walk.velocity_after(walker.own_s));
            walker.way_m += before.distance(walker.place);
        }
    }

    fn react(&mut self, robot: Option<RobotBody<'_>>) {
        let others: Vec<(usize, Repellent)> = self
            .walkers
            .iter()
            .map(|(number, walker)| (*number, Repellent { place: walker.place, velocity: walker.velocity }))
            .collect();
        for (number, walker) in &mut self.walkers {
            let walk = &self.recording.walks[*number];
            let wanted = wanted_velocity(walk, walker);
            let speed_mps = wanted.norm();
            let direction = unit(wanted);
            let mut push = Point2::new(
                (wanted.x_m - walker.velocity.x_m) / RELAX_S,
                (wanted.y_m - walker.velocity.y_m) / RELAX_S,
            );
            let people = others.iter().filter(|(other, _)| other != number);
            let forces = people.map(|(_, other)| repulsion(walker.place, direction, other));
            for force in forces.chain(robot.map(|robot| felt((walker.place, direction), &robot))) {
                push = Point2::new(push.x_m + force.x_m, push.y_m + force.y_m);
            }
            advance(walker, push, SPEED_MAX * speed_mps.max(BACK_MPS));
            progress(walk, walker);
        }
    }
}

/// The push of the robot on somebody at a place who walks in a direction.
fn felt(person: (Point2, Point2), robot: &RobotBody<'_>) -> Point2 {
    let (sin, cos) = libm::sincosf(robot.pose.heading_rad);
    let velocity = Point2::new(robot.twist.linear_mps * cos, robot.twist.linear_mps * sin);
    robot_repulsion(person, (robot.outline, robot.pose), velocity)
}

fn unit(vector: Point2) -> Point2 {
    let length = vector.norm();
    if length < 1.0e-3 {
        return Point2::default();
    }
    Point2::new(vector.x_m / length, vector.y_m / length)
}

/// The recorded speed, towards where the recording is a second later; back to the place where the recording stands.
fn wanted_velocity(walk: &Walk, walker: &Walker) -> Point2 {
    let ahead = walk.after(walker.own_s + AHEAD_S);
    let to = Point2::new(ahead.x_m - walker.place.x_m, ahead.y_m - walker.place.y_m);
    let speed_mps = walk.velocity_after(walker.own_s).norm();
    if speed_mps < STANDS_MPS {
        let share = (BACK_MPS / to.norm().max(1.0e-3)).min(1.0 / AHEAD_S);
        return Point2::new(share * to.x_m, share * to.y_m);
    }
    let direction = unit(to);
    Point2::new(speed_mps * direction.x_m, speed_mps * direction.y_m)
}

fn advance(walker: &mut Walker, push: Point2, limit_mps: f32) {
    let mut velocity = Point2::new(
        walker.velocity.x_m + CROWD_STEP_S * push.x_m,
        walker.velocity.y_m + CROWD_STEP_S * push.y_m,
    );
    let share = (limit_mps / velocity.norm().max(1.0e-3)).min(1.0);
    velocity = Point2::new(share * velocity.x_m, share * velocity.y_m);
    walker.velocity = velocity;
    walker.place.x_m += CROWD_STEP_S * velocity.x_m;
    walker.place.y_m += CROWD_STEP_S * velocity.y_m;
    walker.way_m += CROWD_STEP_S * velocity.norm();
}

/// Time on the recorded way goes on as far as the person comes forward along it; where the recording stands, by the clock.
fn progress(walk: &Walk, walker: &mut Walker) {
    let recorded = walk.velocity_after(walker.own_s);
    let speed_mps = recorded.norm();
    let share = if speed_mps < STANDS_MPS {
        1.0
    } else {
        let along = walker.velocity.x_m * recorded.x_m + walker.velocity.y_m * recorded.y_m;
        (along / (speed_mps * speed_mps)).clamp(0.0, SPEED_MAX)
    };
    walker.own_s += share * CROWD_STEP_S;
}
