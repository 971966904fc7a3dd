//! What a list of people comes to for a motion.

use super::advice::AdvisedPerson;
use super::collision::Body;
use floorguard_types::geometry::Twist2;

/// Who is near, who is reached first, and whether the one who stopped the robot parts from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Distance of the nearest one that does not leave, metres.
    pub nearest_m: f32,
    /// Times to the one that is reached first, as estimated and with the doubt of the velocity, seconds.
    pub soonest_s: [f32; 2],
    /// Who that is, as estimated.
    pub soonest_id: u32,
    /// The person who stopped the robot is in the list, and parts from it.
    pub stopper_parts: bool,
}

impl Meeting {
    /// Nobody is in the list.
    pub const EMPTY: Self =
        Self { nearest_m: f32::INFINITY, soonest_s: [f32::INFINITY; 2], soonest_id: 0, stopper_parts: false };

    /// One more person; `stopper`: who stopped the robot last.
    pub fn add(&mut self, person: &AdvisedPerson, (body, twist): (&Body, Twist2), stopper: Option<u32>) {
        let is_stopper = stopper == Some(person.id);
        if !body.leaves_surely(person, twist) {
            self.nearest_m = self.nearest_m.min(body.distance_m(person.position));
        }
        // Who is left behind does not hold the robot (FG-REQ-034).
        if body.recedes_from(person, twist) {
            self.stopper_parts |= is_stopper;
            return;
        }
        let [estimated_s, doubtful_s] = body.times_to_person_s(person, twist);
        self.stopper_parts |= is_stopper && doubtful_s == f32::INFINITY;
        let [soonest_s, least_s] = &mut self.soonest_s;
        if estimated_s < *soonest_s {
            (*soonest_s, self.soonest_id) = (estimated_s, person.id);
        }
        *least_s = least_s.min(doubtful_s);
    }
}
