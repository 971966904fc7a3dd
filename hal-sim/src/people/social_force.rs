//! Moves people: the social-force model (Helbing and Molnár 1995, with the view cone of Johansson et al. 2007).
//!
//! Everybody accelerates towards the wanted velocity within 0.5 s and is pushed away from others, from walls and, who
//! sees it, from the robot by forces that fall exponentially with the distance of the bodies. Where the forces balance, the
//! wanted velocity turns aside (`detour`).

use std::collections::BTreeMap;

use floorguard_types::geometry::Point2;

use super::Person;
use super::bump::{RobotShape, Stance, keep_out};
use super::detour::{Aim, Around, Detour};
use crate::scene::Scene;

/// Relaxation time, seconds.
const RELAX_S: f32 = 0.5;
/// Strength, m/s², and reach, metres, of the push from people.
const PEOPLE: (f32, f32) = (2.1, 0.30);
/// The same from walls and furniture.
const WALLS: (f32, f32) = (3.0, 0.20);
/// The same from the robot.
const ROBOT: (f32, f32) = (3.0, 0.40);
/// What happens behind one's back counts this much.
const BEHIND: f32 = 0.35;
/// Nobody accelerates harder, m/s².
const PUSH_MAX: f32 = 6.0;
/// Bodies that touch push each other apart, m/s² per metre of overlap, and at most this hard, m/s² (Helbing et al.
/// 2000: nobody walks through anybody).
const CONTACT: (f32, f32) = (150.0, 15.0);
/// Who squeezes past others is pushed by them only so much.
const SQUEEZES: f32 = 0.4;
/// A goal counts as reached within this distance, metres.
const REACHED_M: f32 = 0.6;

/// Everybody in the scene.
#[derive(Clone, Debug, Default)]
pub struct Crowd {
    /// The people.
    pub people: Vec<Person>,
    /// Those who come later or have gone.
    absent: Vec<Person>,
    /// People take detours and walk round the robot in time.
    attentive: bool,
    /// Of everybody who walks, by number.
    detours: BTreeMap<u32, Detour>,
}

impl Crowd {
    /// The people of a scenario; those that follow a recording appear with its first moment.
    #[must_use]
    pub fn new(people: Vec<Person>) -> Self {
        let (absent, people) = people.into_iter().partition(|person| person.walk.is_some());
        Self { people, absent, attentive: false, detours: BTreeMap::new() }
    }

    /// The same people, who look where they go, or do not.
    #[must_use]
    pub fn with_attention(self, attentive: bool) -> Self {
        Self { attentive, ..self }
    }

    /// Lets people of recordings come, go and walk.
    fn follow_recordings(&mut self, now_us: u64, step_s: f32) {
        let is_there = |person: &Person| person.walk.as_ref().is_none_or(|walk| walk.at(now_us).is_some());
        let came: Vec<Person> = self.absent.extract_if(.., |person| is_there(person)).collect();
        let left: Vec<Person> = self.people.extract_if(.., |person| !is_there(person)).collect();
        self.people.extend(came);
        self.absent.extend(left);
        for person in &mut self.people {
            if let Some((place, velocity)) = person.walk.as_ref().and_then(|walk| walk.at(now_us)) {
                (person.position, person.velocity) = (place, velocity);
                person.swing(step_s);
            }
        }
    }

