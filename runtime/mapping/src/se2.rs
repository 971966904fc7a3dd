//! Poses in double precision: a building is large, and a graph sums over thousands of them.

use floorguard_types::geometry::{Point2, Pose2};

/// Where a frame stands in another one. Invariant: `heading_rad` within [−π, π).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Se2 {
    /// Metres along x.
    pub x_m: f64,
    /// Metres along y.
    pub y_m: f64,
    /// Counter-clockwise from x, radians.
    pub heading_rad: f64,
}

/// The angle within [−π, π).
#[must_use]
pub fn wrap(angle_rad: f64) -> f64 {
    let turn = core::f64::consts::TAU;
    angle_rad - turn * ((angle_rad + core::f64::consts::PI) / turn).floor()
}

/// Length of a vector within a map; not by `hypot`, which differs from one standard library to another.
fn length_m([x_m, y_m]: [f64; 2]) -> f64 {
    (x_m * x_m + y_m * y_m).sqrt()
}

impl Se2 {
    /// A pose; the heading is wrapped.
    #[must_use]
    pub fn new(x_m: f64, y_m: f64, heading_rad: f64) -> Self {
        Self { x_m, y_m, heading_rad: wrap(heading_rad) }
    }

    /// `self` followed by `inner`.
    #[must_use]
    pub fn compose(self, inner: Self) -> Self {
        let (sin, cos) = libm::sincos(self.heading_rad);
        Self::new(
            self.x_m + cos * inner.x_m - sin * inner.y_m,
            self.y_m + sin * inner.x_m + cos * inner.y_m,
            self.heading_rad + inner.heading_rad,
        )
    }

    /// The pose that undoes this one.
    #[must_use]
    pub fn inverse(self) -> Self {
        let (sin, cos) = libm::sincos(self.heading_rad);
        Self::new(-(cos * self.x_m + sin * self.y_m), sin * self.x_m - cos * self.y_m, -self.heading_rad)
    }

    /// `other` as seen from `self`.
    #[must_use]
    pub fn between(self, other: Self) -> Self {
        self.inverse().compose(other)
    }

    /// Each part of a small motion so many times.
    #[must_use]
    pub fn scaled(self, by: f64) -> Self {
        Self::new(self.x_m * by, self.y_m * by, self.heading_rad * by)
    }

    /// Distance of the origins, metres.
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        length_m([self.x_m - other.x_m, self.y_m - other.y_m])
    }

    /// Distance of the origin from that of the outer frame, metres.
    #[must_use]
    pub fn length_m(self) -> f64 {
        length_m([self.x_m, self.y_m])
    }

    /// In single precision, for use within a few dozen metres of the frame.
    #[must_use]
    pub fn single(self) -> Pose2 {
        Pose2::new(self.x_m as f32, self.y_m as f32, self.heading_rad as f32)
    }

    /// A point of this frame in the outer one.
    #[must_use]
    pub fn transform(self, point: Point2) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.heading_rad);
        let (x, y) = (f64::from(point.x_m), f64::from(point.y_m));
        [self.x_m + cos * x - sin * y, self.y_m + sin * x + cos * y]
    }
}

impl From<Pose2> for Se2 {
    fn from(pose: Pose2) -> Self {
        Self::new(f64::from(pose.x_m), f64::from(pose.y_m), f64::from(pose.heading_rad))
    }
}
