//! Where the robot is and how it moves.

use parry3d::math::{Pose, Rotation, Vector};

/// Robot frame in the world: on the floor in the middle of the rear axle, x forward, y left.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct RobotPose {
    /// Metres.
    pub x_m: f32,
    /// Metres.
    pub y_m: f32,
    /// Counter-clockwise, radians.
    pub heading_rad: f32,
}

/// Speed of the origin of the robot frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct RobotMotion {
    /// Along the robot, m/s; negative in reverse.
    pub forward_mps: f32,
    /// Counter-clockwise, rad/s.
    pub turn_radps: f32,
}

/// The angle within ±π.
pub(crate) fn wrapped(angle_rad: f32) -> f32 {
    let turn = core::f32::consts::TAU;
    let rest = angle_rad - turn * libm::floorf(angle_rad / turn);
    if rest > core::f32::consts::PI { rest - turn } else { rest }
}

impl RobotPose {
    /// As parry wants it.
    pub(crate) fn placed(self) -> Pose {
        let turn = Rotation::from_rotation_z(self.heading_rad);
        Pose::from_parts(Vector::new(self.x_m, self.y_m, 0.0), turn)
    }

    /// A point of the robot in the world, metres.
    #[must_use]
    pub fn point(self, in_robot_m: [f32; 2]) -> [f32; 2] {
        let (sin, cos) = libm::sincosf(self.heading_rad);
        let [x, y] = in_robot_m;
        [self.x_m + cos * x - sin * y, self.y_m + sin * x + cos * y]
    }

    /// A point of the world in the robot, metres.
    #[must_use]
    pub fn in_robot(self, point_m: [f32; 2]) -> [f32; 2] {
        let (sin, cos) = libm::sincosf(self.heading_rad);
        let (dx, dy) = (point_m[0] - self.x_m, point_m[1] - self.y_m);
        [cos * dx + sin * dy, cos * dy - sin * dx]
    }

    /// On the straight way to another pose near by; `share` is 0 here and 1 there.
    #[must_use]
    pub fn between(self, later: Self, share: f32) -> Self {
        Self {
            x_m: self.x_m + share * (later.x_m - self.x_m),
            y_m: self.y_m + share * (later.y_m - self.y_m),
            heading_rad: self.heading_rad + share * wrapped(later.heading_rad - self.heading_rad),
        }
    }

    /// After going on for `seconds` with constant speed and turn rate.
    #[must_use]
    pub fn after(self, motion: RobotMotion, seconds: f32) -> Self {
        let turned_rad = motion.turn_radps * seconds;
        let path_m = motion.forward_mps * seconds;
        // Chord of the arc: sin(a)/a with a = half of the turn.
        let half_rad = turned_rad / 2.0;
        let chord_m = if half_rad.abs() < 1.0e-4 { path_m } else { path_m * libm::sinf(half_rad) / half_rad };
        let (sin, cos) = libm::sincosf(self.heading_rad + half_rad);
        Self {
            x_m: self.x_m + chord_m * cos,
            y_m: self.y_m + chord_m * sin,
            heading_rad: self.heading_rad + turned_rad,
        }
    }

    /// No point of a body of this radius about the origin moves further than this on the way to another pose, metres.
    pub(crate) fn travel_m(self, later: Self, radius_m: f32) -> f32 {
        let turned_rad = wrapped(later.heading_rad - self.heading_rad).abs();
        libm::hypotf(later.x_m - self.x_m, later.y_m - self.y_m) + turned_rad * radius_m
    }
}

impl RobotMotion {
    /// Velocity of a point of the robot, robot frame, m/s.
    #[must_use]
    pub fn at(self, in_robot_m: [f32; 2]) -> [f32; 2] {
        let [x, y] = in_robot_m;
        [self.forward_mps - self.turn_radps * y, self.turn_radps * x]
    }

    /// Speed of a point of the robot, m/s.
    #[must_use]
    pub fn speed_at(self, in_robot_m: [f32; 2]) -> f32 {
        let [x, y] = self.at(in_robot_m);
        libm::hypotf(x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, PI};

    #[test]
    fn a_quarter_circle_ends_where_geometry_says() {
        // v = 1 m/s, ω = 1 rad/s: radius 1 m. After π/2 s the robot is at (1, 1) and looks along y.
        let motion = RobotMotion { forward_mps: 1.0, turn_radps: 1.0 };
        let end = RobotPose::default().after(motion, FRAC_PI_2);
        assert!((end.x_m - 1.0).abs() < 1e-5 && (end.y_m - 1.0).abs() < 1e-5, "{end:?}");
        assert!((end.heading_rad - FRAC_PI_2).abs() < 1e-6);
    }

    #[test]
    fn spinning_robot_moves_its_rear_corner_sideways() {
        let spin = RobotMotion { forward_mps: 0.0, turn_radps: 0.5 };
        let [x_mps, y_mps] = spin.at([-0.4, 0.3]);
        assert!((x_mps + 0.15).abs() < 1e-6 && (y_mps + 0.2).abs() < 1e-6);
        assert!((spin.speed_at([-0.4, 0.3]) - 0.25).abs() < 1e-6);
    }

    #[test]
    fn points_go_to_the_world_and_back() {
        let pose = RobotPose { x_m: 3.0, y_m: -1.0, heading_rad: FRAC_PI_2 };
        let world = pose.point([2.0, 0.5]);
        assert!((world[0] - 2.5).abs() < 1e-6 && (world[1] - 1.0).abs() < 1e-6, "{world:?}");
        let back = pose.in_robot(world);
        assert!((back[0] - 2.0).abs() < 1e-6 && (back[1] - 0.5).abs() < 1e-6);
    }

    #[test]
    fn headings_are_mixed_the_short_way_round() {
        let pose = |heading_rad| RobotPose { heading_rad, ..RobotPose::default() };
        let half = pose(PI - 0.1).between(pose(-PI + 0.1), 0.5);
        assert!((wrapped(half.heading_rad).abs() - PI).abs() < 1e-5, "{half:?}");
        assert!((pose(PI - 0.1).travel_m(pose(-PI + 0.1), 2.0) - 0.4).abs() < 1e-5);
    }
}
