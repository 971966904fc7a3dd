//! What can be seen from the robot over the floor: a polygon around it, star-shaped.
//!
//! The published polygon has the robot's centre and the nearest blocking cell of each column as corners (Dalmedico et al.
//! 2019). Columns of a flat grid do not follow each other in direction where depths differ, so here the
//! corners are kept by direction, half a degree each: the polygon is star-shaped, and whether a place lies inside takes one
//! arc tangent and one cross product. Directions without a blocking cell have no corner. As published, an edge joins the
//! corners on either side of them, but only as far as [`SightLimits::gap_max`]: a wider gap was not seen closed.

use floorguard_types::geometry::{Point2, wrap_angle};
use floorguard_types::number::{nearest_f32, saturating_usize};

use super::capacities::SIGHT_BEARINGS;
use super::cell::{CellContent, WindowCell};
use super::face::FacePoint;
use super::window::SlidingWindow;

/// The first bearing and the step from one to the next, radians: half a degree from −112.5°.
const FIRST_RAD: f32 = -1.963_495_4;
const STEP_RAD: f32 = 0.008_726_646;
/// Bearings that one cell may cover: all of a half plane.
const COVER_MAX: usize = 360;

/// Which cells block the sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SightLimits {
    /// Lower cells are floor, metres.
    pub floor_max_m: f32,
    /// Higher cells hang over the robot, metres: 0.6 drives under tables, 1.0 does not (Dalmedico et al. 2019).
    pub threshold_m: f32,
    /// Directions without a corner that an edge may pass, bearings of half a degree.
    pub gap_max: usize,
}

impl SightLimits {
    /// The floor up to 5 cm, a threshold, gaps of at most 5°.
    #[must_use]
    pub const fn of_threshold(threshold_m: f32) -> Self {
        Self { floor_max_m: 0.05, threshold_m, gap_max: 10 }
    }

    pub(super) fn blocks(&self, height_m: f32) -> bool {
        (self.floor_max_m..=self.threshold_m).contains(&height_m)
    }
}

/// Distance to the nearest blocking cell by direction, in the window's frame.
///
/// # Invariants
/// A corner lies in the middle of its bearing; the polygon is star-shaped around the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct SightPolygon {
    /// Metres; infinite where nothing blocks.
    ranges_m: [f32; SIGHT_BEARINGS],
    gap_max: usize,
}

impl SightPolygon {
    /// The polygon of a window. Cost: one pass over all cells.
    #[must_use]
    pub fn of<S: AsRef<[WindowCell]> + AsMut<[WindowCell]>>(
        window: &SlidingWindow<S>,
        limits: &SightLimits,
    ) -> Self {
        let mut polygon = Self { ranges_m: [f32::INFINITY; SIGHT_BEARINGS], gap_max: limits.gap_max };
        let half_m = 0.5 * window.geometry().resolution_m();
        let blocking = window.points().filter(|one| limits.blocks(one.point.z_m));
        for one in blocking.filter(|one| one.content == CellContent::Surface) {
            let seen = one.face.project(one.point);
            let along_m = window.geometry().centre(one.index).along_m;
            let end = |side_m: f32| {
                let end = one.face.point(FacePoint { along_m: along_m + side_m, ..seen });
                libm::atan2f(end.y_m, end.x_m)
            };
            let range_m = Point2::new(one.point.x_m, one.point.y_m).norm();
            polygon.enter(range_m, end(-half_m), end(half_m));
        }
        polygon
    }

    /// A blocking cell covers the bearings of its width, from its right end to its left end, so that cells beside each other
    /// leave no gap.
    fn enter(&mut self, range_m: f32, right_rad: f32, left_rad: f32) {
        let bearing_of =
            |azimuth_rad: f32| saturating_usize(libm::roundf((azimuth_rad - FIRST_RAD) / STEP_RAD));
        let (first, last) = (bearing_of(right_rad), bearing_of(left_rad));
        for bearing in (first..=last).take(COVER_MAX) {
            if let Some(nearest_m) = self.ranges_m.get_mut(bearing) {
                *nearest_m = nearest_m.min(range_m);
            }
        }
    }

    /// A corner of the polygon: its direction is `−112.5° + 0.5° · bearing`; `None` where nothing blocks.
    #[must_use]
    pub fn corner(&self, bearing: usize) -> Option<Point2> {
        let range_m = self.ranges_m.get(bearing).copied().filter(|range_m| range_m.is_finite())?;
        let (sin, cos) = libm::sincosf(FIRST_RAD + nearest_f32(bearing) * STEP_RAD);
        Some(Point2::new(range_m * cos, range_m * sin))
    }

