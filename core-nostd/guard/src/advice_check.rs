//! People, and what else perception asks for. Advice only tightens; a stop for people ends when they are seen to diverge.

use super::field_selection::STANDING_MPS;
use super::supervisor::Supervisor;
use crate::people::Meeting;
use crate::protection::{Advice, Cause, CauseRecord, Unit};
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

/// People reached later than this do not matter yet (book, Guard: Collision), seconds.
const COLLISION_HORIZON_S: f32 = 3.0;

impl Supervisor {
    /// People, and what perception asks for. A non-finite number is a fault of perception, not a licence.
    pub(super) fn judge_advice(&mut self, advice: &Advice, now: Stamp) {
        let age_us = advice.stamp.past_us(now);
        if advice.stop {
            self.state.machine.raise(CauseRecord::new(Cause::AdviceStop, now).aged(age_us));
        }
        if let Some(limit_mps) = advice.speed_limit_mps {
            let limit_mps = if limit_mps.is_finite() { limit_mps.max(0.0) } else { 0.0 };
            let record = CauseRecord::new(Cause::AdviceLimit, now).aged(age_us);
            self.state.machine.raise(record.limited_to(limit_mps));
        }
        if !self.state.machine.holds(Cause::CollisionStop) {
            self.triggers.forget();
        }
        let twist = self.likely_motion();
        let speed_mps = twist.linear_mps.abs();
        let stop_s = self.config.drive.clear_of_people_s(speed_mps);
        let mut meeting = Meeting::new(twist, stop_s);
        for person in &advice.people {
            if person.is_finite() {
                meeting.add(person, &self.body, &mut self.triggers);
            } else {
                self.state.machine.raise(CauseRecord::new(Cause::AdviceStop, now).aged(age_us));
            }
        }
        self.judge_people((meeting.nearest_m, meeting.soonest_s, speed_mps), age_us, now);
        let reaches = meeting.soonest_s[0] < stop_s;
        if self.triggers.follow((reaches, meeting.diverging), advice.stamp, now) {
            self.state.machine.release(Cause::CollisionStop);
        }
    }

    /// Distance and times to the person that matters most (book, Guard: Collision, FG-REQ-031, FG-REQ-032). What only
    /// the doubt about a velocity makes a collision slows down and does not stop: else nobody could stand beside the
    /// robot.
    pub(super) fn judge_people(&mut self, people: (f32, [f32; 2], f32), age_us: u64, now: Stamp) {
        let (nearest_m, [soonest_s, doubtful_s], speed_mps) = people;
        let (drive, thresholds) = (self.config.drive, self.config.thresholds);
        if nearest_m < thresholds.person_near_m {
            let record =
                CauseRecord::new(Cause::PersonNear, now).aged(age_us).limited_to(thresholds.person_speed_mps);
            self.state.machine.raise(record.measured(nearest_m, thresholds.person_near_m, Unit::Metres));
        }
        let stop_s = drive.clear_of_people_s(speed_mps);
        if soonest_s < stop_s {
            let record = CauseRecord::new(Cause::CollisionStop, now).aged(age_us);
            self.state.machine.raise(record.measured(soonest_s, stop_s, Unit::Seconds));
        } else if doubtful_s < COLLISION_HORIZON_S {
            let horizon_s = (COLLISION_HORIZON_S - stop_s).max(1.0e-3);
            let scaled_mps = |time_s: f32| drive.speed_mps * ((time_s - stop_s) / horizon_s).clamp(0.0, 1.0);
            let limit_mps =
                scaled_mps(doubtful_s).max(thresholds.person_speed_mps).min(scaled_mps(soonest_s));
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
        let share = (self.config.thresholds.person_speed_mps / wanted.linear_mps.abs().max(1.0e-3)).min(1.0);
        Twist2 { linear_mps: wanted.linear_mps * share, angular_radps: wanted.angular_radps * share }
    }
}
