//! How much of the path is left from a place.

use floorguard_types::geometry::{Point2, wrap_angle};
use floorguard_types::motion::{Gear, Waypoint};
use floorguard_types::number::{nearest_f32, saturating_usize};

/// Points of the path that are kept: 8 m at 8 cm.
const POINTS_MAX: usize = 100;
const SPACING_M: f32 = 0.08;

#[derive(Clone, Copy, Debug, Default)]
struct PathPoint {
    place: Point2,
    heading_rad: f32,
    left_m: f32,
}

/// The path ahead of the robot as evenly spaced points.
pub(super) struct PathLeft {
    points: heapless::Vec<PathPoint, POINTS_MAX>,
}

/// What is left from a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Left {
    /// Along the path from the nearest point to the last one kept, metres.
    pub(super) along_m: f32,
    /// To the nearest point, metres.
    pub(super) off_m: f32,
    /// From the heading of the path there, radians, ≥ 0.
    pub(super) turn_rad: f32,
}

impl PathLeft {
    /// From the point of the path that is nearest to the robot. `None`: there is no path.
    pub(super) fn new(path: &[Waypoint], here: Point2) -> Option<Self> {
        let distance_m = |at: &Waypoint| at.place_in_map().distance(here);
        let nearest = path.iter().enumerate().min_by(|a, b| distance_m(a.1).total_cmp(&distance_m(b.1)))?.0;
        let rest = path.get(nearest..).unwrap_or(&[]);
        let mut points: heapless::Vec<PathPoint, POINTS_MAX> = heapless::Vec::new();
        let mut before = rest.first()?.place_in_map();
        let _ = points.push(PathPoint {
            place: before,
            heading_rad: rest.first()?.pose_in_map.heading_rad,
            left_m: 0.0,
        });
        for at in rest.iter().skip(1) {
            let place = at.place_in_map();
            let length_m = before.distance(place);
            let pieces = saturating_usize(libm::ceilf(length_m / SPACING_M)).clamp(1, POINTS_MAX);
            let (dx_m, dy_m) = (place.x_m - before.x_m, place.y_m - before.y_m);
            let along_rad = libm::atan2f(dy_m, dx_m);
            let heading_rad = match at.gear {
                Gear::Ahead if length_m > 1.0e-3 => along_rad,
                _ => at.pose_in_map.heading_rad,
            };
            for piece in 1..=pieces {
                let t = nearest_f32(piece) / nearest_f32(pieces);
                let place = Point2::new(before.x_m + t * dx_m, before.y_m + t * dy_m);
                if points.push(PathPoint { place, heading_rad, left_m: 0.0 }).is_err() {
                    break;
                }
            }
            before = place;
        }
        let (mut left_m, mut after) = (0.0, points.last()?.place);
        for point in points.iter_mut().rev() {
            left_m += point.place.distance(after);
            point.left_m = left_m;
            after = point.place;
        }
        Some(Self { points })
    }

    /// What is left from a pose.
    pub(super) fn from(&self, place: Point2, heading_rad: f32) -> Left {
        let squared = |point: &PathPoint| {
            let (dx, dy) = (point.place.x_m - place.x_m, point.place.y_m - place.y_m);
            dx * dx + dy * dy
        };
        let mut best = (f32::INFINITY, PathPoint::default());
        for point in &self.points {
            let distance_m2 = squared(point);
            if distance_m2 < best.0 {
                best = (distance_m2, *point);
            }
        }
        let (distance_m2, point) = best;
        Left {
            along_m: point.left_m,
            off_m: libm::sqrtf(distance_m2),
            turn_rad: libm::fabsf(wrap_angle(heading_rad - point.heading_rad)),
        }
    }
}
