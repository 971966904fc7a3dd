//! What the brush sweeps between two poses, and which part of a cell that is.
//!
//! The brush is a bar across the robot. Between two poses it sweeps a quadrilateral; turning on the spot makes the two
//! bars cross, and the swath is then two triangles (book, Cleaning: Swath).

use heapless::Vec;

use floorguard_types::geometry::{Point2, Pose2};

/// Corners of a triangle clipped by a square: each of four edges adds at most one. A quadrilateral reaches eight.
const CLIPPED_CORNERS_MAX: usize = 12;

/// The brush: a bar across the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brush {
    /// Width of the bar, metres, > 0.
    pub width_m: f32,
    /// Position of the bar along the robot's x axis, metres; 0 is under the kinematic centre.
    pub offset_m: f32,
}

impl Brush {
    /// Left and right end of the bar, in the map frame, for a robot at a pose of it.
    #[must_use]
    pub fn bar_at(&self, pose_in_map: Pose2) -> [Point2; 2] {
        let (sin, cos) = libm::sincosf(pose_in_map.heading_rad);
        let half = 0.5 * self.width_m;
        let middle =
            Point2::new(pose_in_map.x_m + cos * self.offset_m, pose_in_map.y_m + sin * self.offset_m);
        [
            Point2::new(middle.x_m - sin * half, middle.y_m + cos * half),
            Point2::new(middle.x_m + sin * half, middle.y_m - cos * half),
        ]
    }
}

/// The ground swept between two positions of the bar: one or two convex pieces.
///
/// ```
/// use floorguard_cleaning::{Brush, Swath};
/// use floorguard_types::geometry::{Point2, Pose2};
///
/// // A brush of 0.2 m goes 0.1 m ahead: it covers half of a cell that begins at its middle.
/// let brush = Brush { width_m: 0.2, offset_m: 0.0 };
/// let swath = Swath::between(brush.bar_at(Pose2::default()), brush.bar_at(Pose2::new(0.1, 0.0, 0.0)));
/// assert!((swath.share_of_square(Point2::new(0.05, 0.0), 0.1) - 0.5).abs() < 1.0e-5);
/// assert!(swath.contains(Point2::new(0.05, 0.05)) && !swath.contains(Point2::new(0.05, 0.15)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Swath {
    /// The bars do not cross.
    Quadrilateral([Point2; 4]),
    /// The bars cross: a triangle on either side of the crossing.
    Triangles([[Point2; 3]; 2]),
}

impl Swath {
    /// The swath from one bar to the next; both as given by [`Brush::bar_at`].
    #[inline]
    #[must_use]
    pub fn between(before: [Point2; 2], after: [Point2; 2]) -> Self {
        let [left, right] = before;
        let [next_left, next_right] = after;
        match crossing(before, after) {
            Some(point) => Self::Triangles([[left, next_left, point], [right, next_right, point]]),
            None => Self::Quadrilateral([left, right, next_right, next_left]),
        }
    }

    /// A piece for each convex part.
    pub fn pieces(&self) -> impl Iterator<Item = &[Point2]> {
        let (first, second): (&[Point2], Option<&[Point2]>) = match self {
            Self::Quadrilateral(corners) => (corners, None),
            Self::Triangles([a, b]) => (a, Some(b)),
        };
        core::iter::once(first).chain(second)
    }

    /// A point of the ground was swept.
    #[must_use]
    pub fn contains(&self, point: Point2) -> bool {
        self.pieces().any(|corners| is_inside_outline(corners, point))
    }

    /// Share of the square with this corner and edge that was swept, within [0, 1]; exact (Sutherland–Hodgman and the
    /// shoelace formula).
    #[must_use]
    pub fn share_of_square(&self, corner: Point2, edge_m: f32) -> f32 {
        let area: f32 = self.pieces().map(|corners| clipped_area(corners, corner, edge_m)).sum();
        let whole = edge_m * edge_m;
        if whole > 0.0 { (area / whole).min(1.0) } else { 0.0 }
    }
}

fn cross(origin: Point2, a: Point2, b: Point2) -> f32 {
    (a.x_m - origin.x_m) * (b.y_m - origin.y_m) - (a.y_m - origin.y_m) * (b.x_m - origin.x_m)
}

/// Where two segments cross properly; touching ends do not count.
#[inline]
fn crossing(first: [Point2; 2], second: [Point2; 2]) -> Option<Point2> {
    let [a, b] = first;
    let [c, d] = second;
    let (side_c, side_d) = (cross(a, b, c), cross(a, b, d));
    let (side_a, side_b) = (cross(c, d, a), cross(c, d, b));
    if side_c * side_d >= 0.0 || side_a * side_b >= 0.0 {
        return None;
    }
    // Opposite signs: the difference is not zero.
    let t = side_a / (side_a - side_b);
    Some(Point2::new(a.x_m + t * (b.x_m - a.x_m), a.y_m + t * (b.y_m - a.y_m)))
}

