//! The judge: looks at every moment of a run and says in the end what it comes to.

mod meeting;
mod outlook;

use std::collections::BTreeMap;

use crate::avoidance::StandingThing;
use crate::body::{BodyError, BodyPart, RobotBody};
use crate::contact::Contact;
use crate::corridor::CorridorWatch;
use crate::detection::{Detector, Pair, STEP_M};
use crate::job::{Job, JobWatch};
use crate::need::Need;
use crate::report::{ContactCounts, Report};
use crate::scene::{Key, LimbName, Moment, Person, Thing, ThingKind};
use crate::sensor::Sensor;
use crate::solid::Placed;
use crate::track::{Sample, Track};
use crate::{Brakes, RobotMotion, RobotPose};

/// A contact that begins this near to a bumper presses it, metres.
const BUMPER_M: f32 = 0.03;
/// Slower than this a point of the robot stands, m/s.
const STANDS_MPS: f32 = 0.002;
/// Somebody leans against the standing robot: when it moves towards them faster than this it drives into them, m/s.
const PUSHES_MPS: f32 = 0.005;
/// Corridor, clearance and job are examined this often, seconds.
const LOOK_S: f64 = 0.05;
/// Half the edge of a wheel's place on the floor, metres.
const WHEEL_M: f32 = 0.02;
/// So many poses between two moments at most.
const STEPS_MAX: f32 = 500.0;
/// A way that is free for so far is free, and one this narrow is not, metres.
const FREE_WAY_M: (f32, f32) = (1.5, 0.35);

/// What the judge knows from the start.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The robot's true shape.
    pub body: Vec<BodyPart>,
    /// Where wheels stand on the floor, robot frame, metres.
    pub wheels_m: Vec<[f32; 2]>,
    /// Where the robot feels a touch.
    pub bumpers: Vec<BodyPart>,
    /// The robot's mass, kilograms.
    pub mass_kg: f32,
    /// The robot's brakes.
    pub brakes: Brakes,
    /// The robot's sensors, by their mounting; none are trusted, they only say what could have been seen.
    pub sensors: Vec<Sensor>,
    /// What stands.
    pub things: Vec<Thing>,
    /// What the robot is sent for.
    pub job: Job,
}

/// Judges a run. Cost: a few microseconds a moment as long as nothing is near.
pub struct ContactJudge {
    body: RobotBody,
    wheels: Option<RobotBody>,
    /// The bumpers, a little longer and wider than they are, and as they are.
    bumpers: Option<[RobotBody; 2]>,
    mass_kg: f32,
    brakes: Brakes,
    sensors: Vec<Sensor>,
    things: Vec<StandingThing>,
    detector: Detector,
    track: Track,
    /// Everybody at the last moment.
    people: BTreeMap<u32, Person>,
    contacts: Vec<Contact>,
    /// The contact that goes on, of each pair.
    open: BTreeMap<Key, Open>,
    corridor: CorridorWatch,
    missed: [u32; 2],
    need: Need,
    job: JobWatch,
    clearance_m: f32,
    next_look_s: f64,
    shares_s: [f64; 3],
    travelled_m: f64,
    first_s: Option<f64>,
}

/// A contact that goes on.
#[derive(Clone, Copy, Debug)]
struct Open {
    /// Index in the list of contacts.
    at: usize,
    /// The braked wheel has to stand when it has come so far, metres since the start; none: no bumper is touched.
    stands_at_m: Option<f64>,
}

/// The robot between two moments.
struct Step {
    at_s: f64,
    pose: RobotPose,
    motion: RobotMotion,
}