    /// Whether a place of the window's frame lies inside: it is seen to be free of what blocks. Constant time but for the
    /// search of the corners beside a gap.
    #[must_use]
    pub fn contains(&self, point: Point2) -> bool {
        let azimuth_rad = wrap_angle(libm::atan2f(point.y_m, point.x_m));
        let place = (azimuth_rad - FIRST_RAD) / STEP_RAD;
        if !(0.0..nearest_f32(SIGHT_BEARINGS)).contains(&place) {
            return false;
        }
        let below = saturating_usize(place);
        let (Some(right), Some(left)) =
            (self.corner_from(below, false), self.corner_from(below.saturating_add(1), true))
        else {
            return false;
        };
        if left.bearing.saturating_sub(right.bearing) > self.gap_max.saturating_add(1) {
            return false;
        }
        // On the robot's side of the edge from the right corner to the left one.
        let (edge_x, edge_y) = (left.corner.x_m - right.corner.x_m, left.corner.y_m - right.corner.y_m);
        let (x, y) = (point.x_m - right.corner.x_m, point.y_m - right.corner.y_m);
        edge_x * y - edge_y * x > 0.0
    }

    /// Whether something blocks nearer in the direction of a place of the window's frame.
    #[must_use]
    pub fn is_behind(&self, point: Point2) -> bool {
        let azimuth_rad = wrap_angle(libm::atan2f(point.y_m, point.x_m));
        let nearest = saturating_usize(libm::roundf((azimuth_rad - FIRST_RAD) / STEP_RAD));
        self.ranges_m.get(nearest).is_some_and(|range_m| point.norm() > *range_m)
    }

    /// The first corner from a bearing on, within the widest gap.
    fn corner_from(&self, start: usize, upwards: bool) -> Option<Corner> {
        (0..=self.gap_max.min(SIGHT_BEARINGS)).find_map(|step| {
            let bearing = if upwards { start.checked_add(step)? } else { start.checked_sub(step)? };
            self.corner(bearing).map(|corner| Corner { bearing, corner })
        })
    }
}

#[derive(Clone, Copy)]
struct Corner {
    bearing: usize,
    corner: Point2,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Even-odd rule over all edges: another way to the same answer.
    fn is_inside(corners: &[Point2], point: Point2) -> bool {
        let mut inside = false;
        for (index, a) in corners.iter().enumerate() {
            let b = corners[(index + 1) % corners.len()];
            let crosses = (a.y_m > point.y_m) != (b.y_m > point.y_m);
            if crosses && point.x_m < a.x_m + (point.y_m - a.y_m) / (b.y_m - a.y_m) * (b.x_m - a.x_m) {
                inside = !inside;
            }
        }
        inside
    }

    #[test]
    fn agrees_with_the_even_odd_rule() {
        let mut polygon = SightPolygon { ranges_m: [f32::INFINITY; SIGHT_BEARINGS], gap_max: SIGHT_BEARINGS };
        let mut corners = Vec::from([Point2::default()]);
        for bearing in (0..SIGHT_BEARINGS).step_by(3) {
            let wave = (bearing as f32 * 0.07).sin() + (bearing as f32 * 0.9).sin() * 0.4;
            polygon.ranges_m[bearing] = 2.0 + wave;
            corners.push(polygon.corner(bearing).unwrap());
        }
        let (mut inside, mut differs) = (0, 0);
        for row in 0..120 {
            for column in 0..120 {
                let point = Point2::new(-1.99 + 0.0503 * column as f32, -3.01 + 0.0502 * row as f32);
                let expected = is_inside(&corners, point);
                inside += u32::from(expected);
                differs += u32::from(polygon.contains(point) != expected);
            }
        }
        // A place on an edge may fall to either side.
        assert!(inside > 2_000 && differs <= 2, "{differs} of {inside}");
    }

    #[test]
    fn wide_gaps_are_not_closed() {
        let mut polygon = SightPolygon { ranges_m: [f32::INFINITY; SIGHT_BEARINGS], gap_max: 4 };
        assert!(!polygon.contains(Point2::new(0.1, 0.0)), "nothing blocks: no polygon");
        polygon.ranges_m[223] = 2.0;
        polygon.ranges_m[228] = 2.0;
        assert!(polygon.contains(Point2::new(1.9, 0.0)) && !polygon.contains(Point2::new(2.1, 0.0)));
        polygon.ranges_m[228] = f32::INFINITY;
        polygon.ranges_m[229] = 2.0;
        assert!(!polygon.contains(Point2::new(1.9, 0.0)));
    }
}
