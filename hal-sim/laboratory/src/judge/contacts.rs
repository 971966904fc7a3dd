//! Contacts with people, and which of them braking could have prevented.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use floorguard_runtime::configuration::{Limits, RobotConfiguration};
use floorguard_types::geometry::Point2;

use super::shape::distance_m;
use super::truth::Truth;
use super::zone::{STANDING_MPS, TrueZones};

/// Scanner response 80 ms and one scan of 40 ms before the braking chain starts.
const SENSING_S: f32 = 0.12;
/// How long the past is kept, seconds: longer than any stop takes.
const MEMORY_S: f32 = 4.0;

struct Moment {
    seconds: f32,
    driven_m: f32,
    speed_mps: f32,
    /// People inside the protective zone of that moment.
    inside: BTreeSet<u32>,
}

/// Counts contacts.
///
/// A contact is *avoidable* when the robot was moving at contact and had driven further since the person came into
/// the protective zone than it needs to stop: sensing time and response at the speed of that moment, then full
/// braking. A person who walks into a standing robot, or who steps in closer than physics allows, is a contact but
/// not an avoidable one.
pub struct ContactJudge {
    footprint: Vec<Point2>,
    zones: TrueZones,
    limits: Limits,
    driven_m: f32,
    touching: BTreeSet<u32>,
    past: VecDeque<Moment>,
    /// Contacts per person.
    counts: BTreeMap<u32, u32>,
    avoidable: u32,
}

impl ContactJudge {
    /// For a robot.
    #[must_use]
    pub fn new(robot: &RobotConfiguration) -> Self {
        Self {
            footprint: robot.geometry.footprint.iter().copied().collect(),
            zones: TrueZones::new(robot),
            limits: robot.limits,
            driven_m: 0.0,
            touching: BTreeSet::new(),
            past: VecDeque::new(),
            counts: BTreeMap::new(),
            avoidable: 0,
        }
    }

    /// Looks at the next moment; `step_s` since the one before.
    pub fn observe(&mut self, truth: &Truth, step_s: f32) {
        let speed_mps = truth.twist.linear_mps;
        self.driven_m += speed_mps.abs() * step_s;
        let to_robot = truth.robot.inverse();
        let zone = self.zones.applying(speed_mps).map(|pair| pair.protective.clone()).unwrap_or_default();
        let mut inside = BTreeSet::new();
        let mut touching = BTreeSet::new();
        for person in &truth.people {
            let in_robot = to_robot.transform(person.position);
            let reaches_in = |(middle, radius_m): &(Point2, f32)| {
                distance_m(&zone, to_robot.transform(*middle)) < *radius_m
            };
            if person.ground.iter().any(reaches_in) {
                inside.insert(person.id);
            }
            if distance_m(&self.footprint, in_robot) < person.radius_m {
                touching.insert(person.id);
            }
        }
        let seconds = truth.stamp.as_micros() as f32 * 1.0e-6;
        self.past.push_back(Moment { seconds, driven_m: self.driven_m, speed_mps: speed_mps.abs(), inside });
        while self.past.front().is_some_and(|moment| moment.seconds < seconds - MEMORY_S) {
            self.past.pop_front();
        }
        for person in touching.difference(&self.touching) {
            *self.counts.entry(*person).or_default() += 1;
            if speed_mps.abs() > STANDING_MPS && self.could_have_stopped(*person) {
                self.avoidable += 1;
            }
        }
        self.touching = touching;
    }

    /// The robot drove further since the person entered than it needs to stop.
    fn could_have_stopped(&self, person: u32) -> bool {
        let entry = self.past.iter().rev().take_while(|moment| moment.inside.contains(&person)).last();
        let Some(entry) = entry else { return false };
        let (v, b) = (entry.speed_mps, self.limits.braking_mps2.max(0.01));
        let needed_m = v * (SENSING_S + self.limits.response_s) + v * v / (2.0 * b);
        self.driven_m - entry.driven_m > needed_m
    }

    /// Contacts of all people.
    #[must_use]
    pub fn contacts(&self) -> u32 {
        self.counts.values().sum()
    }

    /// Those that braking would have prevented.
    #[must_use]
    pub const fn avoidable(&self) -> u32 {
        self.avoidable
    }

    /// Metres driven, forward and backward.
    #[must_use]
    pub const fn driven_m(&self) -> f32 {
        self.driven_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::TruthPerson;
    use floorguard_configuration::{EXAMPLE, parse};
    use floorguard_types::geometry::{Pose2, Twist2};
    use floorguard_types::time::Stamp;

    fn judge() -> ContactJudge {
        ContactJudge::new(&parse("robot.toml", EXAMPLE).unwrap().robot)
    }

    /// A robot that drives on at `speed_mps` and a person who stands at `person_x_m` from `appears_s` on.
    fn drive_on(speed_mps: f32, person_x_m: f32, appears_s: f32) -> ContactJudge {
        let mut judge = judge();
        for step in 0..800_u64 {
            let seconds = step as f32 * 0.01;
            let person = TruthPerson::disc(1, Point2::new(person_x_m, 0.0), 0.2);
            let truth = Truth {
                stamp: Stamp::from_micros(step * 10_000),
                robot: Pose2::new(speed_mps * seconds, 0.0, 0.0),
                twist: Twist2 { linear_mps: speed_mps, angular_radps: 0.0 },
                people: if seconds >= appears_s { vec![person] } else { Vec::new() },
                ..Truth::default()
            };
            judge.observe(&truth, 0.01);
        }
        judge
    }

    #[test]
    fn driving_into_a_visible_person_is_avoidable() {
        let judge = drive_on(0.8, 5.0, 0.0);
        assert_eq!((judge.contacts(), judge.avoidable()), (1, 1));
    }

    #[test]
    fn a_person_who_appears_in_front_of_the_bumper_is_not() {
        // At 4 s the front is at 3.2 + 0.95 m; the person appears 0.15 m further.
        let judge = drive_on(0.8, 4.5, 4.0);
        assert_eq!((judge.contacts(), judge.avoidable()), (1, 0));
    }

    #[test]
    fn a_person_beside_the_way_is_no_contact() {
        let mut judge = judge();
        let truth = Truth {
            stamp: Stamp::ZERO,
            robot: Pose2::default(),
            twist: Twist2::ZERO,
            people: vec![TruthPerson::disc(1, Point2::new(0.0, 0.61), 0.2)],
            ..Truth::default()
        };
        judge.observe(&truth, 0.01);
        assert_eq!(judge.contacts(), 0);
    }
}
