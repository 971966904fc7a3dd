//! What all people together ask of a motion: the nearest in the way, the nearest that is passed, the first that is reached, and a
//! slower motion that reaches nobody too soon (book, Guard: Collision, People near).

use super::advice::AdvisedPerson;
use super::collision::Body;
use super::config::DriveLimits;
use super::person_relation::PersonNearness;
use floorguard_types::geometry::Twist2;

/// Shares of the speed near people at which a robot may creep where it would have to stop otherwise.
const CREEP_SHARES: [f32; 3] = [1.0, 2.0 / 3.0, 1.0 / 3.0];
/// A speed that is not this much lower than what the robot does is no creeping.
const SLOWER_SHARE: f32 = 0.95;

/// A motion that people must be safe from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LikelyMotion {
    /// What the robot does, or what it is about to begin.
    pub twist: Twist2,
    /// The speed that matters of it, of the rear axle or of the steered wheel, m/s.
    pub effective_mps: f32,
    /// The fastest that any of its sources measures now, m/s.
    pub now_mps: f32,
    /// The speed near people, m/s.
    pub near_mps: f32,
}

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
    pub const NOBODY: Self = Self {
        nearest_m: f32::INFINITY,
        passed_m: f32::INFINITY,
        soonest_s: [f32::INFINITY; 2],
        creep_mps: None,
    };

    /// Of all people whose numbers are finite; one that is not leaves no creep. Cost: four times to each person.
    #[must_use]
    pub fn of((body, drive): (&Body, &DriveLimits), people: &[AdvisedPerson], motion: &LikelyMotion) -> Self {
        let mut finding = Self::NOBODY;
        for person in people.iter().filter(|person| person.is_finite()) {
            finding.add(body, person, motion.twist);
        }
        let speeds = CREEP_SHARES.map(|share| share * motion.near_mps);
        finding.creep_mps = speeds.into_iter().find(|speed_mps| {
            people.iter().all(|person| is_clear_of((body, drive), person, (motion, *speed_mps)))
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
    (motion, speed_mps): (&LikelyMotion, f32),
) -> bool {
    let share = speed_mps / motion.effective_mps.max(1.0e-3);
    let over_mps = (motion.now_mps - speed_mps).max(0.0);
    let farther_m = over_mps * (drive.response_s + over_mps / (2.0 * drive.braking_mps2));
    let time_s = body.time_when_slower_s(person, (motion.twist, share), farther_m);
    share < SLOWER_SHARE
        && person.is_finite()
        && time_s >= drive.clear_of_people_s(motion.now_mps.max(speed_mps))
}
