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

/// Distance of a point from a polygon's area, metres; 0 inside.
#[must_use]
pub fn distance_to_area(polygon: &[Point2], point: Point2) -> f32 {
    let mut nearest = f32::INFINITY;
    let mut inside = false;
    for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (dx, dy) = (b.x_m - a.x_m, b.y_m - a.y_m);
        let along = ((point.x_m - a.x_m) * dx + (point.y_m - a.y_m) * dy) / (dx * dx + dy * dy).max(1.0e-9);
        let along = along.clamp(0.0, 1.0);
        nearest = nearest.min(point.distance(Point2::new(a.x_m + along * dx, a.y_m + along * dy)));
        let crosses = (a.y_m > point.y_m) != (b.y_m > point.y_m);
        if crosses && point.x_m < a.x_m + (point.y_m - a.y_m) / dy * dx {
            inside = !inside;
        }
    }
    if inside { 0.0 } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_zero_inside_and_euclidean_outside() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
        assert_eq!(distance_to_area(&square, Point2::new(0.5, 0.5)), 0.0);
        assert!((distance_to_area(&square, Point2::new(4.0, 5.0)) - 5.0).abs() < 1e-6);
    }
}
