//! Protective and warning fields per speed and direction.

use floorguard_guard::Travel;
use floorguard_types::capacities::FIELD_VERTICES_MAX;
use floorguard_types::geometry::Point2;
use heapless::Vec;

/// Speed bins per direction of travel (book, Guard: Field selection; up to 0.3, 0.6, 1.0 m/s and above).
pub const FIELD_SPEED_BINS: usize = 4;

/// A polygon in the robot frame, metres, counter-clockwise.
pub type Polygon = Vec<Point2, FIELD_VERTICES_MAX>;

/// Direction of travel to which a field applies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DirectionOfTravel {
    /// Forward, and turning where no other field is drawn.
    #[default]
    Forward,
    /// Backwards.
    Reverse,
    /// Forward in a left bend.
    Left,
    /// Forward in a right bend.
    Right,
    /// Turning on the spot.
    Spin,
}

impl DirectionOfTravel {
    /// As the guard calls it.
    #[must_use]
    pub const fn travel(self) -> Travel {
        match self {
            Self::Forward => Travel::Straight,
            Self::Reverse => Travel::Reverse,
            Self::Left => Travel::Left,
            Self::Right => Travel::Right,
            Self::Spin => Travel::Spin,
        }
    }
}

/// The fields of one speed bin and direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldPair {
    /// Direction of travel.
    pub direction: DirectionOfTravel,
    /// The pair applies up to this speed, m/s.
    pub speed_max_mps: f32,
    /// Something inside: stop.
    pub protective: Polygon,
    /// Something inside: slow down.
    pub warning: Polygon,
}
