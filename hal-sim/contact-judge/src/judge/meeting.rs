//! Makes a contact out of two bodies that touch, and decides who could have avoided it.

use super::{ContactJudge, Open, PUSHES_MPS, STANDS_MPS, Step};
use crate::avoidance::{Case, Past};
use crate::body::Nearest;
use crate::contact::{Contact, ContactKind, Other};
use crate::detection::Found;
use crate::force::force;
use crate::scene::{Key, LimbName, ThingKind};

/// From the touch of a bumper to the order to brake, seconds.
const BUMPER_S: f32 = 0.1;
/// A brake is an even ramp on paper only: so much more is granted, metres.
const STANDS_WITHIN_M: f32 = 0.05;

impl ContactJudge {
    pub(super) fn found(&mut self, step: &Step, key: Key, found: Found) {
        match found {
            Found::Apart => {}
            Found::End => {
                self.corridor.observe(step.at_s, key, None);
                let open = self.open.remove(&key);
                if let Some(contact) = open.and_then(|open| self.contacts.get_mut(open.at)) {
                    contact.until_s = step.at_s;
                }
            }
            Found::Touch(is_new, nearest, limb) => {
                let contact = self.contact(step, key, (&nearest, limb));
                match self.open.get(&key).copied().filter(|_| !is_new) {
                    None => {
                        let stands_at_m = self.stands_at_m(step, (key, true));
                        self.open.insert(key, Open { at: self.contacts.len(), stands_at_m });
                        let judged = self.judged(key, contact, &nearest);
                        self.contacts.push(judged);
                    }
                    Some(open) => {
                        // What rises meets the body first, and a bumper later.
                        let stands_at_m = open.stands_at_m.or_else(|| self.stands_at_m(step, (key, false)));
                        let open = Open { stands_at_m, ..open };
                        self.open.insert(key, open);
                        self.goes_on((open, key), contact, &nearest);
                    }
                }
            }
        }
    }

    /// Where the braked wheel has to stand, if a bumper feels this contact now. What slides along the body presses a bumper when it is
    /// there, and not when it is near.
    fn stands_at_m(&self, step: &Step, (key, is_new): (Key, bool)) -> Option<f64> {
        let [grown, bumpers] = self.bumpers.as_ref()?;
        let bumpers = if is_new { grown } else { bumpers };
        let robot = step.pose.placed();
        let is_felt = match key {
            Key::Thing(index) => bumpers.distance_m(&robot, &self.things[index].placed) <= 0.0,
            Key::Person(id) => {
                let limbs = self.people.get(&id).into_iter().flat_map(|person| &person.limbs);
                limbs.map(|limb| limb.solid.placed()).any(|limb| bumpers.distance_m(&robot, &limb) <= 0.0)
            }
        };
        if !is_felt {
            return None;
        }
        let wheel_mps = self.brakes.wheel_mps(step.motion);
        let path_m = self.brakes.stopping_m(wheel_mps) + wheel_mps * BUMPER_S + STANDS_WITHIN_M;
        self.track.at(step.at_s).map(|now| now.path_m + f64::from(path_m))
    }

    /// A contact that has begun before.
    fn goes_on(&mut self, (open, key): (Open, Key), now: Contact, nearest: &Nearest) {
        let path_m = self.track.at(now.at_s).map_or(0.0, |now| now.path_m);
        let Some(known) = self.contacts.get_mut(open.at) else { return };
        known.until_s = now.at_s;
        known.depth_m = known.depth_m.max(now.depth_m);
        known.went_on |= open.stands_at_m.is_some_and(|stands_at_m| path_m > stands_at_m);
        // Somebody leans against the standing robot, and it moves towards them.
        let pushes = now.kind != ContactKind::WalkedIntoStanding && now.robot_closing_mps > PUSHES_MPS;
        if known.kind == ContactKind::WalkedIntoStanding && pushes {
            let judged = self.judged(key, now, nearest);
            self.contacts[open.at] = judged;
        }
    }

