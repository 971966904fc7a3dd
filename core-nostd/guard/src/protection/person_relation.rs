//! What a person is to a motion: in its way, being passed, or left behind; and when it is reached by a slower one (book, Guard:
//! Collision, People near).
//!
//! Nothing here becomes milder when it is less known where a person is, or how fast (FG-REQ-033).

use super::advice::AdvisedPerson;
use super::collision::{Body, PERSON_RADIUS_M, POSITION_SIGMAS};
use floorguard_types::geometry::Twist2;

/// A gap that grows faster than this, one standard deviation of the velocity taken off, grows, m/s.
const PARTS_MPS: f32 = 0.1;

/// Who is passed may be passed this many times faster than people are approached (book, Guard: People near).
pub const PASSING_TIMES: f32 = 5.0 / 3.0;

/// How a person near the body limits the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PersonNearness {
    /// Not at all: the robot leaves the person behind.
    LeftBehind,
    /// The robot passes somebody beside it, or somebody who goes away: as fast as people may be passed.
    Passed,
    /// As slowly as near people.
    InTheWay,
}

impl Body {
    /// How the person limits the speed of a motion.
    #[must_use]
    pub fn nearness(&self, person: &AdvisedPerson, twist: Twist2) -> PersonNearness {
        let offset = self.offset(person.position);
        let gap_m = offset.norm();
        if gap_m < PERSON_RADIUS_M {
            return PersonNearness::InTheWay;
        }
        let recedes = self.recedes_from(person, twist);
        let is_behind = offset.x_m * twist.linear_mps.signum() < 0.0;
        if recedes && is_behind {
            return PersonNearness::LeftBehind;
        }
        let parts_mps = -self.closing_m2ps(person, twist) / gap_m - person.velocity_sigma_mps.max(0.0);
        if recedes || parts_mps > PARTS_MPS { PersonNearness::Passed } else { PersonNearness::InTheWay }
    }

    /// Seconds until a person is reached when the robot goes on along the same curve at a share of the speed; infinite when never.
    /// `farther_m`: the way that it drives more than that until it is so slow.
    #[must_use]
    pub fn time_when_slower_s(
        &self,
        person: &AdvisedPerson,
        (twist, share): (Twist2, f32),
        farther_m: f32,
    ) -> f32 {
        let slower =
            Twist2 { linear_mps: twist.linear_mps * share, angular_radps: twist.angular_radps * share };
        let position_sigma_m = person.position_sigma_m.max(0.0) + farther_m / POSITION_SIGMAS;
        let nearer = AdvisedPerson { position_sigma_m, ..*person };
        // Who goes away from the slower robot may be overtaken by the one that still brakes.
        if farther_m > 0.0 && self.distance_m(person.position) <= PERSON_RADIUS_M + farther_m {
            return 0.0;
        }
        if self.recedes_from(&nearer, slower) {
            return f32::INFINITY;
        }
        let [estimated_s, _] = self.times_to_person_s(&nearer, slower);
        estimated_s
    }
}
