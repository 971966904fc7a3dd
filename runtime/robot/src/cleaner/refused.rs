//! A motion that the guard has refused for a while is not planned again from the same place at once.
//!
//! The guard remembers what sank out of sight near the body; the map and the marks of the scans do not show it. A robot that
//! plans by these alone asks for the same motion again, and stands before it for ever.

use floorguard_guard::Cause;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::Gear;

/// Within this distance of the place the motion counts as refused, metres.
const AROUND_M: f32 = 0.45;
/// For this long; what the guard remembers may have been seen to be gone by then, seconds.
const LASTS_S: f32 = 20.0;
/// Factor of the time that it takes: any other way of up to a minute more is better, and the only way is still tried.
const SLOW: f32 = 25.0;

/// The motion that was refused last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RefusedMotion {
    refused: Option<(Gear, Point2, f32)>,
}

impl RefusedMotion {
    /// Held for this cause at a place, on the way in a gear. People walk on; what lies there stays.
    pub fn note(&mut self, cause: Option<Cause>, (gear, place): (Option<Gear>, Point2), now_s: f32) {
        let lies = [Cause::ScanProtective, Cause::LidarProtective, Cause::WayClosed];
        let gear = gear.filter(|_| cause.is_some_and(|cause| lies.contains(&cause)));
        self.refused = gear.map(|gear| (gear, place, now_s + LASTS_S)).or(self.refused);
    }

    /// Factor of the time that a motion to a pose takes.
    #[must_use]
    pub fn slowness(&self, pose: Pose2, gear: Gear, now_s: f32) -> f32 {
        let here = Point2::new(pose.x_m, pose.y_m);
        let is_refused = self.refused.is_some_and(|(refused, place, until_s)| {
            gear == refused && now_s < until_s && place.distance(here) < AROUND_M
        });
        if is_refused { SLOW } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_refused_motion_there_is_slow() {
        let place = Point2::new(2.0, 1.0);
        let mut refused = RefusedMotion::default();
        refused.note(Some(Cause::CollisionStop), (Some(Gear::Ahead), place), 0.0);
        assert_eq!(refused.slowness(Pose2::new(2.0, 1.0, 0.0), Gear::Ahead, 1.0), 1.0, "people walk on");
        refused.note(Some(Cause::WayClosed), (Some(Gear::Back), place), 0.0);
        let slowness = |x_m: f32, gear, now_s| refused.slowness(Pose2::new(x_m, 1.0, 0.0), gear, now_s);
        assert_eq!(slowness(1.85, Gear::Back, 1.0), SLOW);
        assert_eq!(slowness(1.85, Gear::Ahead, 1.0), 1.0, "another motion");
        assert_eq!(slowness(1.0, Gear::Back, 1.0), 1.0, "elsewhere");
        assert_eq!(slowness(1.85, Gear::Back, LASTS_S + 0.1), 1.0, "long ago");
    }
}
