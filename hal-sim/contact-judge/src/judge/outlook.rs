//! Looks ahead: missed stops, reasons to stop, and what blocks the way.

use super::{ContactJudge, FREE_WAY_M};
use crate::avoidance::Case;
use crate::corridor::Corridor;
use crate::need::{PERSON_M, WayAhead};
use crate::scene::{Key, Moment, Person, ThingKind};
use crate::solid::Placed;
use crate::{RobotMotion, RobotPose};

impl ContactJudge {
    /// Missed stops, and reasons to stop.
    pub(super) fn look_ahead(&mut self, moment: &Moment<'_>) {
        let Moment { at_s, pose, motion, people } = *moment;
        let corridor = Corridor { pose, motion, brakes: &self.brakes };
        let (reach_m, is_empty) = (corridor.reach_m(&self.body), corridor.is_empty());
        let path = WayAhead::new(pose, motion, (&self.brakes, &self.body));
        let (mut inside, mut has_reason) = (Vec::new(), false);
        for (index, standing) in self.things.iter().enumerate() {
            let key = Key::Thing(index);
            let gap_m = self.detector.gap_min_m(key);
            let is_there = standing.thing.from_s <= at_s;
            if !is_there || gap_m > reach_m.max(path.reach_m) {
                continue;
            }
            let is_drop = standing.thing.kind == ThingKind::Drop;
            let body = self.wheels.as_ref().filter(|_| is_drop).unwrap_or(&self.body);
            has_reason |= path.is_near(body, core::slice::from_ref(&standing.placed));
            let solids = core::iter::once(&standing.placed);
            if !is_empty && !self.open.contains_key(&key) && gap_m <= reach_m && corridor.meets(body, solids)
            {
                inside.push(key);
            }
        }
        for person in people {
            let key = Key::Person(person.id);
            let [x, y] = person.middle_m();
            let far_m = libm::hypotf(x - pose.x_m, y - pose.y_m) - self.body.radius_m() - 1.3;
            if far_m > path.reach_m.max(reach_m) + 3.0 {
                continue;
            }
            let solids: Vec<Placed> = person.limbs.iter().map(|limb| limb.solid.placed()).collect();
            has_reason |= self.is_reason(pose, (person, &solids), &path);
            if !is_empty && !self.open.contains_key(&key) && corridor.meets(&self.body, solids.iter()) {
                inside.push(key);
            }
        }
        if has_reason {
            self.need.is_there(at_s);
        }
        self.note_corridor(at_s, &inside, self.brakes.wheel_mps(motion));
    }

    /// Somebody is near, or will be near the way within the next seconds.
    fn is_reason(&self, pose: RobotPose, (person, solids): (&Person, &[Placed]), path: &WayAhead) -> bool {
        let robot = pose.placed();
        let is_near = solids.iter().any(|solid| self.body.distance_m(&robot, solid) < PERSON_M);
        let later = |ahead_s: f32| -> Vec<Placed> {
            person.after(ahead_s).limbs.iter().map(|limb| limb.solid.placed()).collect()
        };
        is_near || [0.0, 0.5, 1.0, 1.5, 2.0, 2.5].iter().any(|s| path.is_near(&self.body, &later(*s)))
    }

    fn note_corridor(&mut self, at_s: f64, inside: &[Key], wheel_mps: f32) {
        let gone: Vec<Key> = self.corridor.known().filter(|key| !inside.contains(key)).collect();
        for key in gone {
            self.corridor.observe(at_s, key, None);
        }
        for key in inside {
            let Some(since_s) = self.corridor.observe(at_s, *key, Some((wheel_mps, &self.brakes))) else {
                continue;
            };
            let point_m = self.point_of(*key);
            let case = Case { key: *key, at_s: since_s, point_m };
            let is_seen = self.past(*key).seen_by(&case).is_some();
            self.missed[usize::from(!is_seen)] += 1;
        }
    }

    /// The point of something that is nearest to the robot, world frame, metres.
    fn point_of(&self, key: Key) -> [f32; 3] {
        let robot = self.track.last().map(|last| last.pose).unwrap_or_default().placed();
        let solids: Vec<Placed> = match key {
            Key::Thing(index) => vec![self.things[index].placed.clone()],
            Key::Person(id) => {
                let limbs = self.people.get(&id).map(|person| person.limbs.as_slice()).unwrap_or_default();
                limbs.iter().map(|limb| limb.solid.placed()).collect()
            }
        };
        let nearest = solids.iter().map(|solid| self.body.nearest_to(&robot, solid));
        nearest.min_by(|a, b| a.gap_m.total_cmp(&b.gap_m)).map_or([0.0; 3], |near| {
            core::array::from_fn(|axis| near.on_robot_m[axis] + near.direction[axis] * near.gap_m.max(0.0))
        })
    }

    /// What stands within the next metres of the way to one of the places ahead, if anything does.
    pub(super) fn blocked(&self) -> Option<String> {
        let pose = self.track.last()?.pose;
        let way_to = |[x, y]: [f32; 2]| (libm::atan2f(y - pose.y_m, x - pose.x_m), FREE_WAY_M.0);
        let next = self.job.next_place().map_or((pose.heading_rad, FREE_WAY_M.0), way_to);
        // To a place that counts already it goes no farther than that.
        let last = self.job.place_nearby(pose).map(|[x, y]| {
            let (heading_rad, _) = way_to([x, y]);
            (heading_rad, libm::hypotf(x - pose.x_m, y - pose.y_m))
        });
        core::iter::once(next).chain(last).find_map(|way| self.blocked_along(way, pose))
    }

    /// What stands near the body on so many metres in a direction.
    fn blocked_along(&self, (heading_rad, length_m): (f32, f32), pose: RobotPose) -> Option<String> {
        let towards = RobotPose { heading_rad, ..pose };
        let forward = RobotMotion { forward_mps: 1.0, turn_radps: 0.0 };
        let paths = (0..=6_u8).map(|step| towards.after(forward, length_m * f32::from(step) / 6.0));
        let paths: Vec<RobotPose> = paths.chain([pose]).collect();
        let is_near = |solid: &Placed| {
            paths.iter().any(|pose| self.body.distance_m(&pose.placed(), solid) < FREE_WAY_M.1)
        };
        let thing = self.things.iter().find(|standing| is_near(&standing.placed));
        let person = || {
            let stands = |person: &&Person| person.limbs.iter().any(|limb| is_near(&limb.solid.placed()));
            self.people.values().find(stands).map(|person| format!("{} {}", person.kind, person.id))
        };
        thing.map(|standing| standing.thing.name.clone()).or_else(person)
    }
}
