//! A scan as the alignment reads it: points by bearing, with the direction of the wall at each.

use floorguard_types::geometry::Point2;

/// A point of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPoint {
    /// In the scanner's frame.
    pub point: Point2,
    /// Across the wall, length 1; zero where no direction is observable.
    pub normal: Point2,
    /// Bearing, radians.
    pub bearing_rad: f32,
    /// Distance from the scanner, metres.
    pub range_m: f32,
}

/// A scan: its points, found by bearing.
#[derive(Clone, Debug)]
pub struct ScanView {
    /// By bearing, rising.
    pub points: Vec<WallPoint>,
    /// First point of each degree, from −180°.
    first_of_degree: Vec<u32>,
}

const DEGREES: usize = 360;
/// Neighbours farther along the wall than this say nothing about its direction, metres...
const NEIGHBOUR_M: f32 = 0.2;
/// ... or than so many times the gap between beams.
const NEIGHBOUR_GAPS: f32 = 2.6;
/// Points to each side that are examined.
const NEIGHBOURS: usize = 8;

fn degree_of(bearing_rad: f32) -> usize {
    let degree = (bearing_rad.to_degrees() + 180.0).floor().max(0.0) as usize;
    degree.min(DEGREES - 1)
}

impl ScanView {
    /// From the returns of a scan. `step_rad` is the angle between beams.
    #[must_use]
    pub fn new(points: &[Point2], step_rad: f32) -> Self {
        let mut sorted: Vec<WallPoint> = points
            .iter()
            .map(|&point| WallPoint {
                point,
                normal: Point2::default(),
                bearing_rad: point.y_m.atan2(point.x_m),
                range_m: point.norm(),
            })
            .collect();
        sorted.sort_by(|a, b| a.bearing_rad.total_cmp(&b.bearing_rad));
        for index in 0..sorted.len() {
            sorted[index].normal = wall_normal(&sorted, index, step_rad);
        }
        let mut first_of_degree = vec![0_u32; DEGREES + 1];
        for wall in &sorted {
            first_of_degree[degree_of(wall.bearing_rad) + 1] += 1;
        }
        for degree in 0..DEGREES {
            first_of_degree[degree + 1] += first_of_degree[degree];
        }
        Self { points: sorted, first_of_degree }
    }

    /// The nearest point to a place in the scanner's frame, within a distance.
    #[must_use]
    pub fn nearest(&self, place: Point2, within_m: f32) -> Option<&WallPoint> {
        let range = place.norm();
        let half_rad = if range > within_m { (within_m / range).asin() } else { return None };
        let bearing = place.y_m.atan2(place.x_m);
        let (low, high) = (degree_of(bearing - half_rad), degree_of(bearing + half_rad));
        let first = self.first_of_degree[low] as usize;
        let last = self.first_of_degree[high + 1] as usize;
        let mut best = within_m * within_m;
        let mut found = None;
        for wall in &self.points[first..last] {
            let (dx, dy) = (wall.point.x_m - place.x_m, wall.point.y_m - place.y_m);
            let squared = dx * dx + dy * dy;
            if squared < best {
                best = squared;
                found = Some(wall);
            }
        }
        found
    }

    /// How far this scan saw in a direction: the nearest of the returns within a degree; `None` where it saw nothing.
    #[must_use]
    pub fn seen_range_m(&self, bearing_rad: f32) -> Option<f32> {
        let degree = degree_of(bearing_rad);
        let first = self.first_of_degree[degree] as usize;
        let last = self.first_of_degree[degree + 1] as usize;
        self.points[first..last].iter().map(|wall| wall.range_m).min_by(f32::total_cmp)
    }
}

/// Direction across the wall at a point, by the spread of its neighbours.
fn wall_normal(points: &[WallPoint], index: usize, step_rad: f32) -> Point2 {
    let here = points[index];
    let limit = (NEIGHBOUR_GAPS * here.range_m * step_rad).max(NEIGHBOUR_M);
    let low = index.saturating_sub(NEIGHBOURS);
    let high = (index + NEIGHBOURS + 1).min(points.len());
    let near = points[low..high].iter().filter(|other| other.point.distance(here.point) <= limit);
    let (mut count, mut sum_x, mut sum_y, mut xx, mut xy, mut yy) = (0.0_f32, 0.0, 0.0, 0.0, 0.0, 0.0);
    for other in near {
        let (x, y) = (other.point.x_m - here.point.x_m, other.point.y_m - here.point.y_m);
        count += 1.0;
        sum_x += x;
        sum_y += y;
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    if count < 3.0 {
        return Point2::default();
    }
    let (mean_x, mean_y) = (sum_x / count, sum_y / count);
    let (xx, xy, yy) =
        (xx / count - mean_x * mean_x, xy / count - mean_x * mean_y, yy / count - mean_y * mean_y);
    let half_trace = 0.5 * (xx + yy);
    let root = (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
    let (large, small) = (half_trace + root, half_trace - root);
    if small > 0.15 * large {
        return Point2::default();
    }
    // Along the wall: eigenvector of the larger value; the normal is a quarter turn from it.
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    Point2::new(-angle.sin(), angle.cos())
}
