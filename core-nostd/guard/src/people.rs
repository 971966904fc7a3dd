//! People, and what else perception asks for: it can only tighten, and a stop for a person ends when that person is seen to part.

use super::field_selection::STANDING_MPS;
use super::supervisor::Supervisor;
use crate::protection::{Advice, Cause, CauseRecord, Meeting, Unit};
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
            self.state
                .machine
                .raise(CauseRecord::new(Cause::AdviceLimit, now).aged(age_us).limited_to(limit_mps));
        }
        let twist = self.likely_motion();
        let mut meeting = Meeting::EMPTY;
        for person in &advice.people {
            if person.is_finite() {
                meeting.add(person, (&self.body, twist), self.stopper.id());
            } else {
                self.state.machine.raise(CauseRecord::new(Cause::AdviceStop, now).aged(age_us));
            }
        }
        // A robot that stands and is to stand reaches nobody whom it does not touch; the next list judges what it is asked for then.
        if twist == Twist2::ZERO && meeting.soonest_s[0] > 0.0 {
            meeting.soonest_s[0] = f32::INFINITY;
        }
        let speed_mps = twist.linear_mps.abs();
        self.judge_people((meeting.nearest_m, meeting.soonest_s, speed_mps), age_us, now);
        let stops = meeting.soonest_s[0] < self.config.drive.clear_of_people_s(speed_mps);
        let stopper = stops.then_some(meeting.soonest_id);
        if self.stopper.follow((stopper, meeting.stopper_parts), advice.stamp, now) {
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
        let share = self.config.thresholds.person_speed_mps / wanted.linear_mps.abs().max(1.0e-3);
        let share = share.min(1.0);
        Twist2 { linear_mps: wanted.linear_mps * share, angular_radps: wanted.angular_radps * share }
    }
}
