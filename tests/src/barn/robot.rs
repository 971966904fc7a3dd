//! The robot of the benchmark: a Clearpath Jackal.

use floorguard_types::geometry::Point2;
use floorguard_types::motion::{DriveGeometry, DriveKinematics, Footprint};

/// Which local planner drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The dynamic window as published, 0.5 m/s as in the benchmark's baseline.
    Dwa,
    /// Ours.
    Mppi,
}

/// Its outline: 0.508 m × 0.430 m.
///
/// # Panics
/// Never: the outline is legal.
#[must_use]
pub fn jackal() -> Footprint {
    let corners = [(0.254, 0.215), (-0.254, 0.215), (-0.254, -0.215), (0.254, -0.215)];
    Footprint::new(&corners.map(|(x, y)| Point2::new(x, y))).expect("a rectangle around the origin")
}

/// Its drive: 2 m/s; what tyres and motors give on a floor.
pub(super) const DRIVE: DriveKinematics = DriveKinematics {
    geometry: DriveGeometry::Differential,
    speed_max_mps: 2.0,
    reverse_max_mps: 0.5,
    turn_max_radps: 3.0,
    acceleration_mps2: 3.0,
    braking_mps2: 4.0,
    turn_acceleration_radps2: 12.0,
};
