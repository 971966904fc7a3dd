//! What a top view shows: plain data, all in the map's frame, metres.

use floorguard_types::geometry::{Point2, Pose2};

/// A run seen from above.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TopView {
    /// First line above the picture.
    pub title: String,
    /// Second line: seed, duration, verdict.
    pub subtitle: String,
    /// Closed outlines of walls.
    pub walls: Vec<Vec<Point2>>,
    /// Closed outlines of shelves, tables and other obstacles.
    pub obstacles: Vec<Vec<Point2>>,
    /// Where the robot was, in time order.
    pub robot_path: Vec<Pose2>,
    /// Outline of the robot in its own frame.
    pub robot_outline: Vec<Point2>,
    /// Width of the swath that the brush leaves behind the robot, metres; 0 draws none.
    pub swath_width_m: f32,
    /// Where people were.
    pub people: Vec<PersonPath>,
    /// Where the robot stopped, in time order.
    pub stops: Vec<StopMark>,
}

/// The path of one person.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PersonPath {
    /// Number of the person.
    pub id: u64,
    /// In time order; an empty path draws nothing.
    pub points: Vec<Point2>,
}

/// One stop.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StopMark {
    /// Where the robot stood.
    pub position: Point2,
    /// When, seconds after the start of the run.
    pub at_s: f64,
    /// Why, in a few words; stops of the same cause share a colour.
    pub cause: String,
}
