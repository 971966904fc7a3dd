//! People on the floor of a mission: they walk from place to place and step aside for nobody.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;

use floorguard_robot::site::Floor;

/// Radius of a person, metres.
const PERSON_RADIUS_M: f32 = 0.25;
/// Walking speed, m/s.
const WALK_MPS: f32 = 0.9;
/// The robot waits while someone is this near to its rim, or about to be, metres.
const WAIT_WITHIN_M: f32 = 0.6;

struct Person {
    place: Point2,
    goal: Point2,
    pause_s: f32,
}

/// A crowd.
pub struct Crowd {
    people: Vec<Person>,
    places: Vec<Point2>,
    random: Pcg32,
    /// Contacts while the robot moved.
    pub avoidable_contacts: u32,
    /// People who walked into the standing robot.
    pub other_contacts: u32,
}

impl Crowd {
    /// `count` people at random passable places, none near the start.
    pub fn new(floor: &Floor, count: usize, mut random: Pcg32) -> Self {
        let cells: Vec<usize> = (0..floor.cells.cell_count()).filter(|&i| floor.passable[i]).collect();
        let mut draw = || floor.cells.centre(cells[random.below(cells.len() as u32) as usize]);
        let start = Point2::new(floor.start.x_m, floor.start.y_m);
        let people = (0..count)
            .map(|_| {
                let candidates = [draw(), draw(), draw(), draw()];
                let place = candidates.into_iter().find(|p| p.distance(start) > 1.5).unwrap_or(candidates[0]);
                Person { place, goal: place, pause_s: 0.0 }
            })
            .collect();
        let places = cells.iter().map(|&c| floor.cells.centre(c)).collect();
        Self { people, places, random, avoidable_contacts: 0, other_contacts: 0 }
    }

    /// Where everybody stands.
    pub fn places(&self) -> Vec<Point2> {
        self.people.iter().map(|p| p.place).collect()
    }

    /// Everybody walks on. People see the robot and do not walk into it, unless it comes to them.
    pub fn step(&mut self, floor: &Floor, robot: Pose2, period_s: f32) {
        let here = Point2::new(robot.x_m, robot.y_m);
        let reach = floor.robot_radius_m + PERSON_RADIUS_M;
        for person in &mut self.people {
            person.pause_s -= period_s;
            if person.pause_s > 0.0 {
                continue;
            }
            let left = person.place.distance(person.goal);
            if left < 0.05 {
                person.pause_s = self.random.uniform_between(0.0, 15.0);
                person.goal = choose_goal(floor, person.place, &self.places, &mut self.random);
                continue;
            }
            let step = (WALK_MPS * period_s).min(left) / left;
            let next = Point2::new(
                person.place.x_m + step * (person.goal.x_m - person.place.x_m),
                person.place.y_m + step * (person.goal.y_m - person.place.y_m),
            );
            if next.distance(here) < reach + 0.1 && next.distance(here) < person.place.distance(here) {
                // On the path: stands for a moment, then goes elsewhere.
                person.pause_s = 1.0;
                person.goal = choose_goal(floor, person.place, &self.places, &mut self.random);
            } else {
                person.place = next;
            }
        }
    }

    /// The robot must wait: someone is near, or will be within a second.
    pub fn is_robot_to_wait(&self, floor: &Floor, robot: Pose2) -> bool {
        let here = Point2::new(robot.x_m, robot.y_m);
        let limit = floor.robot_radius_m + PERSON_RADIUS_M + WAIT_WITHIN_M;
        self.people.iter().any(|p| p.place.distance(here) < limit)
    }

    /// Counts contacts at this moment.
    pub fn judge(&mut self, floor: &Floor, robot: Pose2, is_moving: bool) {
        let here = Point2::new(robot.x_m, robot.y_m);
        let reach = floor.robot_radius_m + PERSON_RADIUS_M;
        let contacts = self.people.iter().filter(|p| p.place.distance(here) < reach).count() as u32;
        if is_moving {
            self.avoidable_contacts += contacts;
        } else {
            self.other_contacts += contacts;
        }
    }
}

/// A place that can be walked to in a straight line.
fn choose_goal(floor: &Floor, from: Point2, places: &[Point2], random: &mut Pcg32) -> Point2 {
    (0..20)
        .map(|_| places[random.below(places.len() as u32) as usize])
        .find(|&goal| goal.distance(from) > 0.5 && floor.is_clear_by(from, goal, 0.1))
        .unwrap_or(from)
}
