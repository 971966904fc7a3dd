//! What the drive does from a pose of the lattice: straight on, arcs, turns on the spot, straight back.

use floorguard_types::geometry::Pose2;
use floorguard_types::motion::Gear;
use floorguard_types::number::count_f32;

/// Headings that are kept apart.
pub const HEADINGS: usize = 16;
/// Between two of them, radians.
pub(super) const TURN_RAD: f32 = core::f32::consts::TAU / count_f32(HEADINGS);
/// Motions from a pose.
pub(super) const MOTIONS: usize = 6;

/// Speeds that the costs are made of, and the shape of the motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Forward, m/s, > 0.
    pub speed_mps: f32,
    /// On the spot, rad/s, > 0.
    pub turn_radps: f32,
    /// Backwards, m/s, > 0.
    pub reverse_mps: f32,
    /// What a change of gear takes, seconds.
    pub change_s: f32,
    /// Length of a straight step, metres: more than a cell of the raster, so that it leaves it.
    pub step_m: f32,
    /// Radius of the arcs, metres, > 0.
    pub arc_m: f32,
    /// What is left counts this much more than what lies behind: 1 finds the best path, more finds a good one sooner.
    pub haste: f32,
}

/// A motion of the lattice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// In the robot's frame.
    pub(super) by: Pose2,
    /// On open floor, seconds.
    pub(super) costs_s: f32,
    pub(super) gear: Gear,
}

/// Left before right, the most usual first.
pub(super) fn motions(pace: &Pace) -> [Motion; MOTIONS] {
    let chord_m = 2.0 * pace.arc_m * libm::sinf(TURN_RAD / 2.0);
    let arc = |sign: f32| {
        let (sin, cos) = libm::sincosf(sign * TURN_RAD / 2.0);
        let speed_mps = (0.8 * pace.speed_mps).min(pace.turn_radps * pace.arc_m);
        Motion {
            by: Pose2::new(chord_m * cos, chord_m * sin, sign * TURN_RAD),
            costs_s: pace.arc_m * TURN_RAD / speed_mps,
            gear: Gear::Ahead,
        }
    };
    let spin = |sign: f32| Motion {
        by: Pose2::new(0.0, 0.0, sign * TURN_RAD),
        costs_s: TURN_RAD / pace.turn_radps,
        gear: Gear::Spin,
    };
    let straight = |path_m: f32, speed_mps: f32, gear| Motion {
        by: Pose2::new(path_m, 0.0, 0.0),
        costs_s: libm::fabsf(path_m) / speed_mps,
        gear,
    };
    [
        straight(pace.step_m, pace.speed_mps, Gear::Ahead),
        arc(1.0),
        arc(-1.0),
        spin(1.0),
        spin(-1.0),
        straight(-pace.step_m, pace.reverse_mps, Gear::Back),
    ]
}
