//! One list of people against one motion.

use super::stop_triggers::StopTriggers;
use crate::protection::{AdvisedPerson, Body};
use floorguard_types::geometry::Twist2;

/// Of a list of people: the nearest one, the shortest times to a collision, and which of the people who triggered the stop diverge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    twist: Twist2,
    /// A shorter time to a collision stops the robot, seconds.
    stop_s: f32,
    /// Distance of the nearest person who limits the speed, metres.
    pub nearest_m: f32,
    /// Shortest times to a collision, as estimated and with the doubt of the velocity, seconds.
    pub soonest_s: [f32; 2],
    /// People who triggered the stop and diverge: bits of [`StopTriggers`].
    pub diverging: u8,
}

impl Meeting {
    /// An empty list.
    #[must_use]
    pub const fn new(twist: Twist2, stop_s: f32) -> Self {
        Self { twist, stop_s, nearest_m: f32::INFINITY, soonest_s: [f32::INFINITY; 2], diverging: 0 }
    }

    /// One more person of the list.
    pub fn add(&mut self, person: &AdvisedPerson, body: &Body, triggers: &mut StopTriggers) {
        let twist = self.twist;
        if !body.is_exempt_from_near_limit(person, twist) {
            self.nearest_m = self.nearest_m.min(body.distance_m(person.position));
        }
        // The robot drives away from this person (FG-REQ-034).
        if body.recedes_from(person, twist) {
            self.diverging |= triggers.bit(person.id);
            return;
        }
        let [estimated_s, doubtful_s] = body.times_to_person_s(person, twist);
        // At standstill with a zero command the robot collides only with a person in contact with it.
        let is_standing = twist == Twist2::ZERO && estimated_s > 0.0;
        let estimated_s = if is_standing { f32::INFINITY } else { estimated_s };
        if estimated_s < self.stop_s {
            triggers.add(person.id);
        } else if doubtful_s == f32::INFINITY {
            self.diverging |= triggers.bit(person.id);
        }
        let [soonest_s, least_s] = self.soonest_s;
        self.soonest_s = [soonest_s.min(estimated_s), least_s.min(doubtful_s)];
    }
}
