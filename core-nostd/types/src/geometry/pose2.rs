//! Poses, points and velocities on the floor.

use super::wrap_angle;

/// A point on the floor, metres, in the frame that the name of the variable gives.
///
/// ```
/// use floorguard_types::geometry::Point2;
///
/// let door = Point2::new(3.0, 4.0);
/// assert_eq!(door.norm(), 5.0);
/// assert_eq!(door.distance(Point2::new(3.0, 1.0)), 3.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Point2 {
    /// Forward or east, metres.
    pub x_m: f32,
    /// Left or north, metres.
    pub y_m: f32,
}

impl Point2 {
    /// A point from its coordinates in metres.
    #[must_use]
    pub const fn new(x_m: f32, y_m: f32) -> Self {
        Self { x_m, y_m }
    }

    /// Distance from the origin, metres.
    #[must_use]
    pub fn norm(self) -> f32 {
        libm::sqrtf(self.x_m * self.x_m + self.y_m * self.y_m)
    }

    /// Distance to another point of the same frame, metres.
    #[must_use]
    pub fn distance(self, other: Self) -> f32 {
        Self::new(self.x_m - other.x_m, self.y_m - other.y_m).norm()
    }
}

/// Where a frame stands in another one, on the floor. Invariant: `heading_rad` within [−π, π).
///
/// ```
/// use floorguard_types::geometry::{Point2, Pose2};
///
/// // The robot stands at (2, 1) and looks along y; a scanner half a metre before it sees a wall 3 m ahead.
/// let robot_in_map = Pose2::new(2.0, 1.0, core::f32::consts::FRAC_PI_2);
/// let scanner_in_robot = Pose2::new(0.5, 0.0, 0.0);
/// let wall = robot_in_map.compose(scanner_in_robot).transform(Point2::new(3.0, 0.0));
/// assert!(wall.distance(Point2::new(2.0, 4.5)) < 1.0e-6);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pose2 {
    /// Metres along x.
    pub x_m: f32,
    /// Metres along y.
    pub y_m: f32,
    /// Counter-clockwise from x, radians.
    pub heading_rad: f32,
}

impl Pose2 {
    /// A pose; the heading is wrapped.
    #[must_use]
    pub fn new(x_m: f32, y_m: f32, heading_rad: f32) -> Self {
        Self { x_m, y_m, heading_rad: wrap_angle(heading_rad) }
    }

    /// `self` followed by `inner`: the pose of `inner`'s frame seen from where `self` is expressed.
    #[must_use]
    pub fn compose(self, inner: Self) -> Self {
        let origin = self.transform(Point2::new(inner.x_m, inner.y_m));
        Self::new(origin.x_m, origin.y_m, self.heading_rad + inner.heading_rad)
    }

    /// The pose that undoes this one.
    ///
    /// ```
    /// use floorguard_types::geometry::Pose2;
    ///
    /// let pose = Pose2::new(1.0, -2.0, 0.7);
    /// let nothing = pose.compose(pose.inverse());
    /// assert!(nothing.x_m.abs() < 1.0e-6 && nothing.y_m.abs() < 1.0e-6 && nothing.heading_rad.abs() < 1.0e-6);
    /// ```
    #[must_use]
    pub fn inverse(self) -> Self {
        let (sin, cos) = libm::sincosf(self.heading_rad);
        Self::new(-(cos * self.x_m + sin * self.y_m), sin * self.x_m - cos * self.y_m, -self.heading_rad)
    }

    /// A point of this frame, expressed in the outer one.
    #[must_use]
    pub fn transform(self, point: Point2) -> Point2 {
        let (sin, cos) = libm::sincosf(self.heading_rad);
        Point2::new(
            self.x_m + cos * point.x_m - sin * point.y_m,
            self.y_m + sin * point.x_m + cos * point.y_m,
        )
    }
}

/// Velocity of a body on the floor, in its own frame.
///
/// ```
/// use floorguard_types::geometry::Twist2;
///
/// assert!(Twist2 { linear_mps: 0.5, angular_radps: -0.2 }.is_finite());
/// assert!(!Twist2 { linear_mps: f32::NAN, ..Twist2::ZERO }.is_finite());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Twist2 {
    /// Forward speed, m/s; negative backwards.
    pub linear_mps: f32,
    /// Turning rate, rad/s, counter-clockwise.
    pub angular_radps: f32,
}

impl Twist2 {
    /// Standing still.
    pub const ZERO: Self = Self { linear_mps: 0.0, angular_radps: 0.0 };

    /// Forward on an arc of a curvature (1/m, left positive), at most at `speed_mps` ≥ 0 and so slowly that the robot turns no
    /// faster than `turn_max_radps` ≥ 0: the command of pure pursuit, whose arc through a point (x, y) at the distance L has
    /// the curvature 2·y/L² (Coulter 1992).
    ///
    /// ```
    /// use floorguard_types::geometry::Twist2;
    ///
    /// assert_eq!(Twist2::on_arc(0.5, 1.0, 2.0), Twist2 { linear_mps: 1.0, angular_radps: 0.5 });
    /// assert_eq!(Twist2::on_arc(-2.0, 1.0, 0.5), Twist2 { linear_mps: 0.25, angular_radps: -0.5 });
    /// ```
    #[must_use]
    pub fn on_arc(curvature_per_m: f32, speed_mps: f32, turn_max_radps: f32) -> Self {
        let linear_mps = speed_mps.min(turn_max_radps / libm::fabsf(curvature_per_m).max(1.0e-3));
        Self { linear_mps, angular_radps: linear_mps * curvature_per_m }
    }

    /// Both numbers are finite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.linear_mps.is_finite() && self.angular_radps.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_undoes_compose() {
        let a = Pose2::new(1.0, -2.0, 0.7);
        let b = a.compose(a.inverse());
        assert!(b.x_m.abs() < 1e-6 && b.y_m.abs() < 1e-6 && b.heading_rad.abs() < 1e-6);
    }

    #[test]
    fn quarter_turn_maps_forward_to_left() {
        let p = Pose2::new(10.0, 0.0, core::f32::consts::FRAC_PI_2).transform(Point2::new(2.0, 0.0));
        assert!((p.x_m - 10.0).abs() < 1e-6 && (p.y_m - 2.0).abs() < 1e-6);
    }
}
