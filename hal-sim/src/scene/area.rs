//! Areas of the floor.

use floorguard_types::geometry::Point2;

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
