//! What really happens, at one moment.

use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::time::Stamp;

/// A person as a disc on the floor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TruthPerson {
    /// The simulator's number of the person.
    pub id: u32,
    /// Middle of the body, world frame, metres.
    pub position: Point2,
    /// World frame, m/s.
    pub velocity_mps: Point2,
    /// Radius of the body, metres: who comes this near to the robot's outline touches it.
    pub radius_m: f32,
    /// What crosses the scan plane of the safety scanner: middle in the world frame and radius, metres.
    pub ground: Vec<(Point2, f32)>,
    /// Everything of the person at any height.
    pub body: Vec<(Point2, f32)>,
}

impl TruthPerson {
    /// A person who is the same disc at every height.
    #[must_use]
    pub fn disc(id: u32, position: Point2, radius_m: f32) -> Self {
        Self {
            id,
            position,
            radius_m,
            ground: vec![(position, radius_m)],
            body: vec![(position, radius_m)],
            ..Self::default()
        }
    }
}

/// The true state of the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// Of the simulator's clock.
    pub stamp: Stamp,
    /// The robot, world frame.
    pub robot: Pose2,
    /// How it really moves, robot frame.
    pub twist: Twist2,
    /// Everybody.
    pub people: Vec<TruthPerson>,
    /// Points on walls and furniture around the robot at the scanner's height, robot frame, metres.
    pub obstacles_in_robot: Vec<Point2>,
    /// Points on them at other heights, which only the lidar can see, robot frame, metres.
    pub raised_in_robot: Vec<Point2>,
}
