//! Stops without need: nothing was near the way that the robot was about to take.

use crate::body::RobotBody;
use crate::solid::Placed;
use crate::{Brakes, RobotMotion, RobotPose};

/// Besides braking, so much of the way ahead is a reason to stop, seconds: sensing and a margin.
const AHEAD_S: f32 = 1.2;
/// What comes this near to the way is a reason, metres.
const NEAR_M: f32 = 0.30;
/// Who comes this near to the body is one, metres.
pub(crate) const PERSON_M: f32 = 1.5;
/// A reason explains a stop for so long, seconds.
const EXPLAINS_S: f64 = 1.5;
/// A robot that stands or creeps is asked as if it went this fast, m/s.
const SLOW_MPS: f32 = 0.3;

/// Remembers when there was a reason to stop.
#[derive(Debug)]
pub(crate) struct Need {
    last_s: f64,
    pub(crate) stops: u32,
    /// Moments of the stops without need, seconds.
    pub(crate) without_at_s: Vec<f64>,
}

impl Default for Need {
    fn default() -> Self {
        Self { last_s: f64::NEG_INFINITY, stops: 0, without_at_s: Vec::new() }
    }
}

impl Need {
    /// There is a reason now.
    pub(crate) fn is_there(&mut self, at_s: f64) {
        self.last_s = at_s;
    }

    /// The robot has stopped for something in its way.
    pub(crate) fn stop(&mut self, at_s: f64) {
        self.stops += 1;
        if at_s - self.last_s > EXPLAINS_S {
            self.without_at_s.push(at_s);
        }
    }
}

/// The way ahead, wide and long enough for every sensible reason.
pub(crate) struct WayAhead {
    poses: Vec<RobotPose>,
    /// Nothing farther away matters, metres.
    pub(crate) reach_m: f32,
}

impl WayAhead {
    /// From a pose, with both the present curve and straight on.
    pub(crate) fn new(pose: RobotPose, motion: RobotMotion, (brakes, body): (&Brakes, &RobotBody)) -> Self {
        let direction = if motion.forward_mps < -0.01 { -1.0 } else { 1.0 };
        let forward_mps = direction * motion.forward_mps.abs().max(SLOW_MPS);
        let long_s = AHEAD_S + brakes.stopping_m(forward_mps.abs()) / forward_mps.abs();
        let motions =
            [motion, RobotMotion { forward_mps, ..motion }, RobotMotion { forward_mps, turn_radps: 0.0 }];
        let poses = motions
            .iter()
            .flat_map(|motion| (0..=6_u8).map(|step| pose.after(*motion, long_s * f32::from(step) / 6.0)));
        let fastest = |corner| motions.iter().map(|motion| motion.speed_at(corner)).fold(0.0, f32::max);
        let fastest_mps = body.corners_m().map(fastest).into_iter().fold(0.0, f32::max);
        Self { poses: poses.collect(), reach_m: fastest_mps * long_s + NEAR_M }
    }

    /// One of the solids is near to it, seconds ahead included for those that move.
    pub(crate) fn is_near(&self, body: &RobotBody, solids: &[Placed]) -> bool {
        self.poses.iter().any(|pose| {
            let robot = pose.placed();
            solids.iter().any(|solid| body.distance_m(&robot, solid) < NEAR_M)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stop_needs_a_recent_reason() {
        let mut need = Need::default();
        need.stop(1.0);
        need.is_there(5.0);
        need.stop(6.0);
        need.stop(7.0);
        assert_eq!((need.stops, need.without_at_s), (3, vec![1.0, 7.0]));
    }
}