    /// Where everybody walks to.
    fn aims(&mut self, now_us: u64, step_s: f32, (scene, robot): (&Scene, &RobotShape<'_>)) -> Vec<Aim> {
        if !self.attentive {
            return vec![Aim::Goal; self.people.len()];
        }
        let around = Around { people: &self.people, scene, robot };
        let detours = &mut self.detours;
        let aim = |person: &Person| {
            let walks = person.walk.is_none() && person.starts_us <= now_us && person.speed_mps > 0.0;
            let goal = person.goals.get(person.goal % person.goals.len().max(1)).filter(|_| walks);
            let detour = goal.map(|goal| (detours.entry(person.id).or_default(), *goal));
            detour.map_or(Aim::Goal, |(detour, goal)| detour.aim(person, (goal, step_s), around))
        };
        self.people.iter().map(aim).collect()
    }

    /// One step of at most a few hundredths of a second.
    pub fn step(&mut self, now_us: u64, step_s: f32, scene: &Scene, robot: &RobotShape<'_>) {
        self.follow_recordings(now_us, step_s);
        let (middle, radius_m) = (robot.pose.transform(robot.seen_as.0), robot.seen_as.1);
        let bodies: Vec<(Point2, f32)> =
            self.people.iter().map(|person| (person.position, person.kind.radius_m())).collect();
        let aims = self.aims(now_us, step_s, (scene, robot));
        for ((index, person), aim) in self.people.iter_mut().enumerate().zip(aims) {
            if person.walk.is_some() {
                continue;
            }
            if person.starts_us > now_us || person.speed_mps <= 0.0 || person.goals.is_empty() {
                person.velocity = Point2::default();
                continue;
            }
            let mut push = drive(person, aim);
            let people = (PEOPLE.0 * if aim == Aim::Goal { 1.0 } else { SQUEEZES }, PEOPLE.1);
            for (other, body) in bodies.iter().enumerate() {
                if other != index {
                    add(&mut push, repel(person, body.0, body.1, people));
                }
            }
            if person.sees_robot {
                add(&mut push, repel(person, middle, radius_m, ROBOT));
            }
            if let Some((wall, _)) = scene.nearest_obstacle(person.position) {
                add(&mut push, repel(person, wall, 0.0, WALLS));
            }
            accelerate(person, push, step_s);
            let others = bodies.iter().enumerate().filter(|(other, _)| *other != index);
            let contacts = others.filter_map(|(_, body)| contact(person, body.0, body.1));
            let contact = contacts.fold(Point2::default(), |mut sum, push| {
                add(&mut sum, push);
                sum
            });
            person.velocity.x_m += contact.x_m * step_s;
            person.velocity.y_m += contact.y_m * step_s;
            let before = Stance::of(person);
            person.advance(step_s);
            keep_out(person, before, robot);
        }
    }
}

fn add(sum: &mut Point2, more: Point2) {
    sum.x_m += more.x_m;
    sum.y_m += more.y_m;
}

/// Towards the next goal, or to an intermediate place.
fn drive(person: &mut Person, aim: Aim) -> Point2 {
    let goal = person.goals[person.goal % person.goals.len()];
    let distance = goal.distance(person.position);
    if distance < REACHED_M || aim == Aim::NextGoal {
        person.goal = (person.goal + 1) % person.goals.len();
    }
    let goal = if let Aim::Place(place) = aim { place } else { goal };
    let scale = person.speed_mps / goal.distance(person.position).max(0.01);
    Point2::new(
        ((goal.x_m - person.position.x_m) * scale - person.velocity.x_m) / RELAX_S,
        ((goal.y_m - person.position.y_m) * scale - person.velocity.y_m) / RELAX_S,
    )
}

fn repel(person: &Person, from: Point2, radius_m: f32, law: (f32, f32)) -> Point2 {
    let (dx, dy) = (person.position.x_m - from.x_m, person.position.y_m - from.y_m);
    let distance = libm::hypotf(dx, dy).max(0.01);
    if distance > 4.0 {
        return Point2::default();
    }
    let gap = distance - radius_m - person.kind.radius_m();
    let ahead = -(dx * libm::cosf(person.heading_rad) + dy * libm::sinf(person.heading_rad)) / distance;
    let view = BEHIND + (1.0 - BEHIND) * (1.0 + ahead) / 2.0;
    let force = law.0 * libm::expf((-gap / law.1).min(1.5)) * view;
    // A little to the right as well, so that two who meet head-on do not stand before each other for ever.
    Point2::new(force * (dx - 0.2 * dy) / distance, force * (dy + 0.2 * dx) / distance)
}

/// Push of a body that overlaps with the person's.
fn contact(person: &Person, from: Point2, radius_m: f32) -> Option<Point2> {
    let (dx, dy) = (person.position.x_m - from.x_m, person.position.y_m - from.y_m);
    let distance = libm::hypotf(dx, dy).max(0.01);
    let overlap_m = radius_m + person.kind.radius_m() - distance;
    let force = (CONTACT.0 * overlap_m).min(CONTACT.1) / distance;
    (overlap_m > 0.0).then(|| Point2::new(force * dx, force * dy))
}

fn accelerate(person: &mut Person, push: Point2, step_s: f32) {
    let scale = (PUSH_MAX / push.norm().max(1.0e-3)).min(1.0) * step_s;
    person.velocity.x_m += push.x_m * scale;
    person.velocity.y_m += push.y_m * scale;
    let limit = 1.3 * person.speed_mps;
    let speed = person.velocity.norm();
    if speed > limit {
        person.velocity.x_m *= limit / speed;
        person.velocity.y_m *= limit / speed;
    }
}
