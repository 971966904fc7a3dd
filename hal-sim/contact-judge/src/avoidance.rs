//! Who could have avoided a contact: full braking is tried from every moment before it.
//!
//! A moment counts when braking from there keeps the robot from the other as long as it moves, and when there was a reason
//! to brake: what stands is always a reason on one's own way; somebody who walks is one when the walk at that moment,
//! continued, meets the robot. What people do later nobody knows beforehand.

use crate::body::RobotBody;
use crate::scene::{Key, Person, Thing};
use crate::sensor::Sensor;
use crate::sight::{Target, Visible, sees};
use crate::solid::Placed;
use crate::track::{Sample, Track};
use crate::{Brakes, RobotPose};

/// So far back a reason is looked for with people, seconds.
const PEOPLE_BACK_S: f64 = 4.0;
/// From moment to moment with people, with objects, and with objects longer ago, seconds.
const STEPS_S: [f64; 3] = [0.04, 0.05, 0.25];
/// Longer ago objects are looked for in larger steps, seconds.
const LONG_AGO_S: f64 = 4.0;
/// Braking that ends this much before the contact has avoided it, metres.
const SHORT_M: f64 = 0.001;
/// Somebody whose walk comes as near as this meets the robot, metres.
const MEETS_M: f32 = 0.05;
/// A walk is continued for the time of braking and so much longer, seconds.
const AHEAD_S: f32 = 0.5;
/// Slower than this the robot stands, m/s.
const STANDS_MPS: f32 = 0.002;
/// What is seen once may be noise: it is seen when it is seen this much before, too, seconds.
const AGAIN_S: f64 = 0.1;
/// An object is seen when it is seen within this of the place that is touched, metres.
const THING_M: f32 = 0.5;
/// A person is seen when any limb is, within this of the middle, metres.
const PERSON_M: f32 = 1.2;
/// What is touched this far from a person's middle belongs to somebody who lies or reaches out, metres: limbs of who stands or walks are
/// nearer.
const STRETCHED_M: f32 = 0.6;
/// Who is slower stays where they are, m/s.
const STAYS_MPS: f32 = 0.1;
/// What was seen farther away than this is forgotten, metres.
const MEMORY_M: f32 = 8.0;

/// A contact, or a contact to be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) key: Key,
    pub(crate) at_s: f64,
    /// Where, world frame, metres.
    pub(crate) point_m: [f32; 3],
}

/// An object and its shape.
pub(crate) struct StandingThing {
    pub(crate) thing: Thing,
    pub(crate) placed: Placed,
}

/// Everything that is known of the past.
pub(crate) struct Past<'a> {
    pub(crate) track: &'a Track,
    pub(crate) things: &'a [StandingThing],
    pub(crate) body: &'a RobotBody,
    pub(crate) brakes: &'a Brakes,
    pub(crate) sensors: &'a [Sensor],
}

