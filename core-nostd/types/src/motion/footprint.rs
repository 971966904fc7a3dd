//! The outline of the robot on the floor.

use heapless::Vec;

use crate::geometry::{Point2, Pose2};

/// Corners of an outline: as many as a protective field has.
pub const FOOTPRINT_CORNERS_MAX: usize = 16;

/// Why an outline was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FootprintError {
    /// Fewer than three corners or more than [`FOOTPRINT_CORNERS_MAX`].
    CornerCount(usize),
    /// A corner is not finite.
    NotFinite,
    /// The base point lies outside the outline or on it.
    BaseOutside,
}

impl core::fmt::Display for FootprintError {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::CornerCount(count) => {
                write!(formatter, "an outline has 3 to {FOOTPRINT_CORNERS_MAX} corners, not {count}")
            }
            Self::NotFinite => write!(formatter, "a corner of the outline is not a number"),
            Self::BaseOutside => write!(formatter, "the robot's base point lies outside its outline"),
        }
    }
}

impl core::error::Error for FootprintError {}

/// The outline of the robot in its own frame, corners in order. Invariants: 3 to [`FOOTPRINT_CORNERS_MAX`] corners, all
/// finite, the base point inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Footprint {
    corners_in_base: Vec<Point2, FOOTPRINT_CORNERS_MAX>,
    inscribed_radius_m: f32,
    circumscribed_radius_m: f32,
}

impl Footprint {
    /// An outline from its corners, clockwise or counter-clockwise.
    ///
    /// # Errors
    /// See [`FootprintError`].
    pub fn new(corners_in_base: &[Point2]) -> Result<Self, FootprintError> {
        let count = corners_in_base.len();
        let corners = Vec::from_slice(corners_in_base).map_err(|_| FootprintError::CornerCount(count))?;
        if count < 3 {
            return Err(FootprintError::CornerCount(count));
        }
        if corners_in_base.iter().any(|corner| !corner.norm().is_finite()) {
            return Err(FootprintError::NotFinite);
        }
        let mut outline =
            Self { corners_in_base: corners, inscribed_radius_m: 0.0, circumscribed_radius_m: 0.0 };
        if !outline.contains(Point2::default()) {
            return Err(FootprintError::BaseOutside);
        }
        let farthest = corners_in_base.iter().map(|corner| corner.norm());
        outline.circumscribed_radius_m = farthest.fold(0.0, f32::max);
        outline.inscribed_radius_m = outline.distance_to_edge_m(Point2::default());
        if outline.inscribed_radius_m > 0.0 { Ok(outline) } else { Err(FootprintError::BaseOutside) }
    }

    /// The corners, in the robot's frame, metres.
    #[must_use]
    pub fn corners_in_base(&self) -> &[Point2] {
        &self.corners_in_base
    }

    /// Radius of the largest disc around the base point inside the outline, metres, > 0.
    #[must_use]
    pub const fn inscribed_radius_m(&self) -> f32 {
        self.inscribed_radius_m
    }

    /// Radius of the smallest disc around the base point that holds the outline, metres.
    #[must_use]
    pub const fn circumscribed_radius_m(&self) -> f32 {
        self.circumscribed_radius_m
    }

    /// Edges in order, as pairs of their ends in the robot's frame.
    pub fn edges(&self) -> impl Iterator<Item = [Point2; 2]> + '_ {
        let next = self.corners_in_base.iter().cycle().skip(1);
        self.corners_in_base.iter().zip(next).map(|(from, to)| [*from, *to])
    }

    /// A point of the robot's frame lies inside. Crossing number, half open at the edges.
    #[must_use]
    pub fn contains(&self, point_in_base: Point2) -> bool {
        let mut inside = false;
        for [a, b] in self.edges() {
            if (a.y_m > point_in_base.y_m) != (b.y_m > point_in_base.y_m) {
                let t = (point_in_base.y_m - a.y_m) / (b.y_m - a.y_m);
                inside ^= point_in_base.x_m < a.x_m + t * (b.x_m - a.x_m);
            }
        }
        inside
    }

    /// From a point of the robot's frame to the nearest edge, metres, ≥ 0.
    #[must_use]
    pub fn distance_to_edge_m(&self, point_in_base: Point2) -> f32 {
        let distances = self.edges().map(|[a, b]| {
            let (dx_m, dy_m) = (b.x_m - a.x_m, b.y_m - a.y_m);
            let length_m2 = (dx_m * dx_m + dy_m * dy_m).max(1.0e-12);
            let along = ((point_in_base.x_m - a.x_m) * dx_m + (point_in_base.y_m - a.y_m) * dy_m) / length_m2;
            let t = along.clamp(0.0, 1.0);
            point_in_base.distance(Point2::new(a.x_m + t * dx_m, a.y_m + t * dy_m))
        });
        distances.fold(f32::INFINITY, f32::min)
    }

    /// From the outline at a pose to a point of the same frame, metres; 0 inside.
    #[must_use]
    pub fn clearance_m(&self, pose: Pose2, point: Point2) -> f32 {
        let point_in_base = pose.inverse().transform(point);
        if self.contains(point_in_base) { 0.0 } else { self.distance_to_edge_m(point_in_base) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle() -> Footprint {
        let corners = [(0.4, 0.3), (-0.2, 0.3), (-0.2, -0.3), (0.4, -0.3)];
        Footprint::new(&corners.map(|(x, y)| Point2::new(x, y))).unwrap()
    }

    #[test]
    fn radii_and_clearance_of_a_rectangle() {
        let outline = rectangle();
        assert!((outline.inscribed_radius_m() - 0.2).abs() < 1e-6);
        assert!((outline.circumscribed_radius_m() - 0.5).abs() < 1e-6);
        let left = Pose2::new(1.0, 1.0, core::f32::consts::FRAC_PI_2);
        assert!((outline.clearance_m(left, Point2::new(1.0, 1.9)) - 0.5).abs() < 1e-6);
        assert_eq!(outline.clearance_m(left, Point2::new(1.0, 1.3)), 0.0);
    }

    #[test]
    fn broken_outlines_are_refused() {
        let line = [Point2::new(1.0, 0.0), Point2::new(-1.0, 0.0)];
        assert_eq!(Footprint::new(&line), Err(FootprintError::CornerCount(2)));
        assert_eq!(Footprint::new(&[Point2::default(); 17]), Err(FootprintError::CornerCount(17)));
        let aside = [Point2::new(1.0, 0.0), Point2::new(2.0, 0.0), Point2::new(1.0, 1.0)];
        assert_eq!(Footprint::new(&aside), Err(FootprintError::BaseOutside));
        let [a, b, _] = aside;
        assert_eq!(Footprint::new(&[a, b, Point2::new(f32::NAN, 0.0)]), Err(FootprintError::NotFinite));
    }
}
