//! What is there besides the robot: objects that stand, and people.

use serde::Serialize;

use crate::{RobotMotion, RobotPose, Solid};

/// How a surface answers light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Surface {
    /// Every beam that meets it comes back.
    #[default]
    Opaque,
    /// Lets beams through except near the right angle.
    Glass,
    /// Throws every beam elsewhere: it is never seen itself.
    Mirror,
}

/// What an object is to the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ThingKind {
    /// No part of the robot may touch it.
    #[default]
    Solid,
    /// A hole in the floor: no wheel may come over it. Its solid is the space that is missing, from z = 0 down.
    Drop,
}

/// An object that stands where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Thing {
    /// For reports.
    pub name: String,
    /// What it is to the robot.
    pub kind: ThingKind,
    /// Its shape.
    pub solid: Solid,
    /// Its surface.
    pub surface: Surface,
    /// It is there from this moment on, seconds.
    pub from_s: f64,
}

/// Parts of people, as far as harm differs (ISO/TS 15066:2016, annex A).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LimbName {
    /// Below the knee, the foot with it.
    LowerLeg,
    /// Above the knee.
    Thigh,
    /// Belly, chest, back.
    Torso,
    /// Arm and hand.
    Arm,
    /// Head and neck.
    Head,
    /// What the person sits in, pushes or pulls.
    Carried,
}

/// A part of a person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// Which.
    pub name: LimbName,
    /// Where.
    pub solid: Solid,
}

/// A person at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Person {
    /// Number in the world.
    pub id: u32,
    /// Who it is, for reports: adult, child, wheelchair, lying.
    pub kind: &'static str,
    /// World frame, m/s.
    pub velocity_mps: [f32; 2],
    /// The body; the same limbs in the same order at every moment.
    pub limbs: Vec<Limb>,
}

/// The true state at a moment.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Seconds since the start of the world.
    pub at_s: f64,
    /// The robot, world frame.
    pub pose: RobotPose,
    /// How it moves.
    pub motion: RobotMotion,
    /// Everybody.
    pub people: &'a [Person],
}

/// With whom or what the judge deals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Key {
    /// Index of the object.
    Thing(usize),
    /// Number of the person.
    Person(u32),
}

impl Person {
    /// The person some seconds later, if it goes on as it does.
    pub(crate) fn after(&self, seconds: f32) -> Self {
        let by_m = self.velocity_mps.map(|speed_mps| speed_mps * seconds);
        let limbs = self.limbs.iter().map(|limb| Limb { solid: limb.solid.moved(by_m), ..*limb });
        Self { limbs: limbs.collect(), ..self.clone() }
    }

    /// Between this moment and a later one; `share` is 0 now and 1 then.
    pub(crate) fn between(&self, later: &Self, share: f32) -> Self {
        let pairs = self.limbs.iter().zip(&later.limbs);
        let limbs = pairs.map(|(a, b)| Limb { name: b.name, solid: a.solid.between(&b.solid, share) });
        Self { limbs: limbs.collect(), ..later.clone() }
    }

    /// Middle of the body as seen from above, world frame, metres.
    pub(crate) fn middle_m(&self) -> [f32; 2] {
        let count = self.limbs.len().max(1) as f32;
        let bounds = self.limbs.iter().map(|limb| limb.solid.placed().bounds());
        bounds.fold([0.0, 0.0], |sum, [low, high]| {
            [sum[0] + (low.x + high.x) / 2.0 / count, sum[1] + (low.y + high.y) / 2.0 / count]
        })
    }
}