    /// Decides who could have avoided it.
    fn judged(&mut self, key: Key, contact: Contact, nearest: &Nearest) -> Contact {
        if contact.kind == ContactKind::WalkedIntoStanding {
            return contact;
        }
        let case = Case { key, at_s: contact.at_s, point_m: nearest.on_robot_m };
        let past = self.past(key);
        let avoidable = past.by_perfection(&case);
        let seen = if avoidable { past.by_sensors(&case) } else { None };
        if avoidable && self.corridor.met(key) {
            self.missed[usize::from(seen.is_none())] += 1;
        }
        let (seen_by, seen_before_s) = seen.map_or((None, None), |(name, s)| (Some(name), Some(s)));
        Contact { avoidable, seen_by, seen_before_s, ..contact }
    }

    pub(super) fn past(&self, key: Key) -> Past<'_> {
        let is_drop = matches!(key, Key::Thing(at) if self.things[at].thing.kind == ThingKind::Drop);
        let body = self.wheels.as_ref().filter(|_| is_drop).unwrap_or(&self.body);
        Past { track: &self.track, things: &self.things, body, brakes: &self.brakes, sensors: &self.sensors }
    }

    fn contact(&self, step: &Step, key: Key, (nearest, limb): (&Nearest, Option<LimbName>)) -> Contact {
        let is_drop = matches!(key, Key::Thing(at) if self.things[at].thing.kind == ThingKind::Drop);
        let body = self.wheels.as_ref().filter(|_| is_drop).unwrap_or(&self.body);
        let place = body.place(step.pose, nearest);
        let [x_mps, y_mps] = step.motion.at([place.point_m[0], place.point_m[1]]);
        let (sin, cos) = libm::sincosf(step.pose.heading_rad);
        let robot = [cos * x_mps - sin * y_mps, sin * x_mps + cos * y_mps];
        let (other, velocity) = self.other(key, limb);
        let relative = [robot[0] - velocity[0], robot[1] - velocity[1]];
        let along = |v: [f32; 2]| v[0] * nearest.direction[0] + v[1] * nearest.direction[1];
        let (robot_mps, robot_closing_mps) = (libm::hypotf(robot[0], robot[1]), along(robot));
        let stands = robot_mps < STANDS_MPS;
        let kind = match key {
            _ if stands => ContactKind::WalkedIntoStanding,
            Key::Thing(_) if is_drop => ContactKind::OverEdge,
            Key::Thing(_) => ContactKind::DroveInto,
            Key::Person(_) if robot_closing_mps > STANDS_MPS => ContactKind::DroveInto,
            Key::Person(_) => ContactKind::WalkedIntoMoving,
        };
        let closing_mps = along(relative).max(0.0);
        Contact {
            at_s: step.at_s,
            until_s: step.at_s,
            other,
            kind,
            place,
            pose: step.pose,
            robot_mps,
            robot_closing_mps,
            relative_mps: libm::hypotf(relative[0], relative[1]),
            closing_mps,
            force: force(limb, closing_mps, self.mass_kg),
            depth_m: (-nearest.gap_m).max(0.0),
            went_on: false,
            avoidable: false,
            seen_by: None,
            seen_before_s: None,
        }
    }

    fn other(&self, key: Key, limb: Option<LimbName>) -> (Other, [f32; 2]) {
        match key {
            Key::Thing(index) => {
                (Other::Thing { index, name: self.things[index].thing.name.clone() }, [0.0; 2])
            }
            Key::Person(id) => {
                let person = self.people.get(&id);
                let limb = limb.unwrap_or(LimbName::Torso);
                let kind = person.map_or("person", |person| person.kind);
                let velocity = person.map_or([0.0; 2], |person| person.velocity_mps);
                (Other::Person { id, kind, limb }, velocity)
            }
        }
    }
}
