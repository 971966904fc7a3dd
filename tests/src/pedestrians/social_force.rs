//! Forces between pedestrians as published: Helbing and Molnár, "Social force model for pedestrian dynamics", Physical Review E 51,
//! 4282 (1995), equations 2 to 11 and the parameters of its section III.
//!
//! Left out: walls, because the recordings name none, and attraction within groups. A robot repels as a pedestrian does, whose step
//! ahead is kept free, and its body as a wall does: pedestrians of 1995 have no bodies, and would walk up to its edge.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::Footprint;

/// Relaxation time τ, seconds.
pub const RELAX_S: f32 = 0.5;
/// Greatest speed, times the desired one.
pub const SPEED_MAX: f32 = 1.3;
/// Strength V⁰, m²/s², and reach σ, metres, of the repulsion.
const STRENGTH_M2PS2: f32 = 2.1;
const REACH_M: f32 = 0.3;
/// The same of walls, U⁰ and R.
const WALL_M2PS2: f32 = 10.0;
const WALL_REACH_M: f32 = 0.2;
/// The other's step Δt that is kept free, seconds.
const STEP_S: f32 = 2.0;
/// What is behind counts this much; ahead is within 100° to either side.
const BEHIND: f32 = 0.5;
const SIGHT_RAD: f32 = 100.0 * core::f32::consts::PI / 180.0;
/// Farther away nothing is felt, metres: the force is below a ten-thousandth of the strongest even with the step.
const FELT_M: f32 = 6.0;
/// Half the breadth of a pedestrian, metres.
const BODY_M: f32 = 0.3;

/// Somebody who repels others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repellent {
    /// Middle.
    pub place: Point2,
    /// m/s.
    pub velocity: Point2,
}

/// The push of another on somebody at a place who walks in a direction (a unit vector, or zero), m/s² (equations 3, 4, 8 and 9).
#[must_use]
pub fn repulsion(place: Point2, direction: Point2, other: &Repellent) -> Point2 {
    let away = Point2::new(place.x_m - other.place.x_m, place.y_m - other.place.y_m);
    let distance_m = away.norm();
    if !(1.0e-3..FELT_M).contains(&distance_m) {
        return Point2::default();
    }
    let step = Point2::new(STEP_S * other.velocity.x_m, STEP_S * other.velocity.y_m);
    let past = Point2::new(away.x_m - step.x_m, away.y_m - step.y_m);
    let past_m = past.norm().max(1.0e-3);
    let sum_m = distance_m + past_m;
    // Half the small axis of the ellipse around both ends of the step.
    let half_m = 0.5 * libm::sqrtf((sum_m * sum_m - step.norm() * step.norm()).max(1.0e-4));
    let strength = STRENGTH_M2PS2 / REACH_M * libm::expf(-half_m / REACH_M);
    let slope = sum_m / (4.0 * half_m);
    let push = Point2::new(
        strength * slope * (away.x_m / distance_m + past.x_m / past_m),
        strength * slope * (away.y_m / distance_m + past.y_m / past_m),
    );
    // Who pushes from ahead is seen: the direction of the force is against the direction of the look.
    let ahead = -(push.x_m * direction.x_m + push.y_m * direction.y_m);
    let sight = if ahead >= push.norm() * libm::cosf(SIGHT_RAD) { 1.0 } else { BEHIND };
    Point2::new(sight * push.x_m, sight * push.y_m)
}

/// The push of a robot, m/s²: as far as its outline is, but in the direction of its middle. Pushed from the nearest point of a flat
/// side, who walks straight at it would stand there for as long as it does.
#[must_use]
pub fn robot_repulsion(
    (place, direction): (Point2, Point2),
    (outline, pose): (&Footprint, Pose2),
    velocity: Point2,
) -> Point2 {
    let corners = outline.corners_in_base();
    let count = corners.len() as f32;
    let sum = |of: fn(&Point2) -> f32| corners.iter().map(of).sum::<f32>() / count;
    let middle = pose.transform(Point2::new(sum(|corner| corner.x_m), sum(|corner| corner.y_m)));
    let gap_m = outline.clearance_m(pose, place);
    let (dx_m, dy_m) = (place.x_m - middle.x_m, place.y_m - middle.y_m);
    let away_m = libm::hypotf(dx_m, dy_m).max(1.0e-3);
    let (ux, uy) = (dx_m / away_m, dy_m / away_m);
    let inside_m = gap_m + BODY_M;
    let as_pedestrian =
        Repellent { place: Point2::new(place.x_m - inside_m * ux, place.y_m - inside_m * uy), velocity };
    let push = repulsion(place, direction, &as_pedestrian);
    // Equation 5.
    let wall = WALL_M2PS2 / WALL_REACH_M * libm::expf(-gap_m / WALL_REACH_M);
    Point2::new(push.x_m + wall * ux, push.y_m + wall * uy)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Standing: the ellipse is a circle, and the push V⁰/σ·exp(−r/σ).
    #[test]
    fn standing_people_push_by_the_published_law() {
        let other = Repellent { place: Point2::default(), velocity: Point2::default() };
        let push = repulsion(Point2::new(0.9, 0.0), Point2::new(-1.0, 0.0), &other);
        assert!((push.x_m - 7.0 * (-3.0_f32).exp()).abs() < 1e-4 && push.y_m.abs() < 1e-6, "{push:?}");
        let behind = repulsion(Point2::new(0.9, 0.0), Point2::new(1.0, 0.0), &other);
        assert!((behind.x_m - 0.5 * push.x_m).abs() < 1e-5);
    }

    /// The numerical gradient of the potential of a walking person.
    #[test]
    fn walking_people_push_along_the_gradient() {
        let velocity = Point2::new(0.7, 0.3);
        let other = Repellent { place: Point2::new(1.0, 2.0), velocity };
        let potential = |x: f32, y: f32| {
            let (r, s) = ((x - 1.0).hypot(y - 2.0), (x - 1.0 - 1.4).hypot(y - 2.0 - 0.6));
            2.1 * (-0.5 * ((r + s).powi(2) - velocity.norm().powi(2) * 4.0).sqrt() / 0.3).exp()
        };
        let (x, y, h) = (2.1_f32, 2.9_f32, 2.0e-3_f32);
        let push = repulsion(Point2::new(x, y), Point2::default(), &other);
        let slope = (
            (potential(x + h, y) - potential(x - h, y)) / (2.0 * h),
            (potential(x, y + h) - potential(x, y - h)) / (2.0 * h),
        );
        let sight = push.norm() / slope.0.hypot(slope.1);
        assert!((sight - 1.0).abs() < 0.02, "{push:?} {slope:?}");
        assert!((push.x_m + slope.0).abs() < 0.02 && (push.y_m + slope.1).abs() < 0.02, "{push:?} {slope:?}");
    }
}
