//! What a sensor reports of one person: the input of the tracker.

use super::appearance::AppearanceOf;
use super::explanation::Surroundings;
use floorguard_types::geometry::Point2;
use floorguard_types::profile::{Native, Profile};

/// A candidate, in the fixed frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectionOf<P: Profile> {
    /// Where it stands on the floor.
    pub position: Point2,
    /// How far from the sensor, metres: the farthest is given up first when the list is full.
    pub distance_m: f32,
    /// Standard deviation of the position, metres.
    pub sigma_m: f32,
    /// Probability that it is a person, from this one shape.
    pub likeness: f32,
    /// Returns that speak for it.
    pub points: u16,
    /// Whether it moves by itself; `None` if that was not judged. Where a scanner judges it, the way that the track has come
    /// does not count: the scanner may move unknown to us.
    pub moving: Option<bool>,
    /// What it is connected with.
    pub surroundings: Surroundings,
    /// Its appearance.
    pub appearance: AppearanceOf<P>,
}

/// A candidate in the memory of the target.
pub type Detection = DetectionOf<Native>;
