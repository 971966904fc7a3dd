//! The footprint that the guard needs to be clear before the robot may start: its slowest protective fields as discs
//! along its axis.
//!
//! A field is a rectangle; discs that cover it need one lookup each in a distance field, whatever the robot's
//! heading.

use floorguard_runtime::configuration::{DirectionOfTravel, RobotConfiguration};
use floorguard_types::geometry::{Point2, Pose2};

/// Discs along the axis.
pub const DISCS: usize = 3;
/// Kept beyond the field, metres: the error of pose, map and scanner.
const MARGIN_M: f32 = 0.06;

/// Discs that cover a rectangle around the robot's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootprintDiscs {
    /// Middles, metres ahead of the rear axle.
    pub middles_m: [f32; DISCS],
    /// Radius of each, metres.
    pub radius_m: f32,
}

impl FootprintDiscs {
    fn covering((rear_m, front_m): (f32, f32), half_width_m: f32) -> Self {
        let half_m = (front_m - rear_m) / (2.0 * DISCS as f32);
        let middles_m = [0, 1, 2].map(|disc| rear_m + half_m * (2 * disc + 1) as f32);
        Self { middles_m, radius_m: libm::hypotf(half_m, half_width_m) }
    }

    /// Middles of the discs of a robot at a pose, from rear to front.
    pub fn places(&self, pose: Pose2) -> [Point2; DISCS] {
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        self.middles_m.map(|ahead_m| Point2::new(pose.x_m + ahead_m * cos, pose.y_m + ahead_m * sin))
    }
}

/// Footprint discs for driving forward or turning, and backwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Forward and on the spot.
    pub ahead: FootprintDiscs,
    /// Backwards.
    pub back: FootprintDiscs,
}

impl Body {
    /// Of a robot: its footprint and its slowest protective field in each direction.
    pub fn of(robot: &RobotConfiguration) -> Self {
        let discs = |direction| {
            let slowest = robot
                .fields
                .iter()
                .filter(|pair| pair.direction == direction)
                .min_by(|a, b| a.speed_max_mps.total_cmp(&b.speed_max_mps));
            let field = slowest.into_iter().flat_map(|pair| pair.protective.iter());
            let (mut rear_m, mut front_m, mut half_m) = (0.0_f32, 0.0_f32, 0.0_f32);
            for corner in robot.geometry.footprint.iter().chain(field) {
                rear_m = rear_m.min(corner.x_m);
                front_m = front_m.max(corner.x_m);
                half_m = half_m.max(corner.y_m.abs());
            }
            FootprintDiscs::covering((rear_m - MARGIN_M, front_m + MARGIN_M), half_m + MARGIN_M)
        };
        Self { ahead: discs(DirectionOfTravel::Forward), back: discs(DirectionOfTravel::Reverse) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_configuration::{EXAMPLE, parse};

    #[test]
    fn the_discs_cover_the_slowest_fields() {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let body = Body::of(&robot);
        for (discs, direction) in
            [(body.ahead, DirectionOfTravel::Forward), (body.back, DirectionOfTravel::Reverse)]
        {
            let slowest = robot.fields.iter().find(|pair| pair.direction == direction).unwrap();
            for corner in slowest.protective.iter().chain(&robot.geometry.footprint) {
                let nearest = discs.middles_m.iter().map(|x| corner.distance(Point2::new(*x, 0.0)));
                assert!(nearest.fold(f32::MAX, f32::min) < discs.radius_m, "{direction:?} {corner:?}");
            }
            assert!(discs.radius_m < 0.75, "{discs:?}");
        }
    }
}
