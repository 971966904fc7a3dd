//! Where on a path the robot is, and the point ahead of it.

use floorguard_types::geometry::Point2;
use floorguard_types::motion::Waypoint;

/// Legs that may be reached from one moment to the next: a path may cross itself.
const LEGS_AHEAD: usize = 5;
/// And no leg that begins farther along the path than this from the nearest point of the first, metres: what comes back
/// beside itself is driven to its end.
const LOOK_AHEAD_M: f32 = 1.5;

/// The nearest point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Leg, from 0: from waypoint `leg` to the next one.
    pub leg: usize,
    /// Metres along that leg; on the last one it may lie beyond the end.
    pub along_m: f32,
    /// From there to the end of the path, metres; negative beyond the end.
    pub left_m: f32,
    /// From the robot to there, metres.
    pub off_m: f32,
}

/// The nearest point to a place on the legs from `leg_before` on; `None`: fewer than two waypoints.
#[must_use]
pub fn foot(path: &[Waypoint], place: Point2, leg_before: usize) -> Option<Foot> {
    let legs = path.len().checked_sub(1).filter(|&legs| legs > 0)?;
    let length_m = |leg: &[Waypoint]| match leg {
        [a, b] => a.place_in_map().distance(b.place_in_map()),
        _ => 0.0,
    };
    let mut left_m: f32 = path.windows(2).map(length_m).sum();
    left_m = path.windows(2).take(leg_before).fold(left_m, |left_m, leg| left_m - length_m(leg));
    let mut best: Option<Foot> = None;
    let mut last_look_m = f32::NEG_INFINITY;
    for (leg, ends) in path.windows(2).enumerate().skip(leg_before).take(LEGS_AHEAD) {
        let [from, to] = ends else { continue };
        let (from, to) = (from.place_in_map(), to.place_in_map());
        let whole_m = length_m(ends);
        if left_m < last_look_m {
            break;
        }
        let (ux, uy) = ((to.x_m - from.x_m) / whole_m.max(1.0e-6), (to.y_m - from.y_m) / whole_m.max(1.0e-6));
        let along_m = (place.x_m - from.x_m) * ux + (place.y_m - from.y_m) * uy;
        let is_last = leg.saturating_add(1) == legs;
        let along_m = along_m.clamp(0.0, if is_last { f32::MAX } else { whole_m });
        let off_m = place.distance(Point2::new(from.x_m + along_m * ux, from.y_m + along_m * uy));
        if best.is_none_or(|best| off_m <= best.off_m) {
            best = Some(Foot { leg, along_m, left_m: left_m - along_m, off_m });
        }
        if leg == leg_before {
            last_look_m = left_m - along_m - LOOK_AHEAD_M;
        }
        left_m -= whole_m;
    }
    best
}

/// The point of the path so far ahead of the foot; beyond the end the last leg goes on straight.
#[must_use]
pub fn aim(path: &[Waypoint], foot: &Foot, ahead_m: f32) -> Option<Point2> {
    let mut ahead_m = foot.along_m + ahead_m;
    let legs = path.len().saturating_sub(1);
    for (leg, ends) in path.windows(2).enumerate().skip(foot.leg) {
        let [from, to] = ends else { continue };
        let (from, to) = (from.place_in_map(), to.place_in_map());
        let length_m = from.distance(to);
        if ahead_m <= length_m || leg.saturating_add(1) == legs {
            let t = ahead_m / length_m.max(1.0e-6);
            return Some(Point2::new(from.x_m + t * (to.x_m - from.x_m), from.y_m + t * (to.y_m - from.y_m)));
        }
        ahead_m -= length_m;
    }
    None
}
