//! A robot that is held must stand: the drive's torque is all that holds it, and nothing else watches the drive.

use super::cause::Cause;
use super::record::CauseRecord;
use super::sweep::fastest_mps;
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
    pub(crate) moved_m: f32,
    /// To the left, radians.
    pub(crate) turned_rad: f32,
    pub(crate) measured_at: Stamp,
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
