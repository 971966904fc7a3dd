//! What all people together ask of a motion: the nearest in the way, the nearest that is passed, the first that is reached, and a
//! slower motion that reaches nobody too soon (book, Guard: Collision, People near).

use super::advice::AdvisedPerson;
use super::collision::Body;
use super::config::{DriveLimits, GuardConfig};
use super::kinematics::effective_speed_mps;
use super::person_relation::PersonNearness;
use floorguard_types::geometry::Twist2;

/// Shares of the speed near people at which a robot may creep where it would have to stop otherwise.
const CREEP_SHARES: [f32; 3] = [1.0, 2.0 / 3.0, 1.0 / 3.0];
/// A speed that is not this much lower than what the robot does is no creeping.
const SLOWER_SHARE: f32 = 0.95;

/// What all people together ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeopleFinding {
    /// From the body to the nearest person in the way, metres.
    pub nearest_m: f32,
    /// To the nearest one who is passed, metres.
    pub passed_m: f32,
    /// Until the first is reached, as estimated and with doubt, seconds.
    pub soonest_s: [f32; 2],
    /// A slower motion at which nobody is reached before the robot can stand, m/s.
    pub creep_mps: Option<f32>,
}

impl PeopleFinding {
    /// Nobody is there.
    pub const NO_PEOPLE: Self = Self {
        nearest_m: f32::INFINITY,
        passed_m: f32::INFINITY,
        soonest_s: [f32::INFINITY; 2],
        creep_mps: None,
    };

    /// Of all people whose numbers are finite; one that is not leaves no creep. The motion is the one that people must be safe from, and
    /// the fastest that is measured now, m/s. Cost: four times to each person.
    #[must_use]
    pub fn of(
        (body, config): (&Body, &GuardConfig),
        people: &[AdvisedPerson],
        (twist, now_mps): (Twist2, f32),
    ) -> Self {
        let mut finding = Self::NO_PEOPLE;
        for person in people.iter().filter(|person| person.is_finite()) {
            finding.add(body, person, twist);
        }
        let drive = &config.drive;
        let speeds = CREEP_SHARES.map(|share| share * config.thresholds.person_speed_mps);
        finding.creep_mps = speeds.into_iter().find(|speed_mps| {
            people.iter().all(|person| is_clear_of((body, drive), person, (twist, now_mps, *speed_mps)))
        });
        finding
    }

    fn add(&mut self, body: &Body, person: &AdvisedPerson, twist: Twist2) {
        let distance_m = body.distance_m(person.position);
        match body.nearness(person, twist) {
            PersonNearness::InTheWay => self.nearest_m = self.nearest_m.min(distance_m),
            PersonNearness::Passed => self.passed_m = self.passed_m.min(distance_m),
            PersonNearness::LeftBehind => {}
        }
        // Who is left behind does not hold the robot (FG-REQ-034).
        if body.recedes_from(person, twist) {
            return;
        }
        let times_s = body.times_to_person_s(person, twist);
        for (soonest_s, time_s) in self.soonest_s.iter_mut().zip(times_s) {
            *soonest_s = soonest_s.min(time_s);
        }
    }
}

/// Whether a robot that slows down to this speed stands before it reaches the person, also if it has to stop at once. Until it is so
/// slow it drives farther: what it is too fast during its response, and while it brakes.
fn is_clear_of(
    (body, drive): (&Body, &DriveLimits),
    person: &AdvisedPerson,
    (twist, now_mps, speed_mps): (Twist2, f32, f32),
) -> bool {
    let share = speed_mps / effective_speed_mps(twist, drive).max(1.0e-3);
    let over_mps = (now_mps - speed_mps).max(0.0);
    let farther_m = over_mps * (drive.response_s + over_mps / (2.0 * drive.braking_mps2));
    let time_s = body.time_when_slower_s(person, (twist, share), farther_m);
    share < SLOWER_SHARE && person.is_finite() && time_s >= drive.clear_of_people_s(now_mps.max(speed_mps))
}
