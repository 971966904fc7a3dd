//! Fields that nobody draws: the outline of the body over all places from which it stands, from geometry and limits alone.
//!
//! What the tables of scanner and lidar hold for driving straight and backwards, and what a field that a user draws
//! must contain (FG-REQ-061). Eight half-planes around all corners of the body along the arc: more than the sweep,
//! never less. Motions between these directions are examined one by one, along their own arc (`sweep`).

use super::config::{DriveLimits, Travel};
use super::field::{Polygon, point_in_polygon};
use super::sweep::{REACTION_S, STANDOFF_M, Stopping, Sweep};
use floorguard_types::geometry::{Point2, Twist2};

/// The robot may be this much faster than its limit before that is a fault of its own.
pub const OVERSPEED_SHARE: f32 = 1.1;
/// A bend begins at this curvature, 1/m.
pub const BEND_PER_M: f32 = 0.3;
/// Kept beside the body, metres: less than the margin that the sweep of each motion keeps, because a bin of the lidar's
/// table widens the field by up to 8 % of its half width.
const BESIDE_M: f32 = 0.02;
/// More of it for each m/s: an arc that is not quite straight.
const BESIDE_S: f32 = 0.05;
/// A warning field is this much longer than the protective one, and this much more, metres.
const WARNING_SHARE: f32 = 1.5;
const WARNING_MORE_M: f32 = 0.3;
/// Beside the body it ends here, metres.
const WARNING_BESIDE_M: f32 = 0.2;
/// Corners nearer to each other are one, metres.
const SAME_CORNER_M: f32 = 1.0e-3;
/// Points this near to an edge lie on it, metres.
const ON_THE_EDGE_M: f32 = 2.0e-3;
/// Half of the square root of two.
const HALF_ROOT: f32 = core::f32::consts::FRAC_1_SQRT_2;
/// Outward directions of the half-planes, counter-clockwise.
const DIRECTIONS: [Point2; 8] = [
    Point2::new(1.0, 0.0),
    Point2::new(HALF_ROOT, HALF_ROOT),
    Point2::new(0.0, 1.0),
    Point2::new(-HALF_ROOT, HALF_ROOT),
    Point2::new(-1.0, 0.0),
    Point2::new(-HALF_ROOT, -HALF_ROOT),
    Point2::new(0.0, -1.0),
    Point2::new(HALF_ROOT, -HALF_ROOT),
];

/// Which field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zone {
    /// Something inside: stop.
    Protective,
    /// Something inside: slow down.
    Warning,
}

/// The field of a direction up to a speed, m/s, in the robot frame. For [`Travel::Spin`] the speed says nothing: the drive's
/// greatest turning rate counts.
#[must_use]
pub fn swept_outline(
    footprint: &[Point2],
    drive: &DriveLimits,
    (travel, speed_mps): (Travel, f32),
    zone: Zone,
) -> Polygon {
    let speed_mps = speed_mps.min(OVERSPEED_SHARE * drive.speed_mps);
    let beside_m = match zone {
        Zone::Protective => BESIDE_M + BESIDE_S * speed_mps,
        Zone::Warning => WARNING_BESIDE_M,
    };
    let mut reach_m = [f32::NEG_INFINITY; DIRECTIONS.len()];
    for twist in twists_of(travel, speed_mps, drive).into_iter().flatten() {
        let stops_m = Stopping::from(footprint, twist, (drive, REACTION_S)).path_m() + STANDOFF_M;
        let path_m = if zone == Zone::Warning { WARNING_SHARE * stops_m + WARNING_MORE_M } else { stops_m };
        let Some(sweep) = Sweep::along(footprint, twist, path_m) else { continue };
        sweep.for_each_corner(|corner| {
            for (reach_m, direction) in reach_m.iter_mut().zip(DIRECTIONS) {
                // Ahead and behind the way itself is the margin, unless the body turns.
                let turns = if twist.angular_radps == 0.0 { 0.0 } else { direction.x_m.abs() };
                let more_m = beside_m * (direction.y_m.abs() + turns);
                *reach_m = reach_m.max(corner.x_m * direction.x_m + corner.y_m * direction.y_m + more_m);
            }
        });
    }
    corners(&reach_m)
}

/// A polygon contains an outline, hairs of the edge apart.
#[must_use]
pub fn contains(polygon: &[Point2], outline: &[Point2]) -> bool {
    let holds = |corner: &Point2| {
        point_in_polygon(*corner, polygon) || super::signed_distance_m(polygon, *corner) < ON_THE_EDGE_M
    };
    // A corner of the field well within the outline is a notch in the field.
    let is_notch = |corner: &Point2| super::signed_distance_m(outline, *corner) < -ON_THE_EDGE_M;
    outline.iter().all(holds) && !polygon.iter().any(is_notch)
}

/// The motions that a direction stands for: its ends.
fn twists_of(travel: Travel, speed_mps: f32, drive: &DriveLimits) -> [Option<Twist2>; 2] {
    let twist = |linear_mps: f32, angular_radps: f32| Some(Twist2 { linear_mps, angular_radps });
    let gentle_radps = (BEND_PER_M * speed_mps).min(drive.turn_radps);
    match travel {
        Travel::Straight => [twist(speed_mps, 0.0), None],
        Travel::Reverse => [twist(-speed_mps, 0.0), None],
        Travel::Left => [twist(speed_mps, gentle_radps), twist(speed_mps, drive.turn_radps)],
        Travel::Right => [twist(speed_mps, -gentle_radps), twist(speed_mps, -drive.turn_radps)],
        Travel::Spin => [twist(0.0, drive.turn_radps), twist(0.0, -drive.turn_radps)],
    }
}

/// Where neighbouring half-planes meet.
fn corners(reach_m: &[f32; DIRECTIONS.len()]) -> Polygon {
    let mut polygon = Polygon::new();
    let sides = || DIRECTIONS.iter().zip(reach_m);
    for ((one, one_m), (next, next_m)) in sides().zip(sides().skip(1).chain(sides().take(1))) {
        let x_m = (one_m * next.y_m - next_m * one.y_m) / HALF_ROOT;
        let y_m = (one.x_m * next_m - next.x_m * one_m) / HALF_ROOT;
        let corner = Point2::new(x_m, y_m);
        if polygon.iter().all(|other| other.distance(corner) > SAME_CORNER_M) && corner.norm().is_finite() {
            // Eight corners: they fit.
            let _ = polygon.push(corner);
        }
    }
    polygon
}
