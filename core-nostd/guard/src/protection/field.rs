//! Polygons around the robot, and where a ray leaves them.

use heapless::Vec;

use floorguard_types::capacities::FIELD_VERTICES_MAX;
use floorguard_types::geometry::Point2;

/// A field or an outline in the robot frame, metres.
pub type Polygon = Vec<Point2, FIELD_VERTICES_MAX>;

/// Pairs of neighbouring corners, the last with the first.
pub(super) fn edges(polygon: &[Point2]) -> impl Iterator<Item = (Point2, Point2)> + '_ {
    polygon.iter().copied().zip(polygon.iter().skip(1).chain(polygon.first()).copied())
}

/// Crossing-number test (book, Conventions: Point in polygon): bottom and left edges belong to the polygon.
///
/// ```
/// use floorguard_guard::point_in_polygon;
/// use floorguard_types::geometry::Point2;
///
/// let field = [(0.0, -1.0), (2.0, -1.0), (2.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
/// assert!(point_in_polygon(Point2::new(1.0, 0.5), &field));
/// assert!(!point_in_polygon(Point2::new(2.5, 0.5), &field));
/// ```
#[must_use]
pub fn point_in_polygon(point: Point2, polygon: &[Point2]) -> bool {
    let mut inside = false;
    for (i, j) in edges(polygon) {
        let straddles = (i.y_m > point.y_m) != (j.y_m > point.y_m);
        if straddles && point.x_m < (j.x_m - i.x_m) * (point.y_m - i.y_m) / (j.y_m - i.y_m) + i.x_m {
            inside = !inside;
        }
    }
    inside
}

/// Where a ray from `origin` along the unit vector `direction` leaves the polygon for the last time, metres; 0 when it
/// never meets it. For a polygon that is not star-shaped seen from `origin` everything before the last crossing
/// counts as inside: more than the polygon, never less (FG-REQ-020).
///
/// ```
/// use floorguard_guard::ray_exit_m;
/// use floorguard_types::geometry::Point2;
///
/// let field = [(0.0, -1.0), (2.0, -1.0), (2.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
/// let ahead = Point2::new(1.0, 0.0);
/// assert_eq!(ray_exit_m(&field, Point2::new(0.5, 0.0), ahead), 1.5);
/// assert_eq!(ray_exit_m(&field, Point2::new(0.5, 3.0), ahead), 0.0);
/// ```
#[must_use]
pub fn ray_exit_m(polygon: &[Point2], origin: Point2, direction: Point2) -> f32 {
    let mut exit_m = 0.0_f32;
    for (a, b) in edges(polygon) {
        let edge = Point2::new(b.x_m - a.x_m, b.y_m - a.y_m);
        let to_a = Point2::new(a.x_m - origin.x_m, a.y_m - origin.y_m);
        let determinant = cross(direction, edge);
        if determinant.abs() < 1.0e-9 {
            continue;
        }
        let along_edge = cross(to_a, direction) / determinant;
        // A hair beyond both ends, so that no ray slips through a corner.
        if (-1.0e-4..=1.000_1).contains(&along_edge) {
            exit_m = exit_m.max(cross(to_a, edge) / determinant);
        }
    }
    exit_m
}

fn cross(a: Point2, b: Point2) -> f32 {
    a.x_m * b.y_m - a.y_m * b.x_m
}
