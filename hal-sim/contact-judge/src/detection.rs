//! Finds the moments at which bodies meet.
//!
//! Conservative advancement (Mirtich 1996, "Impulse-based dynamic simulation of rigid body systems", PhD thesis,
//! section 2.3.2): a pair with a gap cannot meet before both have moved by that gap, and is not looked at before. Poses
//! between two moments are so near to each other that no point of the robot moves by more than [`STEP_M`]: what is thinner
//! than that and only grazed may be missed, nothing else.

use std::collections::BTreeMap;

use parry3d::math::Pose;

use crate::body::{Nearest, RobotBody};
use crate::scene::{Key, LimbName};
use crate::solid::Placed;

/// No point of the robot moves further between two looks, metres.
pub(crate) const STEP_M: f32 = 0.002;
/// A pair is examined again when it has moved by this share of its gap: clearances are right within it.
const SHARE: f32 = 0.125;
/// A contact ends when the gap is larger than this, metres.
const APART_M: f32 = 0.01;

/// Something that may be met: its limbs or the one solid that it is.
pub(crate) type Parts = [(Option<LimbName>, Placed)];

/// A pair of the robot and something else.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// At the last look, metres.
    pub(crate) gap_m: f32,
    /// Both may move so far before the next look, metres since the start.
    due_m: f64,
    /// How far the other has moved, metres.
    moved_m: f64,
    touching: bool,
}

impl Default for Pair {
    fn default() -> Self {
        Self { gap_m: f32::INFINITY, due_m: 0.0, moved_m: 0.0, touching: false }
    }
}

/// What a look at a pair has found.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Found {
    /// Nothing to tell.
    Apart,
    /// They touch: the first look at this contact, nearest points, and the limb.
    Touch(bool, Nearest, Option<LimbName>),
    /// They do not touch any more.
    End,
}

/// All pairs.
#[derive(Default)]
pub(crate) struct Detector {
    pub(crate) things: Vec<Pair>,
    pub(crate) people: BTreeMap<u32, Pair>,
    /// How far the robot's body has moved at most since the start, metres.
    pub(crate) travel_m: f64,
    /// No object needs a look before, metres.
    pub(crate) things_due_m: f64,
}

impl Detector {
    /// The other of a pair has moved.
    pub(crate) fn moved(&mut self, id: u32, by_m: f32) {
        self.people.entry(id).or_default().moved_m += f64::from(by_m);
    }

    fn pair(&self, key: Key) -> Option<&Pair> {
        match key {
            Key::Thing(index) => self.things.get(index),
            Key::Person(id) => self.people.get(&id),
        }
    }

    /// At the last look, metres.
    pub(crate) fn gap_m(&self, key: Key) -> f32 {
        self.pair(key).map_or(f32::INFINITY, |pair| pair.gap_m)
    }

    /// The least that the gap can be now, metres.
    pub(crate) fn gap_min_m(&self, key: Key) -> f32 {
        self.pair(key).map_or(f32::INFINITY, |pair| {
            let left_m = pair.due_m - self.travel_m - pair.moved_m;
            pair.gap_m - pair.step_m() + left_m as f32
        })
    }

    /// The pair may have met since the last look.
    pub(crate) fn is_due(&self, key: Key) -> bool {
        self.pair(key).is_none_or(|pair| self.travel_m + pair.moved_m >= pair.due_m)
    }

    /// Looks at a pair; worth it when it is due.
    pub(crate) fn observe(&mut self, key: Key, (robot, body): (&Pose, &RobotBody), parts: &Parts) -> Found {
        let travel_m = self.travel_m;
        let pair = match key {
            Key::Thing(index) => self.things.get_mut(index),
            Key::Person(id) => Some(self.people.entry(id).or_default()),
        };
        let Some(pair) = pair.filter(|pair| travel_m + pair.moved_m >= pair.due_m) else {
            return Found::Apart;
        };
        pair.gap_m = parts.iter().map(|(_, placed)| body.distance_m(robot, placed)).fold(f32::MAX, f32::min);
        pair.due_m = travel_m + pair.moved_m + f64::from(pair.step_m());
        if pair.gap_m > 0.0 {
            let ends = pair.touching && pair.gap_m > APART_M;
            pair.touching &= !ends;
            return if ends { Found::End } else { Found::Apart };
        }
        let deepest = parts
            .iter()
            .map(|(limb, placed)| (body.nearest_to(robot, placed), *limb))
            .min_by(|a, b| a.0.gap_m.total_cmp(&b.0.gap_m));
        let Some((nearest, limb)) = deepest else { return Found::Apart };
        let is_new = !pair.touching;
        pair.touching = true;
        Found::Touch(is_new, nearest, limb)
    }

    /// When the next look at an object is due, metres.
    pub(crate) fn settle(&mut self) {
        self.things_due_m = self.things.iter().map(|pair| pair.due_m).fold(f64::MAX, f64::min);
    }
}

impl Pair {
    fn step_m(&self) -> f32 {
        if self.gap_m.is_finite() { (self.gap_m * SHARE).max(STEP_M) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BodyPart, RobotPose, Solid};

    fn robot() -> RobotBody {
        let outline_m = vec![[-0.45, -0.4], [0.95, -0.4], [0.95, 0.4], [-0.45, 0.4]];
        RobotBody::new(&[BodyPart { name: "body".into(), outline_m, height_m: [0.0, 0.8] }]).unwrap()
    }

    /// A plate of 2 mm across the way of the front corner: it is met within 2 mm of the true place, however long the way.
    #[test]
    fn a_thin_plate_is_not_jumped_over() {
        let plate = Solid::Box {
            centre_m: [5.0, 0.395, 0.3],
            half_m: [0.001, 0.005, 0.3],
            yaw_rad: 0.0,
            slope_rad: 0.0,
        };
        let parts = [(None, plate.placed())];
        let mut detector = Detector { things: vec![Pair::default()], ..Detector::default() };
        let body = robot();
        let mut evaluations = 0;
        for step in 0..4_000_u16 {
            let pose = RobotPose { x_m: f32::from(step) * STEP_M, ..RobotPose::default() };
            detector.travel_m = f64::from(step) * f64::from(STEP_M);
            if !detector.is_due(Key::Thing(0)) {
                continue;
            }
            evaluations += 1;
            let found = detector.observe(Key::Thing(0), (&pose.placed(), &body), &parts);
            if let Found::Touch(true, nearest, _) = found {
                assert!((pose.x_m + 0.95 - 4.999).abs() <= STEP_M + 1e-4, "{pose:?}");
                assert!(nearest.gap_m <= 0.0 && nearest.on_robot_m[1] > 0.38, "{nearest:?}");
                assert!(evaluations < 120, "{evaluations}");
                return;
            }
        }
        panic!("the plate was not met");
    }
}
