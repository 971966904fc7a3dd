//! Where the body goes: its motions, and the places around it that each of them sweeps until the robot stands.

use floorguard_guard::{REACTION_S, STANDOFF_M, Stopping, Sweep, signed_distance_m};
use floorguard_runtime::configuration::{Geometry, Limits};
use floorguard_types::geometry::{Point2, Twist2};

use super::sight::{Index, indices, place};

/// Nearer to the body than this an object touches it already, metres.
const TOUCHES_M: f32 = 0.03;
/// A tight turn is this much slower than a wide one of the same turning rate.
const TIGHT: f32 = 0.3;
/// Straight ahead and behind reaches this far beside the body, metres.
const BESIDE_M: f32 = 0.06;

/// How the robot moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Straight ahead.
    Forward,
    /// Straight back.
    Reverse,
    /// Forward in a left bend.
    TurnLeft,
    /// Forward in a right bend.
    TurnRight,
    /// On the spot, counter-clockwise.
    SpinLeft,
    /// On the spot, clockwise.
    SpinRight,
}

impl Motion {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Forward, Self::Reverse, Self::TurnLeft, Self::TurnRight, Self::SpinLeft, Self::SpinRight];

    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Reverse => "reverse",
            Self::TurnLeft => "turning left",
            Self::TurnRight => "turning right",
            Self::SpinLeft => "spinning left",
            Self::SpinRight => "spinning right",
        }
    }

    /// It has a part forward.
    #[must_use]
    pub const fn is_forward(self) -> bool {
        matches!(self, Self::Forward | Self::TurnLeft | Self::TurnRight)
    }

    /// The robot turns.
    #[must_use]
    pub const fn is_turning(self) -> bool {
        !matches!(self, Self::Forward | Self::Reverse)
    }

    /// The twists that it stands for at a share of the limits; a second one for tight turns.
    pub(super) fn twists(self, limits: &Limits, share: f32) -> Vec<Twist2> {
        let twist = |linear_mps: f32, angular_radps: f32| Twist2 { linear_mps, angular_radps };
        let (speed_mps, turn_radps) = (share * limits.speed_mps, share * limits.turn_radps);
        match self {
            Self::Forward => vec![twist(speed_mps, 0.0)],
            Self::Reverse => vec![twist(-share * limits.reverse_mps, 0.0)],
            Self::TurnLeft => vec![twist(speed_mps, turn_radps), twist(TIGHT * speed_mps, turn_radps)],
            Self::TurnRight => vec![twist(speed_mps, -turn_radps), twist(TIGHT * speed_mps, -turn_radps)],
            Self::SpinLeft => vec![twist(0.0, turn_radps)],
            Self::SpinRight => vec![twist(0.0, -turn_radps)],
        }
    }
}

/// Where around the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Before it.
    Front,
    /// Where the left front corner goes.
    FrontLeft,
    /// Where the right front corner goes.
    FrontRight,
    /// Where the left rear corner goes.
    RearLeft,
    /// Where the right rear corner goes.
    RearRight,
    /// Behind it.
    Rear,
}

impl Region {
    /// All of them, in the order of their indices.
    pub const ALL: [Self; 6] =
        [Self::Front, Self::FrontLeft, Self::FrontRight, Self::RearLeft, Self::RearRight, Self::Rear];

    /// As a configuration names it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::FrontLeft => "front-left",
            Self::FrontRight => "front-right",
            Self::RearLeft => "rear-left",
            Self::RearRight => "rear-right",
            Self::Rear => "rear",
        }
    }

    /// Its place in [`Self::ALL`].
    pub(super) const fn index(self) -> usize {
        self as usize
    }
}

/// The body seen from above.
pub(super) struct Outline<'a> {
    pub(super) corners: &'a [Point2],
    /// Least and greatest x, metres.
    pub(super) x_m: [f32; 2],
    /// Least and greatest y, metres.
    pub(super) y_m: [f32; 2],
}

impl<'a> Outline<'a> {
    pub(super) fn of(geometry: &'a Geometry) -> Self {
        let extent = |value: fn(&Point2) -> f32| {
            let values = geometry.footprint.iter().map(value);
            values.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| {
                [low.min(value), high.max(value)]
            })
        };
        Self {
            corners: &geometry.footprint,
            x_m: extent(|corner| corner.x_m),
            y_m: extent(|corner| corner.y_m),
        }
    }

    /// Where a place lies that a motion sweeps.
    pub(super) fn region(&self, at: Point2, motion: Motion) -> Region {
        let ([rear_m, front_m], [right_m, left_m]) = (self.x_m, self.y_m);
        let is_ahead = at.x_m >= 0.5 * (rear_m + front_m);
        let is_behind_or_before = at.y_m > right_m - BESIDE_M && at.y_m < left_m + BESIDE_M;
        match (is_ahead, !motion.is_turning() && is_behind_or_before, at.y_m >= 0.5 * (right_m + left_m)) {
            (true, true, _) => Region::Front,
            (false, true, _) => Region::Rear,
            (true, false, true) => Region::FrontLeft,
            (true, false, false) => Region::FrontRight,
            (false, false, true) => Region::RearLeft,
            (false, false, false) => Region::RearRight,
        }
    }
}

/// What the body sweeps in one motion.
pub(super) struct Swept {
    /// How far its fastest point goes until the robot stands, with the standoff, metres.
    pub(super) needed_m: f32,
    /// Places beside the body that it comes to.
    pub(super) places: Vec<Index>,
}

impl Swept {
    /// Until the robot stands; `None`: nothing moves.
    pub(super) fn of(
        outline: &Outline<'_>,
        twist: Twist2,
        (geometry, limits): (&Geometry, &Limits),
    ) -> Option<Self> {
        let drive = limits.drive(geometry);
        let stopping = Stopping::from(outline.corners, twist, (&drive, REACTION_S));
        let needed_m = stopping.path_m() + STANDOFF_M;
        let sweep = Sweep::along(outline.corners, twist, needed_m)?;
        let is_swept = |index: &Index| {
            let at = place(*index);
            sweep.is_near(at)
                && signed_distance_m(outline.corners, at) > TOUCHES_M
                && sweep.free_m(at, needed_m) < needed_m
        };
        Some(Self { needed_m, places: indices().filter(is_swept).collect() })
    }
}

/// How fast the body moves at a place beside it, m/s.
pub(super) fn speed_at_mps(twist: Twist2, at: Point2) -> f32 {
    let along = twist.linear_mps - twist.angular_radps * at.y_m;
    along.hypot(twist.angular_radps * at.x_m)
}
