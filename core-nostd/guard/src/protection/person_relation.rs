//! What a person is to a motion: in its way, being passed, or left behind; and whether a stop would keep the two apart (book,
//! Guard: Collision, People near).
//!
//! Nothing here becomes milder when it is less known where a person is, or how fast (FG-REQ-033).

use super::advice::AdvisedPerson;
use super::collision::{Body, PERSON_RADIUS_M, POSITION_SIGMAS, STRAIGHT_RADPS};
use floorguard_types::geometry::Twist2;

/// Somebody who walks into the flank may be reached sooner by this, seconds: of the margin of half a second the rest covers the
/// age of a sweep; the robot still stands by then.
pub const LATER_AT_FLANK_S: f32 = 0.35;
/// A gap that grows faster than this, one standard deviation of the velocity taken off, grows, m/s.
const PARTS_MPS: f32 = 0.1;

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
    /// A stop would help nobody: the person comes from behind a robot that leaves by its own motion, and would walk into it where
    /// it stands all the same. A robot that goes on is met later, and more softly.
    ///
    /// ```
    /// use floorguard_guard::{AdvisedPerson, Body};
    /// use floorguard_types::geometry::{Point2, Twist2};
    ///
    /// let body = Body { x_m: [-0.5, 1.0], y_m: [-0.4, 0.4] };
    /// let walker = AdvisedPerson {
    ///     position: Point2::new(-1.3, 0.1),
    ///     velocity_mps: Point2::new(1.2, 0.0),
    ///     ..AdvisedPerson::default()
    /// };
    /// assert!(body.is_met_from_behind(&walker, Twist2 { linear_mps: 0.3, angular_radps: 0.0 }));
    /// assert!(!body.is_met_from_behind(&walker, Twist2 { linear_mps: -0.3, angular_radps: 0.0 }));
    /// ```
    #[must_use]
    pub fn is_met_from_behind(&self, person: &AdvisedPerson, twist: Twist2) -> bool {
        self.leaves_by_itself(person, twist) && self.would_meet_standing(person, twist)
    }

    /// The person walks into the flank of a robot that drives straight, and would if it stood: the robot's own motion brings no
    /// point of it nearer. All of the disc with its doubt is behind the leading edge.
    #[must_use]
    pub fn is_met_at_flank(&self, person: &AdvisedPerson, twist: Twist2) -> bool {
        let disc_m = PERSON_RADIUS_M + POSITION_SIGMAS * person.position_sigma_m.max(0.0);
        let offset = self.offset(person.position);
        twist.angular_radps.abs() <= STRAIGHT_RADPS
            && offset.x_m == 0.0
            && offset.norm() >= PERSON_RADIUS_M
            && self.leading_m(twist) - person.position.x_m * twist.linear_mps.signum() > disc_m
            && self.would_meet_standing(person, twist)
    }

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
        if (recedes && is_behind) || self.is_met_from_behind(person, twist) {
            return PersonNearness::LeftBehind;
        }
        let parts_mps = -self.closing_m2ps(person, twist) / gap_m - person.velocity_sigma_mps.max(0.0);
        if recedes || parts_mps > PARTS_MPS { PersonNearness::Passed } else { PersonNearness::InTheWay }
    }

    /// Seconds until a person is reached when the robot goes on along the same curve at a share of the speed; infinite when never.
    /// `braking_m`: the way that it drives more than that while it brakes.
    #[must_use]
    pub fn time_when_slower_s(
        &self,
        person: &AdvisedPerson,
        (twist, share): (Twist2, f32),
        braking_m: f32,
    ) -> f32 {
        let slower =
            Twist2 { linear_mps: twist.linear_mps * share, angular_radps: twist.angular_radps * share };
        let position_sigma_m = person.position_sigma_m.max(0.0) + braking_m / POSITION_SIGMAS;
        let nearer = AdvisedPerson { position_sigma_m, ..*person };
        if self.recedes_from(&nearer, slower) {
            return f32::INFINITY;
        }
        let [estimated_s, _] = self.times_to_person_s(&nearer, slower);
        estimated_s
    }

    /// The person as estimated walks into the body where it stands now, behind its leading edge.
    fn would_meet_standing(&self, person: &AdvisedPerson, twist: Twist2) -> bool {
        let time_s = self.straight_time_s(person.position, person.velocity_mps, PERSON_RADIUS_M);
        let there_m = (person.position.x_m + person.velocity_mps.x_m * time_s) * twist.linear_mps.signum();
        time_s.is_finite() && there_m + PERSON_RADIUS_M < self.leading_m(twist)
    }

    /// From the axle to the edge that leads in a motion, metres.
    fn leading_m(&self, twist: Twist2) -> f32 {
        if twist.linear_mps < 0.0 { -self.x_m[0] } else { self.x_m[1] }
    }
}
