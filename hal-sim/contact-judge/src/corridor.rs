//! Missed stops: the way that braking needs reaches into something, and the robot does not brake.
//!
//! The corridor is what the true body sweeps from here to standing, on the present curve, with the brakes that are
//! specified. It knows no fields. A stop is missed when something stays in the corridor for longer than sensing, response
//! and braking take.

use std::collections::{BTreeMap, BTreeSet};

use crate::body::RobotBody;
use crate::scene::Key;
use crate::solid::Placed;
use crate::{Brakes, RobotMotion, RobotPose};

/// From an object's being there to the order to brake, seconds.
const SENSING_S: f32 = 0.22;
/// What the drive needs besides, seconds: an even brake is an idea.
const GRACE_S: f64 = 0.1;
/// Nearer than this the corridor touches, metres.
const TOUCH_M: f32 = 0.002;
/// Slower than this the robot stands, m/s.
const STANDS_MPS: f32 = 0.002;

/// The way to standing.
pub(crate) struct Corridor<'a> {
    pub(crate) pose: RobotPose,
    pub(crate) motion: RobotMotion,
    pub(crate) brakes: &'a Brakes,
}

impl Corridor<'_> {
    /// The robot does not move.
    pub(crate) fn is_empty(&self) -> bool {
        self.brakes.wheel_mps(self.motion) < STANDS_MPS
    }

    /// Seconds at the present speed that the corridor is long.
    fn length_s(&self) -> f32 {
        let wheel_mps = self.brakes.wheel_mps(self.motion);
        self.brakes.stopping_m(wheel_mps) / wheel_mps.max(STANDS_MPS)
    }

    /// Speed of the fastest point of the body, m/s.
    fn fastest_mps(&self, body: &RobotBody) -> f32 {
        let speeds = body.corners_m().map(|corner| self.motion.speed_at(corner));
        speeds.into_iter().fold(STANDS_MPS, f32::max)
    }

    /// Nothing farther away is reached, metres.
    pub(crate) fn reach_m(&self, body: &RobotBody) -> f32 {
        self.fastest_mps(body) * self.length_s()
    }

    /// The body would meet one of the solids.
    pub(crate) fn meets<'p>(
        &self,
        body: &RobotBody,
        solids: impl Iterator<Item = &'p Placed> + Clone,
    ) -> bool {
        let (end_s, fastest_mps) = (self.length_s(), self.fastest_mps(body));
        let mut ahead_s = 0.0;
        for _ in 0..400 {
            let robot = self.pose.after(self.motion, ahead_s).placed();
            let gap_m = solids.clone().map(|solid| body.distance_m(&robot, solid)).fold(f32::MAX, f32::min);
            if gap_m <= TOUCH_M {
                return true;
            }
            ahead_s += gap_m.max(0.005) / fastest_mps;
            if ahead_s > end_s {
                return false;
            }
        }
        false
    }
}

/// Somebody or something is in the corridor since then.
#[derive(Clone, Copy, Debug)]
struct Since {
    at_s: f64,
    allowed_s: f64,
}

/// Watches the corridor.
#[derive(Default)]
pub(crate) struct CorridorWatch {
    since: BTreeMap<Key, Since>,
    missed: BTreeSet<Key>,
}

impl CorridorWatch {
    /// Tells what is in the corridor now; gives the moment at which it came in when the stop for it is missed now.
    pub(crate) fn observe(&mut self, at_s: f64, key: Key, wheel_mps: Option<(f32, &Brakes)>) -> Option<f64> {
        let Some((wheel_mps, brakes)) = wheel_mps else {
            self.since.remove(&key);
            self.missed.remove(&key);
            return None;
        };
        let allowed_s = f64::from(SENSING_S + brakes.stopping_s(wheel_mps)) + GRACE_S;
        let since = *self.since.entry(key).or_insert(Since { at_s, allowed_s });
        let is_late = at_s - since.at_s > since.allowed_s;
        (is_late && self.missed.insert(key)).then_some(since.at_s)
    }

    /// The robot has met something that it could have avoided: the stop is missed, too, unless it is counted already.
    pub(crate) fn met(&mut self, key: Key) -> bool {
        self.missed.insert(key)
    }

    /// What has been in the corridor.
    pub(crate) fn known(&self) -> impl Iterator<Item = Key> + '_ {
        self.since.keys().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BodyPart, Solid};

    const BRAKES: Brakes = Brakes { response_s: 0.15, deceleration_mps2: 0.8, wheel_m: [0.8, 0.0] };

    fn robot() -> RobotBody {
        let outline_m = vec![[-0.45, -0.4], [0.95, -0.4], [0.95, 0.4], [-0.45, 0.4]];
        RobotBody::new(&[BodyPart { name: "body".into(), outline_m, height_m: [0.0, 0.8] }]).unwrap()
    }

    fn post(x_m: f32, y_m: f32) -> Placed {
        Solid::Cylinder { foot_m: [x_m, y_m, 0.0], radius_m: 0.05, height_m: 0.5 }.placed()
    }

    fn corridor(forward_mps: f32, turn_radps: f32) -> Corridor<'static> {
        Corridor {
            pose: RobotPose::default(),
            motion: RobotMotion { forward_mps, turn_radps },
            brakes: &BRAKES,
        }
    }

    #[test]
    fn the_corridor_is_as_long_as_braking() {
        // 1 m/s: 0.775 m before the front at 0.95 m.
        let meets = |x_m: f32, y_m: f32| corridor(1.0, 0.0).meets(&robot(), [&post(x_m, y_m)].into_iter());
        assert!(meets(1.70, 0.0) && !meets(1.80, 0.0));
        assert!(meets(1.5, 0.44) && !meets(1.5, 0.46));
        assert!((corridor(1.0, 0.0).reach_m(&robot()) - 0.775).abs() < 1e-3);
    }

    #[test]
    fn it_goes_backwards_and_round() {
        let reverse = |x_m: f32| corridor(-0.25, 0.0).meets(&robot(), [&post(x_m, 0.0)].into_iter());
        // 0.0375 m + 0.039 m behind the rear at -0.45 m.
        assert!(reverse(-0.57) && !reverse(-0.60));
        // A spin to the left takes the rear right corner to the right of the robot: it is at (-0.45, -0.4) and goes to
        // more negative y.
        let spin = |x_m: f32, y_m: f32| corridor(0.0, 0.5).meets(&robot(), [&post(x_m, y_m)].into_iter());
        assert!(spin(-0.3, -0.47) && !spin(-0.3, 0.47) && !spin(-0.3, -0.60));
    }

    #[test]
    fn stop_is_missed_after_its_time() {
        let mut watch = CorridorWatch::default();
        // 0.22 + 0.15 + 1.25 + 0.1 s.
        let mut tell = |at_s: f64| watch.observe(at_s, Key::Thing(3), Some((1.0, &BRAKES)));
        assert_eq!((tell(2.0), tell(3.7)), (None, None));
        assert_eq!(tell(3.73), Some(2.0));
        assert_eq!(tell(3.8), None, "counted once");
        assert_eq!(watch.observe(4.0, Key::Thing(3), None), None);
        assert_eq!(watch.known().count(), 0);
    }
}