impl Past<'_> {
    /// A perfect machine with the same brakes would have stood.
    pub(crate) fn by_perfection(&self, case: &Case) -> bool {
        self.moments(case).any(|at_s| self.has_reason(case, at_s) && self.is_avoided(case, at_s))
    }

    /// The sensor that saw the other early enough to stand, and how long before the contact, seconds.
    pub(crate) fn by_sensors(&self, case: &Case) -> Option<(String, f32)> {
        for seen_s in self.moments(case) {
            if !self.has_reason(case, seen_s) {
                continue;
            }
            for sensor in self.sensors {
                let ordered_s = seen_s + f64::from(sensor.delay_s);
                let in_time = ordered_s < case.at_s && self.is_avoided(case, ordered_s);
                if in_time && self.is_seen(sensor, case, seen_s) {
                    return Some((sensor.name.clone(), (case.at_s - seen_s) as f32));
                }
            }
        }
        None
    }

    /// The sensor that saw the other at any moment up to now.
    pub(crate) fn seen_by(&self, case: &Case) -> Option<String> {
        let seen = |at_s: f64| self.sensors.iter().find(|sensor| self.is_seen(sensor, case, at_s));
        self.moments(case).find_map(seen).map(|sensor| sensor.name.clone())
    }

    /// The moments before a contact, the last one first.
    fn moments(&self, case: &Case) -> impl Iterator<Item = f64> {
        let (first_s, step_s) = match case.key {
            Key::Thing(index) => {
                let from_s = self.things.get(index).map_or(0.0, |thing| thing.thing.from_s);
                (self.track.first_s().max(from_s), STEPS_S[1])
            }
            Key::Person(_) => (self.track.first_s().max(case.at_s - PEOPLE_BACK_S), STEPS_S[0]),
        };
        let near = (LONG_AGO_S / step_s) as u32;
        let contact_s = case.at_s;
        let back_s =
            move |at: u32| f64::from(at.min(near)) * step_s + f64::from(at.saturating_sub(near)) * STEPS_S[2];
        (0..10_000_u32).map(move |at| contact_s - back_s(at)).take_while(move |at_s| *at_s >= first_s)
    }

    fn has_reason(&self, case: &Case, at_s: f64) -> bool {
        let Key::Person(id) = case.key else { return true };
        let (Some(now), Some(person)) = (self.track.at(at_s), self.track.person_at(id, at_s)) else {
            return false;
        };
        let horizon_s = self.brakes.stopping_s(self.brakes.wheel_mps(now.motion)) + AHEAD_S;
        let steps = (horizon_s / 0.05) as u16 + 1;
        (0..=steps).any(|step| {
            let ahead_s = f32::from(step) * 0.05;
            let goes_on = now.pose.after(now.motion, ahead_s);
            let own_way = self.track.at((at_s + f64::from(ahead_s)).min(case.at_s)).map(|then| then.pose);
            let then = person.after(ahead_s);
            self.meets(goes_on, &then, MEETS_M)
                || own_way.is_some_and(|pose| self.meets(pose, &then, MEETS_M))
        })
    }

    /// Full braking from this moment on keeps the moving robot from the other.
    fn is_avoided(&self, case: &Case, at_s: f64) -> bool {
        let (Some(begin), Some(contact)) = (self.track.at(at_s), self.track.at(case.at_s)) else {
            return false;
        };
        let wheel_mps = self.brakes.wheel_mps(begin.motion);
        let Key::Person(id) = case.key else {
            let ends_m = begin.path_m + f64::from(self.brakes.stopping_m(wheel_mps));
            return ends_m < contact.path_m - SHORT_M;
        };
        if wheel_mps < STANDS_MPS {
            // It stands, and need not have started.
            return true;
        }
        let stopping_s = self.brakes.stopping_s(wheel_mps);
        let steps = (stopping_s / 0.04) as u16 + 1;
        (0..=steps).all(|step| {
            let after_s = f32::from(step) * 0.04;
            let then_s = at_s + f64::from(after_s);
            let pose = self.braked(&begin, then_s, after_s);
            // Who is not there any more is not met.
            let person = self.track.person_at(id, then_s);
            pose.is_none_or(|pose| person.is_none_or(|person| !self.meets(pose, &person, 0.0)))
        })
    }

    /// Where the robot is some time after it began to brake, on the way that it really took.
    fn braked(&self, begin: &Sample, then_s: f64, after_s: f32) -> Option<RobotPose> {
        let braked_m =
            begin.path_m + f64::from(self.brakes.path_m(self.brakes.wheel_mps(begin.motion), after_s));
        let last_s = self.track.last().map_or(then_s, |last| last.at_s);
        let really_m =
            self.track.at(then_s).filter(|_| then_s <= last_s).map_or(f64::MAX, |then| then.path_m);
        self.track.at_way(braked_m.min(really_m))
    }

    fn meets(&self, pose: RobotPose, person: &Person, gap_m: f32) -> bool {
        let [x, y] = person.middle_m();
        if libm::hypotf(x - pose.x_m, y - pose.y_m) > self.body.radius_m() + 2.0 {
            return false;
        }
        let robot = pose.placed();
        person.limbs.iter().any(|limb| self.body.distance_m(&robot, &limb.solid.placed()) <= gap_m)
    }

    /// Seen now and a moment before.
    fn is_seen(&self, sensor: &Sensor, case: &Case, at_s: f64) -> bool {
        self.is_in_view(sensor, case, at_s) && self.is_in_view(sensor, case, at_s - AGAIN_S)
    }

    fn is_in_view(&self, sensor: &Sensor, case: &Case, at_s: f64) -> bool {
        let Some(now) = self.track.at(at_s) else { return false };
        let Some(target) = self.target(case, at_s) else { return false };
        let [x, y, _] = target.centre_m;
        if libm::hypotf(x - now.pose.x_m, y - now.pose.y_m) > MEMORY_M {
            return false;
        }
        sees(sensor, now.pose, &target, &self.visible(now.pose, at_s))
    }

    fn target(&self, case: &Case, at_s: f64) -> Option<Target> {
        Some(match case.key {
            Key::Thing(_) => {
                Target { key: case.key, centre_m: case.point_m, radius_m: THING_M, aside_m: THING_M }
            }
            Key::Person(id) => {
                let [x, y] = self.track.person_at(id, at_s)?.middle_m();
                let [dx, dy] = self.stretched(case, id).unwrap_or_default();
                let aside_m = if [dx, dy] == [0.0; 2] { PERSON_M } else { THING_M };
                Target { key: case.key, centre_m: [x + dx, y + dy, 0.8], radius_m: PERSON_M, aside_m }
            }
        })
    }

    /// From the middle of somebody who lies or stands and reaches out to what is touched, metres. Of such a body a part says nothing of where the
    /// rest lies: as with an object it is seen when it is seen near the place that is touched.
    fn stretched(&self, case: &Case, id: u32) -> Option<[f32; 2]> {
        let person = self.track.person_at(id, case.at_s)?;
        let ([x, y], [px, py, _]) = (person.middle_m(), case.point_m);
        let (dx, dy) = (px - x, py - y);
        let [vx, vy] = person.velocity_mps;
        if libm::hypotf(vx, vy) > STAYS_MPS {
            return None;
        }
        (libm::hypotf(dx, dy) > STRETCHED_M).then_some([dx, dy])
    }

    /// What could be seen or hide something at a moment.
    fn visible(&self, pose: RobotPose, at_s: f64) -> Vec<Visible> {
        let things = self.things.iter().enumerate().filter(|(_, standing)| {
            let [low, high] = standing.placed.bounds();
            let (dx, dy) =
                ((low.x - pose.x_m).max(pose.x_m - high.x), (low.y - pose.y_m).max(pose.y_m - high.y));
            standing.thing.from_s <= at_s && dx.max(dy) < MEMORY_M
        });
        let things = things.map(|(index, standing)| Visible {
            key: Key::Thing(index),
            placed: standing.placed.clone(),
            surface: standing.thing.surface,
        });
        let people = self.track.people_at(at_s).iter().flat_map(|person| {
            person.limbs.iter().map(|limb| Visible {
                key: Key::Person(person.id),
                placed: limb.solid.placed(),
                surface: crate::Surface::Opaque,
            })
        });
        things.chain(people).collect()
    }
}
