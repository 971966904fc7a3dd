//! What really happens, at one moment.

use floorguard_core::geometry::{Point2, Pose2, Twist2};
use floorguard_core::time::Stamp;

/// A person as a disc on the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthPerson {
    /// The simulator's number of the person.
    pub id: u32,
    /// Middle of the body, world frame, metres.
    pub position: Point2,
    /// Radius of the body at the height of the robot, metres.
    pub radius_m: f32,
}

/// The true state of the world.
#[derive(Clone, Debug, PartialEq)]
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
}
