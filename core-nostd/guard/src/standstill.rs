//! A robot that is held must stand: the drive's torque is all that holds it, and nothing else watches the drive.

use super::supervisor::Supervisor;
use crate::protection::{Cause, CauseRecord, Source, fastest_mps};
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::time::Stamp;

/// So far from where it stood no point of the body may go, metres.
pub const CREEP_M: f32 = 0.02;
/// A speed counts over at most this long between two measurements, seconds.
const STEP_MAX_S: f32 = 0.1;

/// How far a robot that is held has moved, by one source. With its sign, so that noise around zero adds up to nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Creep {
    /// Ahead, metres.
    pub(super) moved_m: f32,
    /// To the left, radians.
    pub(super) turned_rad: f32,
    pub(super) measured_at: Stamp,
}

impl Creep {
    /// It has not moved.
    pub const NONE: Self = Self { moved_m: 0.0, turned_rad: 0.0, measured_at: Stamp::ZERO };

    /// The source has measured again. `must_stand`: the robot is held, and the time that braking takes is over. The
    /// cause, when a point of the body has left its place (FG-REQ-057).
    pub fn measure(
        &mut self,
        measured: Twist2,
        (outline, must_stand): (&[Point2], bool),
        now: Stamp,
    ) -> Option<CauseRecord> {
        let step_s = now.seconds_since(self.measured_at).clamp(0.0, STEP_MAX_S);
        self.measured_at = now;
        if !must_stand {
            (self.moved_m, self.turned_rad) = (0.0, 0.0);
            return None;
        }
        self.moved_m += measured.linear_mps * step_s;
        self.turned_rad += measured.angular_radps * step_s;
        // As far as a point goes in a second with this twist.
        let crept_m =
            fastest_mps(outline, Twist2 { linear_mps: self.moved_m, angular_radps: self.turned_rad });
        let record = CauseRecord::new(Cause::StandstillLost, now).metres(crept_m, CREEP_M);
        (crept_m > CREEP_M).then_some(record)
    }
}

impl Supervisor {
    /// Encoders or drive measured. Once the robot has had the time to brake, a hold means that it stands (FG-REQ-057).
    pub(super) fn judge_standstill(&mut self, source: Source, measured: Twist2, now: Stamp) {
        let checks = &mut self.state.checks;
        let must_stand = self.state.started && checks.is_held && checks.envelope_mps <= 0.0;
        let by_drive = source == Source::Drive;
        let creep = if by_drive { &mut checks.creep_by_drive } else { &mut checks.creep_by_wheels };
        if let Some(record) = creep.measure(measured, (&self.config.footprint, must_stand), now) {
            self.state.machine.raise(record);
        }
    }
}