impl ContactJudge {
    /// Of a run that is about to begin.
    ///
    /// # Errors
    /// The robot's body has no volume or a part that is not convex.
    pub fn new(setup: Setup) -> Result<Self, BodyError> {
        let square = |[x, y]: &[f32; 2]| BodyPart {
            name: "wheel".to_owned(),
            outline_m: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[a, b]: [f32; 2]| [x + a * WHEEL_M, y + b * WHEEL_M])
                .to_vec(),
            height_m: [-0.02, 0.01],
        };
        let wheels: Vec<BodyPart> = setup.wheels_m.iter().map(square).collect();
        let count = setup.things.len();
        let stands = |thing: Thing| StandingThing { placed: thing.solid.placed(), thing };
        Ok(Self {
            body: RobotBody::new(&setup.body)?,
            wheels: if wheels.is_empty() { None } else { Some(RobotBody::new(&wheels)?) },
            bumpers: bumpers(&setup.bumpers)?,
            mass_kg: setup.mass_kg,
            brakes: setup.brakes,
            sensors: setup.sensors,
            things: setup.things.into_iter().map(stands).collect(),
            detector: Detector { things: vec![Pair::default(); count], ..Detector::default() },
            track: Track::default(),
            people: BTreeMap::new(),
            contacts: Vec::new(),
            open: BTreeMap::new(),
            corridor: CorridorWatch::default(),
            missed: [0; 2],
            need: Need::default(),
            job: JobWatch::new(setup.job),
            clearance_m: f32::INFINITY,
            next_look_s: 0.0,
            shares_s: [0.0; 3],
            travelled_m: 0.0,
            first_s: None,
        })
    }

    /// Something has come that was not there at the start. It stands from its own moment on.
    pub fn appear(&mut self, thing: Thing) {
        self.things.push(StandingThing { placed: thing.solid.placed(), thing });
        self.detector.things.push(Pair::default());
        self.detector.things_due_m = 0.0;
    }

    /// Processes the next sample; moments rise. Ten milliseconds apart or less is right for robots and people: in
    /// between the judge goes in steps of 2 mm.
    pub fn observe(&mut self, moment: &Moment<'_>) {
        let before = self.track.last().copied();
        self.first_s.get_or_insert(moment.at_s);
        self.track.push(moment.at_s, moment.pose, (moment.motion, &self.brakes));
        self.track.push_people(moment.at_s, moment.people);
        let from = before.unwrap_or(Sample {
            at_s: moment.at_s,
            pose: moment.pose,
            motion: moment.motion,
            path_m: 0.0,
        });
        self.account(&from, moment);
        let now = moment.people.iter().map(|person| (person.id, person.clone())).collect();
        let before = core::mem::replace(&mut self.people, now);
        self.advance(&from, moment, &before);
        self.detector.people.retain(|id, _| self.people.contains_key(id));
        if moment.at_s >= self.next_look_s {
            self.next_look_s = moment.at_s + LOOK_S - 1.0e-6;
            self.look_ahead(moment);
            self.job.observe(moment.at_s, moment.pose);
        }
    }

    /// The robot has stopped, and says that something was in its way.
    pub fn stop(&mut self, at_s: f64) {
        self.need.stop(at_s);
    }

    fn account(&mut self, from: &Sample, moment: &Moment<'_>) {
        let seconds = moment.at_s - from.at_s;
        let motion = moment.motion;
        self.travelled_m +=
            f64::from(libm::hypotf(moment.pose.x_m - from.pose.x_m, moment.pose.y_m - from.pose.y_m));
        if self.brakes.wheel_mps(motion) < STANDS_MPS {
            return;
        }
        let is = [true, motion.turn_radps.abs() > 0.1, motion.forward_mps < -0.01];
        for (share_s, is) in self.shares_s.iter_mut().zip(is) {
            *share_s += if is { seconds } else { 0.0 };
        }
    }

    /// Goes from one moment to the next in small steps.
    fn advance(&mut self, from: &Sample, moment: &Moment<'_>, people: &BTreeMap<u32, Person>) {
        let travel_m = from.pose.travel_m(moment.pose, self.body.radius_m());
        let walks: Vec<(Person, &Person, f32)> = moment.people.iter().map(|now| walk(people, now)).collect();
        let fastest_m = walks.iter().map(|walk| walk.2).fold(travel_m, f32::max);
        let steps = libm::ceilf(fastest_m / STEP_M).clamp(1.0, STEPS_MAX);
        for (person, _, by_m) in &walks {
            // Before the step is known to be short: the whole way counts at once.
            self.detector.moved(person.id, *by_m);
        }
        for at in 1..=steps as u16 {
            let share = f32::from(at) / steps;
            let mix = |a: f32, b: f32| a + share * (b - a);
            let step = Step {
                at_s: from.at_s + f64::from(share) * (moment.at_s - from.at_s),
                pose: from.pose.between(moment.pose, share),
                motion: RobotMotion {
                    forward_mps: mix(from.motion.forward_mps, moment.motion.forward_mps),
                    turn_radps: mix(from.motion.turn_radps, moment.motion.turn_radps),
                },
            };
            self.detector.travel_m += f64::from(travel_m / steps);
            self.look_at_things(&step);
            for (before, now, _) in &walks {
                self.look_at_person(&step, before, (now, share));
            }
        }
    }

    fn look_at_things(&mut self, step: &Step) {
        if self.detector.travel_m < self.detector.things_due_m {
            return;
        }
        let robot = step.pose.placed();
        for index in 0..self.things.len() {
            let standing = &self.things[index];
            let body = match standing.thing.kind {
                ThingKind::Solid => Some(&self.body),
                ThingKind::Drop => self.wheels.as_ref(),
            };
            let is_there = standing.thing.from_s <= step.at_s && self.detector.is_due(Key::Thing(index));
            let Some(body) = body.filter(|_| is_there) else { continue };
            let parts = [(None, standing.placed.clone())];
            let found = self.detector.observe(Key::Thing(index), (&robot, body), &parts);
            self.found(step, Key::Thing(index), found);
            let gap_m = self.detector.gap_m(Key::Thing(index));
            self.note_clearance(step, gap_m);
        }
        self.detector.settle();
        // What appears later is not known to the pairs yet.
        if self.things.iter().any(|standing| standing.thing.from_s > step.at_s) {
            self.detector.things_due_m = 0.0;
        }
    }

    fn look_at_person(&mut self, step: &Step, before: &Person, (now, share): (&Person, f32)) {
        let key = Key::Person(now.id);
        if !self.detector.is_due(key) {
            return;
        }
        let person = before.between(now, share);
        let parts: Vec<(Option<LimbName>, Placed)> =
            person.limbs.iter().map(|limb| (Some(limb.name), limb.solid.placed())).collect();
        let found = self.detector.observe(key, (&step.pose.placed(), &self.body), &parts);
        self.found(step, key, found);
        self.note_clearance(step, self.detector.gap_m(key));
    }

    fn note_clearance(&mut self, step: &Step, gap_m: f32) {
        if gap_m > 0.0 && self.brakes.wheel_mps(step.motion) > STANDS_MPS {
            self.clearance_m = self.clearance_m.min(gap_m);
        }
    }

    /// What the run comes to. `ready_s` is when the robot could move; `excuse` is what else kept it from its job, as a fault
    /// that was put in.
    #[must_use]
    pub fn report(&self, ready_s: Option<f64>, excuse: Option<&str>) -> Report {
        let counts = ContactCounts::of(&self.contacts);
        let (first_s, last_s) =
            (self.first_s.unwrap_or(0.0), self.track.last().map_or(0.0, |last| last.at_s));
        let share = |part_s: f64, of_s: f64| if of_s > 0.0 { part_s / of_s } else { 0.0 };
        let mut report = Report {
            counts,
            contacts: self.contacts.clone(),
            missed_stops: self.missed[0],
            missed_unseen: self.missed[1],
            stops: self.need.stops,
            nuisance_stops: self.need.without_at_s.len() as u32,
            nuisance_stops_at_s: self.need.without_at_s.clone(),
            clearance_m: self.clearance_m.is_finite().then_some(self.clearance_m),
            depth_m: self.contacts.iter().map(|contact| contact.depth_m).fold(0.0, f32::max),
            duration_s: last_s - first_s,
            ready_s,
            travelled_m: self.travelled_m,
            moving_share: share(self.shares_s[0], last_s - first_s),
            turning_share: share(self.shares_s[1], self.shares_s[0]),
            reversing_share: share(self.shares_s[2], self.shares_s[0]),
            job: self.job.outcome(self.blocked(), excuse),
            ..Report::default()
        };
        report.conclude(excuse);
        report
    }
}

/// What presses a bumper lies at its heights, however near it is above or below.
fn bumpers(parts: &[BodyPart]) -> Result<Option<[RobotBody; 2]>, BodyError> {
    if parts.is_empty() {
        return Ok(None);
    }
    let grown: Vec<BodyPart> = parts.iter().map(|part| part.grown(BUMPER_M)).collect();
    Ok(Some([RobotBody::new(&grown)?, RobotBody::new(parts)?]))
}

/// A person at the last moment and now, and how far its limbs have moved, metres.
fn walk<'p>(people: &BTreeMap<u32, Person>, now: &'p Person) -> (Person, &'p Person, f32) {
    let before = people.get(&now.id).filter(|before| before.limbs.len() == now.limbs.len());
    let before = before.unwrap_or(now).clone();
    let moved = |(a, b): (&crate::Limb, &crate::Limb)| {
        let [a, b] = [a, b].map(|limb| limb.solid.placed().bounds());
        (a[0] - b[0]).length().max((a[1] - b[1]).length())
    };
    let by_m = before.limbs.iter().zip(&now.limbs).map(moved).fold(0.0, f32::max);
    (before, now, by_m)
}
