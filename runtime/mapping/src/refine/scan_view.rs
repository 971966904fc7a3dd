//! A scan as the alignment reads it: points by bearing, with the direction of the wall at each.

use floorguard_types::geometry::Point2;

/// A point of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPoint {
    /// In the scanner's frame.
    pub point: Point2,
    /// Across the wall towards the scanner, length 1; zero where no direction is observable.
    pub normal: Point2,
}

/// A scan: its points, found by bearing.
#[derive(Clone, Debug)]
pub struct ScanView {
    /// By bearing, rising.
    pub points: Box<[WallPoint]>,
    /// First point of each degree, from −180°.
    first_of_degree: Box<[u16]>,
    /// Which beam each point is of, where the beams do not come by bearing.
    beams: Option<Box<[u16]>>,
}

const DEGREES: usize = 360;
/// Neighbours farther along the wall than this say nothing about its direction, metres...
const NEIGHBOUR_M: f32 = 0.2;
/// ... or than so many times the gap between beams.
const NEIGHBOUR_GAPS: f32 = 2.6;
/// Points to each side that are examined.
const NEIGHBOURS: usize = 8;

fn degree_of(bearing_rad: f32) -> usize {
    // Negative numbers become 0.
    let degree = (bearing_rad.to_degrees() + 180.0) as usize;
    degree.min(DEGREES - 1)
}

/// Error of [`bearing_rad`] with its rounding, radians.
const BEARING_ERROR_RAD: f32 = 5.0e-5;

/// Bearing of a point, within −π to π, to 0.00001 rad: an odd polynomial of the arc tangent (Abramowitz and Stegun 1964,
/// formula 4.4.49).
fn bearing_rad(point: Point2) -> f32 {
    use std::f32::consts::{FRAC_PI_2, PI};
    let (across, along) = (point.y_m.abs(), point.x_m.abs());
    let (small, large) = (across.min(along), across.max(along));
    let ratio = if large > 0.0 { small / large } else { 0.0 };
    let square = ratio * ratio;
    let polynomial = 0.999_866
        + square * (-0.330_299_5 + square * (0.180_141 + square * (-0.085_133 + square * 0.020_835_1)));
    let angle = ratio * polynomial;
    let angle = if across > along { FRAC_PI_2 - angle } else { angle };
    let angle = if point.x_m < 0.0 { PI - angle } else { angle };
    if point.y_m < 0.0 { -angle } else { angle }
}

/// Not less than the arc sine of a number from 0 to 1, and hardly more where it is small.
fn arc_sine_bound(sine: f32) -> f32 {
    // (asin s − s) / s³ rises with s: 0.189 at one half, π/2 − 1 at 1.
    let factor = if sine <= 0.5 { 0.189 } else { 0.571 };
    sine + factor * sine * sine * sine
}

impl ScanView {
    /// From the returns of a scan, of which no more than 65,535 are used. `step_rad` is the angle between beams.
    #[must_use]
    pub fn new(points: &[Point2], step_rad: f32) -> Self {
        let bearing = |&point: &Point2| (libm::atan2f(point.y_m, point.x_m), point);
        let mut sorted: Vec<(f32, Point2)> = points.iter().take(usize::from(u16::MAX)).map(bearing).collect();
        let mut beams = None;
        if !sorted.is_sorted_by(|a, b| a.0.total_cmp(&b.0).is_le()) {
            let mut order: Vec<u16> = (0..=u16::MAX).take(sorted.len()).collect();
            order.sort_by(|a, b| sorted[usize::from(*a)].0.total_cmp(&sorted[usize::from(*b)].0));
            sorted = order.iter().map(|beam| sorted[usize::from(*beam)]).collect();
            beams = Some(order.into_boxed_slice());
        }
        let wall = |index: usize| WallPoint {
            point: sorted[index].1,
            normal: wall_normal(&sorted, index, step_rad),
        };
        let points = (0..sorted.len()).map(wall).collect();
        let mut first_of_degree = vec![0_u16; DEGREES + 1].into_boxed_slice();
        for (bearing_rad, _) in &sorted {
            first_of_degree[degree_of(*bearing_rad) + 1] += 1;
        }
        for degree in 0..DEGREES {
            first_of_degree[degree + 1] += first_of_degree[degree];
        }
        Self { points, first_of_degree, beams }
    }

