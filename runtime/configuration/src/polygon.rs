//! Checks of outlines: enough corners, counter-clockwise, convex hull not needed, and how far they reach.

use floorguard_runtime::configuration::Polygon;
use floorguard_types::geometry::Point2;

/// Why a list of corners is not a usable outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadPolygon {
    /// Fewer than three corners.
    #[error("it has fewer than 3 corners")]
    TooFew,
    /// More corners than the guard's capacity.
    #[error("it has more than 16 corners")]
    TooMany,
    /// Two edges cross.
    #[error("its edges cross")]
    Crossing,
    /// The area is negative or zero.
    #[error("its corners do not run counter-clockwise")]
    Clockwise,
}

/// Corners to an outline.
///
/// # Errors
/// See [`BadPolygon`].
pub fn checked(points: &[[f32; 2]]) -> Result<Polygon, BadPolygon> {
    if points.len() < 3 {
        return Err(BadPolygon::TooFew);
    }
    let mut polygon = Polygon::new();
    for &[x_m, y_m] in points {
        polygon.push(Point2::new(x_m, y_m)).map_err(|_| BadPolygon::TooMany)?;
    }
    if crosses_itself(&polygon) {
        return Err(BadPolygon::Crossing);
    }
    if twice_area(&polygon) <= 0.0 { Err(BadPolygon::Clockwise) } else { Ok(polygon) }
}

/// A point lies inside or on the edge (even-odd rule; edges count as inside within 1 mm).
#[must_use]
pub fn contains(polygon: &[Point2], point: Point2) -> bool {
    let mut inside = false;
    for (a, b) in edges(polygon) {
        if distance_to_edge(point, a, b) < 1.0e-3 {
            return true;
        }
        let crosses = (a.y_m > point.y_m) != (b.y_m > point.y_m);
        if crosses && point.x_m < (b.x_m - a.x_m) * (point.y_m - a.y_m) / (b.y_m - a.y_m) + a.x_m {
            inside = !inside;
        }
    }
    inside
}

/// All corners of `inner` lie within `outer`.
#[must_use]
pub fn covers(outer: &[Point2], inner: &[Point2]) -> bool {
    inner.iter().all(|corner| contains(outer, *corner))
}

/// Smallest and greatest x, metres.
#[must_use]
pub fn x_extent_m(polygon: &[Point2]) -> (f32, f32) {
    polygon
        .iter()
        .fold((f32::MAX, f32::MIN), |(low, high), corner| (low.min(corner.x_m), high.max(corner.x_m)))
}

fn edges(polygon: &[Point2]) -> impl Iterator<Item = (Point2, Point2)> + '_ {
    polygon.iter().copied().zip(polygon.iter().copied().cycle().skip(1))
}

fn twice_area(polygon: &[Point2]) -> f32 {
    edges(polygon).map(|(a, b)| a.x_m * b.y_m - b.x_m * a.y_m).sum()
}

fn distance_to_edge(point: Point2, a: Point2, b: Point2) -> f32 {
    let (dx_m, dy_m) = (b.x_m - a.x_m, b.y_m - a.y_m);
    let squared = (dx_m * dx_m + dy_m * dy_m).max(f32::MIN_POSITIVE);
    let along = (((point.x_m - a.x_m) * dx_m + (point.y_m - a.y_m) * dy_m) / squared).clamp(0.0, 1.0);
    point.distance(Point2::new(a.x_m + along * dx_m, a.y_m + along * dy_m))
}

fn crosses_itself(polygon: &[Point2]) -> bool {
    let edges: Vec<(Point2, Point2)> = edges(polygon).collect();
    let side = |a: Point2, b: Point2, p: Point2| {
        (b.x_m - a.x_m) * (p.y_m - a.y_m) - (b.y_m - a.y_m) * (p.x_m - a.x_m)
    };
    edges.iter().enumerate().any(|(index, &(a, b))| {
        edges
            .iter()
            .skip(index + 2)
            .any(|&(c, d)| side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_must_be_simple_and_counter_clockwise() {
        assert!(checked(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]).is_ok());
        assert_eq!(checked(&[[0.0, 0.0], [0.0, 1.0], [1.0, 1.0]]), Err(BadPolygon::Clockwise));
        assert_eq!(checked(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), Err(BadPolygon::Crossing));
        assert_eq!(checked(&[[0.0, 0.0], [1.0, 1.0]]), Err(BadPolygon::TooFew));
        assert_eq!(checked(&[[0.0, 0.0]; 17]), Err(BadPolygon::TooMany));
    }

    #[test]
    fn the_edge_belongs_to_the_inside() {
        let square = checked(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]).unwrap();
        assert!(contains(&square, Point2::new(0.5, 0.5)) && contains(&square, Point2::new(1.0, 0.5)));
        assert!(!contains(&square, Point2::new(1.01, 0.5)));
        assert!(covers(&square, &square));
    }
}
