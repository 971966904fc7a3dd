//! Distances between the robot's outlines and people.

use floorguard_types::geometry::Point2;

use floorguard_configuration::polygon_contains;

/// Distance from a point to an outline, metres; negative inside: the distance to the edge.
#[must_use]
pub fn distance_m(outline: &[Point2], point: Point2) -> f32 {
    let ends = outline.iter().cycle().skip(1);
    let to_edge_m =
        outline.iter().zip(ends).map(|(a, b)| distance_to_edge_m(point, *a, *b)).fold(f32::MAX, f32::min);
    if polygon_contains(outline, point) { -to_edge_m } else { to_edge_m }
}

/// Distance from a point to the line between two others, metres.
pub fn distance_to_edge_m(point: Point2, a: Point2, b: Point2) -> f32 {
    let (dx_m, dy_m) = (b.x_m - a.x_m, b.y_m - a.y_m);
    let squared = (dx_m * dx_m + dy_m * dy_m).max(f32::MIN_POSITIVE);
    let along = (((point.x_m - a.x_m) * dx_m + (point.y_m - a.y_m) * dy_m) / squared).clamp(0.0, 1.0);
    point.distance(Point2::new(a.x_m + along * dx_m, a.y_m + along * dy_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_to_a_unit_square() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x_m, y_m)| Point2::new(x_m, y_m));
        assert_eq!(distance_m(&square, Point2::new(0.5, 0.4)), -0.4);
        assert_eq!(distance_m(&square, Point2::new(2.0, 0.5)), 1.0);
        assert!((distance_m(&square, Point2::new(4.0, 5.0)) - 5.0).abs() < 1e-6);
    }
}
