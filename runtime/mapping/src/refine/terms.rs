//! What one pair of scans says about their two poses.

use floorguard_types::geometry::Point2;
use nalgebra::{Matrix3, Vector3};

use super::scan_view::ScanView;
use crate::pose_graph::PairTerms;
use crate::se2::Se2;

/// What counts as the same wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchLimits {
    /// Farther points are not the same place, metres.
    pub distance_m: f32,
    /// Distance across the wall at which a pair of points counts half, metres (Cauchy's weight).
    pub outlier_m: f64,
    /// Cosine between the walls' directions, at least.
    pub direction_cosine: f32,
    /// Of each scan every so manyth point is asked; the terms are those of all.
    pub stride: usize,
}

/// The terms of a pair, and how well it fits.
#[derive(Clone, Copy, Debug)]
pub struct PairMatch {
    /// For poses measured along x, y and heading in the map.
    pub terms: PairTerms,
    /// Points that found a partner.
    pub matched: usize,
    /// Points that were asked.
    pub asked: usize,
    /// Sum of the weighed squared distances, square metres.
    pub squared_m2: f64,
}

struct Sums {
    first: Matrix3<f64>,
    second: Matrix3<f64>,
    mixed: Matrix3<f64>,
    first_gradient: Vector3<f64>,
    second_gradient: Vector3<f64>,
    matched: usize,
    asked: usize,
    squared: f64,
}

/// Sums over the pairs of points. Both poses push along the wall's normal, each with its own lever: of the three matrices
/// and two vectors, only these numbers differ.
#[derive(Default)]
struct NormalSums {
    xx: f64,
    xy: f64,
    yy: f64,
    /// Normal times the levers, and the levers among themselves.
    first_x: f64,
    first_y: f64,
    second_x: f64,
    second_y: f64,
    first_first: f64,
    second_second: f64,
    first_second: f64,
    /// All four times the error.
    error_x: f64,
    error_y: f64,
    error_first: f64,
    error_second: f64,
}

/// One pair of points.
struct Pull {
    normal: [f64; 2],
    /// Change of the error with the heading of the first pose, and of the second.
    levers: [f64; 2],
    error: f64,
    weight: f64,
}

impl NormalSums {
    #[inline]
    fn add(&mut self, pull: &Pull) {
        let ([x, y], [first, second], weight) = (pull.normal, pull.levers, pull.weight);
        self.xx += x * x * weight;
        self.xy += x * y * weight;
        self.yy += y * y * weight;
        self.first_x += x * first * weight;
        self.first_y += y * first * weight;
        self.second_x += x * second * weight;
        self.second_y += y * second * weight;
        self.first_first += first * first * weight;
        self.second_second += second * second * weight;
        self.first_second += first * second * weight;
        let error = pull.error * weight;
        self.error_x += x * error;
        self.error_y += y * error;
        self.error_first += first * error;
        self.error_second += second * error;
    }

    /// The second pose is pushed against the normal.
    fn sums(&self) -> Sums {
        let Self { xx, xy, yy, first_x, first_y, second_x, second_y, .. } = *self;
        Sums {
            first: Matrix3::new(xx, xy, first_x, xy, yy, first_y, first_x, first_y, self.first_first),
            second: Matrix3::new(
                xx,
                xy,
                -second_x,
                xy,
                yy,
                -second_y,
                -second_x,
                -second_y,
                self.second_second,
            ),
            mixed: Matrix3::new(
                -xx,
                -xy,
                second_x,
                -xy,
                -yy,
                second_y,
                -first_x,
                -first_y,
                self.first_second,
            ),
            first_gradient: Vector3::new(self.error_x, self.error_y, self.error_first),
            second_gradient: Vector3::new(-self.error_x, -self.error_y, self.error_second),
            matched: 0,
            asked: 0,
            squared: 0.0,
        }
    }
}

/// Compares two scans, each against the walls of the other.
#[must_use]
pub fn match_pair(views: [&ScanView; 2], poses: [Se2; 2], limits: &MatchLimits) -> PairMatch {
    let mut there = one_way(views, poses, limits);
    let back = one_way([views[1], views[0]], [poses[1], poses[0]], limits);
    there.first += back.second;
    there.second += back.first;
    there.mixed += back.mixed.transpose();
    there.first_gradient += back.second_gradient;
    there.second_gradient += back.first_gradient;
    PairMatch {
        terms: PairTerms {
            first: there.first,
            second: there.second,
            mixed: there.mixed,
            first_gradient: there.first_gradient,
            second_gradient: there.second_gradient,
        },
        matched: there.matched + back.matched,
        asked: there.asked + back.asked,
        squared_m2: there.squared + back.squared,
    }
}

/// Points of the first scan against the walls of the second.
fn one_way(views: [&ScanView; 2], poses: [Se2; 2], limits: &MatchLimits) -> Sums {
    let relative = poses[1].between(poses[0]).single();
    let (sin, cos) = libm::sincosf(relative.heading_rad);
    let mut sums = NormalSums::default();
    let (mut matched, mut asked, mut squared) = (0, 0, 0.0);
    for wall in views[0].points.iter().step_by(limits.stride.max(1)) {
        if wall.normal.x_m == 0.0 && wall.normal.y_m == 0.0 {
            continue;
        }
        asked += 1;
        let turned = |v: Point2| Point2::new(cos * v.x_m - sin * v.y_m, sin * v.x_m + cos * v.y_m);
        let arm = turned(wall.point);
        let place = Point2::new(relative.x_m + arm.x_m, relative.y_m + arm.y_m);
        let Some(other) = views[1].in_direction(place, limits.distance_m) else { continue };
        let (normal, direction) = (other.normal, turned(wall.normal));
        let cosine = direction.x_m * normal.x_m + direction.y_m * normal.y_m;
        // Both sides of a thin wall look alike, and lie apart.
        if cosine < limits.direction_cosine {
            continue;
        }
        matched += 1;
        let (away_x, away_y) =
            (f64::from(place.x_m - other.point.x_m), f64::from(place.y_m - other.point.y_m));
        let (nx, ny) = (f64::from(normal.x_m), f64::from(normal.y_m));
        let error = nx * away_x + ny * away_y;
        let outliers = error / limits.outlier_m;
        let weight = 1.0 / (1.0 + outliers * outliers);
        squared += weight * error * error;
        // In the second scan's frame; turned into the map's below. The lever of the first pose begins at its origin.
        let (px, py) = (f64::from(place.x_m - relative.x_m), f64::from(place.y_m - relative.y_m));
        // Turning the second scan takes the wall along: the lever is that of the place itself.
        let (qx, qy) = (f64::from(place.x_m), f64::from(place.y_m));
        let levers = [ny * px - nx * py, nx * qy - ny * qx];
        sums.add(&Pull { normal: [nx, ny], levers, error, weight });
    }
    let mut sums = Sums { matched, asked, squared, ..sums.sums() };
    into_map(&mut sums, poses[1].heading_rad);
    sums
}

fn into_map(sums: &mut Sums, heading_rad: f64) {
    let (sin, cos) = libm::sincos(heading_rad);
    let turn = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
    for block in [&mut sums.first, &mut sums.second, &mut sums.mixed] {
        *block = turn * *block * turn.transpose();
    }
    sums.first_gradient = turn * sums.first_gradient;
    sums.second_gradient = turn * sums.second_gradient;
}
