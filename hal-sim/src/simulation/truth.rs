//! The true state of the world, for judges.

use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::time::Stamp;

use crate::people::{Disc, PersonKind};

/// A person as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct PersonTruth {
    /// Number in the scenario, from 1.
    pub id: u32,
    /// Who.
    pub kind: PersonKind,
    /// Middle of the body, world frame, metres.
    pub position: Point2,
    /// World frame, m/s.
    pub velocity: Point2,
    /// Middles of the feet, world frame.
    pub feet: [Point2; 2],
    /// Radius of the body, metres.
    pub radius_m: f32,
    /// Metres.
    pub height_m: f32,
    /// What crosses the scan plane of the safety scanner, world frame.
    pub ground_discs: Vec<Disc>,
    /// Everything of the person at any height, world frame.
    pub body_discs: Vec<Disc>,
    /// Nothing that stands still hides the person from the lidar.
    pub in_sight: bool,
}

/// The true state at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// World time.
    pub stamp: Stamp,
    /// Robot, world frame.
    pub robot: Pose2,
    /// Robot frame, of the middle of the rear axle.
    pub twist: Twist2,
    /// Angle of the front wheel, radians.
    pub steering_rad: f32,
    /// Everybody.
    pub people: Vec<PersonTruth>,
    /// From the outline to the nearest person's body, metres; 0 in contact, infinite with nobody there.
    pub nearest_person_m: f32,
    /// People who touch the outline now.
    pub touching: Vec<u32>,
    /// The button is pressed.
    pub emergency_stop: bool,
}