/// Crossing-number test (book, Conventions: Point in polygon).
fn is_inside_outline(corners: &[Point2], point: Point2) -> bool {
    let mut inside = false;
    let mut previous = corners.last().copied().unwrap_or(point);
    for &corner in corners {
        if (corner.y_m > point.y_m) != (previous.y_m > point.y_m) {
            let t = (point.y_m - corner.y_m) / (previous.y_m - corner.y_m);
            inside ^= point.x_m < corner.x_m + t * (previous.x_m - corner.x_m);
        }
        previous = corner;
    }
    inside
}

/// Keeps the side of `sign · (coordinate − limit) ≥ 0`.
fn clip(
    corners: &Vec<Point2, CLIPPED_CORNERS_MAX>,
    along_x: bool,
    sign: f32,
    limit: f32,
) -> Vec<Point2, CLIPPED_CORNERS_MAX> {
    let mut kept = Vec::new();
    let depth = |p: Point2| sign * (if along_x { p.x_m } else { p.y_m } - limit);
    let Some(&last) = corners.last() else { return kept };
    let mut previous = last;
    for &corner in corners {
        let (before, here) = (depth(previous), depth(corner));
        if (before >= 0.0) != (here >= 0.0) {
            let t = before / (before - here);
            let x = previous.x_m + t * (corner.x_m - previous.x_m);
            let y = previous.y_m + t * (corner.y_m - previous.y_m);
            // A convex piece never overflows; a corner that did would only shrink the area, which claims less.
            let _full = kept.push(Point2::new(x, y));
        }
        if here >= 0.0 {
            let _full = kept.push(corner);
        }
        previous = corner;
    }
    kept
}

fn clipped_area(corners: &[Point2], low: Point2, edge_m: f32) -> f32 {
    let mut polygon = Vec::new();
    // Relative to the corner of the square, so that large map coordinates lose no digits.
    for corner in corners.iter().take(CLIPPED_CORNERS_MAX) {
        let _full = polygon.push(Point2::new(corner.x_m - low.x_m, corner.y_m - low.y_m));
    }
    let polygon = clip(&polygon, true, 1.0, 0.0);
    let polygon = clip(&polygon, true, -1.0, edge_m);
    let polygon = clip(&polygon, false, 1.0, 0.0);
    let polygon = clip(&polygon, false, -1.0, edge_m);
    let Some(&last) = polygon.last() else { return 0.0 };
    let mut doubled = 0.0;
    let mut previous = last;
    for &corner in &polygon {
        doubled += previous.x_m * corner.y_m - corner.x_m * previous.y_m;
        previous = corner;
    }
    0.5 * libm::fabsf(doubled)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test values of the book, Cleaning: Swath; the same numbers come out of shapely.
    #[test]
    fn golden_vector() {
        let swath = Swath::Quadrilateral([
            Point2::new(0.03, 0.02),
            Point2::new(0.23, 0.05),
            Point2::new(0.20, 0.15),
            Point2::new(0.01, 0.11),
        ]);
        let expected = [
            ((0, 0), 0.594_361),
            ((0, 1), 0.174_152),
            ((1, 0), 0.62),
            ((1, 1), 0.394_737),
            ((2, 0), 0.119_25),
            ((2, 1), 0.037_5),
        ];
        let mut area = 0.0;
        for ((column, row), share) in expected {
            let corner = Point2::new(column as f32 * 0.1, row as f32 * 0.1);
            let found = swath.share_of_square(corner, 0.1);
            assert!((found - share).abs() < 2e-5, "{column},{row}: {found}");
            area += found * 0.01;
        }
        assert!((area - 0.0194).abs() < 1e-6);
    }

    /// Turning on the spot sweeps two sectors: the area is 2 · ½ r² sin Δθ for straight chords.
    #[test]
    fn turning_sweeps_two_triangles() {
        let brush = Brush { width_m: 0.17, offset_m: 0.0 };
        let turn = 0.1_f32;
        let swath = Swath::between(
            brush.bar_at(Pose2::new(0.05, 0.05, 0.3)),
            brush.bar_at(Pose2::new(0.05, 0.05, 0.3 + turn)),
        );
        assert!(matches!(swath, Swath::Triangles(_)));
        let mut area = 0.0;
        for column in -2..3 {
            for row in -2..3 {
                area += 0.01 * swath.share_of_square(Point2::new(column as f32 * 0.1, row as f32 * 0.1), 0.1);
            }
        }
        assert!((area - 0.085 * 0.085 * libm::sinf(turn)).abs() < 1e-6, "{area}");
    }

    #[test]
    fn straight_lane_covers_what_lies_below() {
        let brush = Brush { width_m: 0.2, offset_m: 0.05 };
        let swath =
            Swath::between(brush.bar_at(Pose2::new(0.0, 0.0, 0.0)), brush.bar_at(Pose2::new(0.1, 0.0, 0.0)));
        assert!(swath.contains(Point2::new(0.10, 0.09)));
        assert!(!swath.contains(Point2::new(0.10, 0.11)));
        assert!(!swath.contains(Point2::new(0.04, 0.0)) && !swath.contains(Point2::new(0.16, 0.0)));
    }
}