    /// The returns that it was made of, in their order.
    #[must_use]
    pub fn returns(&self) -> Box<[Point2]> {
        let sorted = self.points.iter().map(|wall| wall.point);
        let Some(beams) = &self.beams else { return sorted.collect() };
        let mut points = vec![Point2::default(); self.points.len()];
        beams.iter().zip(sorted).for_each(|(beam, point)| points[usize::from(*beam)] = point);
        points.into()
    }

    /// The nearest point to a place in the scanner's frame, within a distance.
    #[must_use]
    pub fn nearest(&self, place: Point2, within_m: f32) -> Option<&WallPoint> {
        let range = place.norm();
        if range <= within_m {
            return None;
        }
        let bearing = bearing_rad(place);
        let half_rad = arc_sine_bound(within_m / range) + BEARING_ERROR_RAD;
        let (low, high) = (degree_of(bearing - half_rad), degree_of(bearing + half_rad));
        let first = usize::from(self.first_of_degree[low]);
        let last = usize::from(self.first_of_degree[high + 1]);
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

    /// The nearest to a place of the few points that lie in its direction, within a distance: those of the same degree and one
    /// to each side (association by projection, Blais and Levine 1995). A third of the cost of [`Self::nearest`], and enough
    /// where the error counts across the wall.
    #[must_use]
    #[inline]
    pub fn in_direction(&self, place: Point2, within_m: f32) -> Option<&WallPoint> {
        let degree = degree_of(bearing_rad(place));
        let first = usize::from(self.first_of_degree[degree]).saturating_sub(1);
        let last = (usize::from(self.first_of_degree[degree + 1]) + 1).min(self.points.len());
        let mut best = within_m * within_m;
        let mut found = None;
        for wall in self.points.get(first..last)? {
            let (dx, dy) = (wall.point.x_m - place.x_m, wall.point.y_m - place.y_m);
            let squared = dx * dx + dy * dy;
            if squared < best {
                best = squared;
                found = Some(wall);
            }
        }
        found
    }

    /// How far this scan saw in a direction: the nearest of the returns within a degree and its two neighbours, so that
    /// a beam beside an edge does not see through it; `None` where it saw nothing.
    #[must_use]
    pub fn seen_range_m(&self, place: Point2) -> Option<f32> {
        let degree = degree_of(bearing_rad(place));
        let first = usize::from(self.first_of_degree[degree.saturating_sub(1)]);
        let last = usize::from(self.first_of_degree[(degree + 2).min(DEGREES)]);
        let square = |wall: &WallPoint| wall.point.x_m * wall.point.x_m + wall.point.y_m * wall.point.y_m;
        self.points[first..last].iter().map(square).min_by(f32::total_cmp).map(f32::sqrt)
    }
}

/// Direction across the wall at a point, by the spread of its neighbours.
fn wall_normal(points: &[(f32, Point2)], index: usize, step_rad: f32) -> Point2 {
    let here = points[index].1;
    let limit = (NEIGHBOUR_GAPS * here.norm() * step_rad).max(NEIGHBOUR_M);
    let low = index.saturating_sub(NEIGHBOURS);
    let high = (index + NEIGHBOURS + 1).min(points.len());
    let near = points[low..high].iter().map(|(_, other)| other).filter(|other| other.distance(here) <= limit);
    let (mut count, mut sum_x, mut sum_y, mut xx, mut xy, mut yy) = (0.0_f32, 0.0, 0.0, 0.0, 0.0, 0.0);
    for other in near {
        let (x, y) = (other.x_m - here.x_m, other.y_m - here.y_m);
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
    let along = if xx >= yy { Point2::new(large - yy, xy) } else { Point2::new(xy, large - xx) };
    let length = (along.x_m * along.x_m + along.y_m * along.y_m).sqrt();
    if length <= 0.0 {
        return Point2::default();
    }
    // The face that was seen: the other side of a thin wall is another one.
    let (x, y) = (-along.y_m / length, along.x_m / length);
    let away = x * here.x_m + y * here.y_m;
    if away > 0.0 { Point2::new(-x, -y) } else { Point2::new(x, y) }
}
