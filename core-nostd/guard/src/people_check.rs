//! People, and what else perception asks for: which of them slow the robot down, and where a creep is enough (book, Guard:
//! Collision, People near).

use super::field_selection::STANDING_MPS;
use super::limiter::effective_speed_mps;
use super::supervisor::Supervisor;
use crate::protection::{Advice, AdvisedPerson, Cause, CauseRecord, PersonNearness, Unit};
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

/// People reached later than this do not matter yet (book, Guard: Collision), seconds.
const COLLISION_HORIZON_S: f32 = 3.0;
/// Who is passed may be passed this many times faster than people are approached.
const PASSING_TIMES: f32 = 5.0 / 3.0;
/// Shares of the speed near people at which a robot may creep where it would have to stop otherwise.
const CREEP_SHARES: [f32; 3] = [1.0, 2.0 / 3.0, 1.0 / 3.0];
/// A speed that is not this much lower than what the robot does is no creeping.
const SLOWER_SHARE: f32 = 0.95;

/// What all people together ask for.
#[derive(Clone, Copy, Debug)]
pub struct PeopleFinding {
    /// From the body to the nearest person in the way, metres.
    pub(super) nearest_m: f32,
    /// To the nearest one who is passed, metres.
    pub(super) passed_m: f32,
    /// Until the first is reached, as estimated and with doubt, seconds.
    pub(super) soonest_s: [f32; 2],
    /// A slower motion at which nobody is reached before the robot can stand, m/s.
    pub(super) creep_mps: Option<f32>,
}

impl PeopleFinding {
    /// Nobody is there.
    pub(super) const NOBODY: Self = Self {
        nearest_m: f32::INFINITY,
        passed_m: f32::INFINITY,
        soonest_s: [f32::INFINITY; 2],
        creep_mps: None,
    };
}

impl Supervisor {
    /// People, and what perception asks for. A non-finite number is a fault of perception, not a licence.
    pub(super) fn judge_advice(&mut self, advice: &Advice, now: Stamp) {
        let age_us = advice.stamp.past_us(now);
        if advice.stop || advice.people.iter().any(|person| !person.is_finite()) {
            self.state.machine.raise(CauseRecord::new(Cause::AdviceStop, now).aged(age_us));
        }
        if let Some(limit_mps) = advice.speed_limit_mps {
            let limit_mps = if limit_mps.is_finite() { limit_mps.max(0.0) } else { 0.0 };
            self.state
                .machine
                .raise(CauseRecord::new(Cause::AdviceLimit, now).aged(age_us).limited_to(limit_mps));
        }
        let twist = self.likely_motion();
        let mut finding = PeopleFinding::NOBODY;
        for person in advice.people.iter().filter(|person| person.is_finite()) {
            self.add_person(&mut finding, person, twist);
        }
        finding.creep_mps = self.creep_mps(advice, twist);
        self.judge_people(&finding, twist.linear_mps.abs(), (age_us, now));
    }

    fn add_person(&self, finding: &mut PeopleFinding, person: &AdvisedPerson, twist: Twist2) {
        let distance_m = self.body.distance_m(person.position);
        match self.body.nearness(person, twist) {
            PersonNearness::InTheWay => finding.nearest_m = finding.nearest_m.min(distance_m),
            PersonNearness::Passed => finding.passed_m = finding.passed_m.min(distance_m),
            PersonNearness::LeftBehind => {}
        }
        // Who is left behind does not hold the robot (FG-REQ-034).
        if self.body.recedes_from(person, twist) {
            return;
        }
        let times_s = self.body.times_to_person_s(person, twist);
        for (soonest_s, time_s) in finding.soonest_s.iter_mut().zip(times_s) {
            *soonest_s = soonest_s.min(time_s);
        }
    }

    /// The greatest speed near people, or a share of it, at which the same curve reaches nobody before the robot can stand.
    fn creep_mps(&self, advice: &Advice, twist: Twist2) -> Option<f32> {
        let drive = self.config.drive;
        let likely_mps = effective_speed_mps(twist, &drive).max(1.0e-3);
        let now_mps = self.state.motion.fastest_mps();
        let speeds = CREEP_SHARES.map(|share| share * self.config.thresholds.person_speed_mps);
        speeds.into_iter().find(|speed_mps| {
            let share = speed_mps / likely_mps;
            let over_mps = (now_mps - speed_mps).max(0.0);
            let braking_m = over_mps * over_mps / (2.0 * drive.braking_mps2);
            let clear_s = drive.clear_of_people_s(*speed_mps);
            share < SLOWER_SHARE
                && advice.people.iter().all(|person| {
                    let time_s = self.body.time_when_slower_s(person, (twist, share), braking_m);
                    person.is_finite() && time_s >= clear_s
                })
        })
    }

    /// Distance and times to the person that matters most (book, Guard: Collision, FG-REQ-031, FG-REQ-032). What only
    /// the doubt about a velocity makes a collision slows down and does not stop: else nobody could stand beside the
    /// robot. Where a slower motion reaches nobody too soon, the robot creeps (FG-REQ-039).
    pub(super) fn judge_people(
        &mut self,
        finding: &PeopleFinding,
        speed_mps: f32,
        (age_us, now): (u64, Stamp),
    ) {
        let (drive, thresholds) = (self.config.drive, self.config.thresholds);
        let near_m = thresholds.person_near_m;
        let limits = [(finding.passed_m, PASSING_TIMES), (finding.nearest_m, 1.0)];
        for (distance_m, times) in limits.into_iter().filter(|(distance_m, _)| *distance_m < near_m) {
            let limit_mps = times * thresholds.person_speed_mps;
            let record = CauseRecord::new(Cause::PersonNear, now).aged(age_us).limited_to(limit_mps);
            self.state.machine.raise(record.measured(distance_m, near_m, Unit::Metres));
        }
        let [soonest_s, doubtful_s] = finding.soonest_s;
        let stop_s = drive.clear_of_people_s(speed_mps);
        if soonest_s < stop_s && finding.creep_mps.is_none() {
            let record = CauseRecord::new(Cause::CollisionStop, now).aged(age_us);
            self.state.machine.raise(record.measured(soonest_s, stop_s, Unit::Seconds));
        } else if doubtful_s < COLLISION_HORIZON_S {
            let horizon_s = (COLLISION_HORIZON_S - stop_s).max(1.0e-3);
            let scaled_mps = |time_s: f32| drive.speed_mps * ((time_s - stop_s) / horizon_s).clamp(0.0, 1.0);
            let limit_mps =
                scaled_mps(doubtful_s).max(thresholds.person_speed_mps).min(scaled_mps(soonest_s));
            let limit_mps = limit_mps.max(finding.creep_mps.unwrap_or(0.0));
            let record = CauseRecord::new(Cause::CollisionSlow, now).aged(age_us).limited_to(limit_mps);
            self.state.machine.raise(record.measured(doubtful_s, COLLISION_HORIZON_S, Unit::Seconds));
        }
    }

    /// The motion that people must be safe from: what the robot does, or while it stands, a slow start of what it wants.
    pub(super) fn likely_motion(&self) -> Twist2 {
        let measured = self.state.motion.wheels;
        if measured.linear_mps.abs() > STANDING_MPS {
            return measured;
        }
        let wanted = self.state.wanted;
        let share = self.config.thresholds.person_speed_mps / wanted.linear_mps.abs().max(1.0e-3);
        let share = share.min(1.0);
        Twist2 { linear_mps: wanted.linear_mps * share, angular_radps: wanted.angular_radps * share }
    }
}
