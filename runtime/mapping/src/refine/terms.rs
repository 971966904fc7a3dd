//! What one pair of scans says about their two poses.

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
    let (sin, cos) = relative.heading_rad.sin_cos();
    let mut sums = Sums {
        first: Matrix3::zeros(),
        second: Matrix3::zeros(),
        mixed: Matrix3::zeros(),
        first_gradient: Vector3::zeros(),
        second_gradient: Vector3::zeros(),
        matched: 0,
        asked: 0,
        squared: 0.0,
    };
    for wall in &views[0].points {
        if wall.normal.x_m == 0.0 && wall.normal.y_m == 0.0 {
            continue;
        }
        sums.asked += 1;
        let place = relative.transform(wall.point);
        let Some(other) = views[1].nearest(place, limits.distance_m) else { continue };
        let normal = other.normal;
        let turned =
            (cos * wall.normal.x_m - sin * wall.normal.y_m, sin * wall.normal.x_m + cos * wall.normal.y_m);
        if (turned.0 * normal.x_m + turned.1 * normal.y_m).abs() < limits.direction_cosine {
            continue;
        }
        sums.matched += 1;
        let (away_x, away_y) =
            (f64::from(place.x_m - other.point.x_m), f64::from(place.y_m - other.point.y_m));
        let (nx, ny) = (f64::from(normal.x_m), f64::from(normal.y_m));
        let error = nx * away_x + ny * away_y;
        let weight = 1.0 / (1.0 + (error / limits.outlier_m).powi(2));
        sums.squared += weight * error * error;
        // In the second scan's frame; turned into the map's below. The lever of the first pose begins at its origin.
        let (px, py) = (f64::from(place.x_m - relative.x_m), f64::from(place.y_m - relative.y_m));
        let first = Vector3::new(nx, ny, ny * px - nx * py);
        // Turning the second scan takes the wall along: the lever is that of the place itself.
        let (qx, qy) = (f64::from(place.x_m), f64::from(place.y_m));
        let second = Vector3::new(-nx, -ny, nx * qy - ny * qx);
        sums.first += first * first.transpose() * weight;
        sums.second += second * second.transpose() * weight;
        sums.mixed += first * second.transpose() * weight;
        sums.first_gradient += first * (error * weight);
        sums.second_gradient += second * (error * weight);
    }
    into_map(&mut sums, poses[1].heading_rad);
    sums
}

fn into_map(sums: &mut Sums, heading_rad: f64) {
    let (sin, cos) = heading_rad.sin_cos();
    let turn = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
    for block in [&mut sums.first, &mut sums.second, &mut sums.mixed] {
        *block = turn * *block * turn.transpose();
    }
    sums.first_gradient = turn * sums.first_gradient;
    sums.second_gradient = turn * sums.second_gradient;
}
