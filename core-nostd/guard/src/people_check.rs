//! People, and what else perception asks for: which of them slow the robot down, and where a creep is enough (book, Guard:
//! Collision, People near).

use super::field_selection::STANDING_MPS;
use super::supervisor::Supervisor;
use crate::protection::{Advice, Cause, CauseRecord, PASSING_TIMES, PeopleFinding, Unit};
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

/// People reached later than this do not matter yet (book, Guard: Collision), seconds.
const COLLISION_HORIZON_S: f32 = 3.0;

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
        let motion = (twist, self.state.motion.fastest_mps());
        let finding = PeopleFinding::of((&self.body, &self.config), &advice.people, motion);
        self.judge_people(&finding, twist.linear_mps.abs(), (age_us, now));
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
