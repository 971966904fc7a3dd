//! Solid shapes of objects and limbs, world frame, in plain numbers.

use parry3d::math::{Pose, Rotation, Vector};
use parry3d::shape::SharedShape;

/// A solid. Metres and radians, world frame, z up from the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// A box that is turned about the vertical and then sloped.
    Box {
        /// Middle.
        centre_m: [f32; 3],
        /// Half of its length, width and height.
        half_m: [f32; 3],
        /// Counter-clockwise about the vertical.
        yaw_rad: f32,
        /// Rise along its own x axis; 0 is level.
        slope_rad: f32,
    },
    /// An upright cylinder.
    Cylinder {
        /// Middle of its lower face.
        foot_m: [f32; 3],
        /// Radius.
        radius_m: f32,
        /// Height.
        height_m: f32,
    },
    /// A rod with round ends.
    Capsule {
        /// Middle of one end.
        from_m: [f32; 3],
        /// Middle of the other end.
        to_m: [f32; 3],
        /// Radius.
        radius_m: f32,
    },
    /// A ball.
    Ball {
        /// Middle.
        centre_m: [f32; 3],
        /// Radius.
        radius_m: f32,
    },
}

/// A solid as parry wants it.
#[derive(Clone)]
pub(crate) struct Placed {
    pub(crate) pose: Pose,
    pub(crate) shape: SharedShape,
}

impl Placed {
    /// Lowest and highest corner of a box around it, world frame, metres.
    pub(crate) fn bounds(&self) -> [Vector; 2] {
        let around = self.shape.compute_aabb(&self.pose);
        [around.mins, around.maxs]
    }
}

fn vector(point: [f32; 3]) -> Vector {
    Vector::new(point[0], point[1], point[2])
}

impl Solid {
    /// The shape and where it is.
    pub(crate) fn placed(&self) -> Placed {
        match *self {
            Self::Box { centre_m, half_m, yaw_rad, slope_rad } => {
                let turn = Rotation::from_rotation_z(yaw_rad) * Rotation::from_rotation_y(-slope_rad);
                let pose = Pose::from_parts(vector(centre_m), turn);
                Placed { pose, shape: SharedShape::cuboid(half_m[0], half_m[1], half_m[2]) }
            }
            Self::Cylinder { foot_m, radius_m, height_m } => {
                // A cylinder of parry stands along y.
                let turn = Rotation::from_rotation_x(core::f32::consts::FRAC_PI_2);
                let middle = vector(foot_m) + Vector::Z * (height_m / 2.0);
                let shape = SharedShape::cylinder(height_m / 2.0, radius_m);
                Placed { pose: Pose::from_parts(middle, turn), shape }
            }
            Self::Capsule { from_m, to_m, radius_m } => {
                let middle = (vector(from_m) + vector(to_m)) / 2.0;
                let shape = SharedShape::capsule(vector(from_m) - middle, vector(to_m) - middle, radius_m);
                Placed { pose: Pose::from_translation(middle), shape }
            }
            Self::Ball { centre_m, radius_m } => {
                Placed { pose: Pose::from_translation(vector(centre_m)), shape: SharedShape::ball(radius_m) }
            }
        }
    }

    /// The solid between this one and a later state of it; `share` is 0 now and 1 then. Other kinds of solids do not blend.
    #[must_use]
    pub fn between(&self, later: &Self, share: f32) -> Self {
        let mix =
            |a: [f32; 3], b: [f32; 3]| core::array::from_fn(|axis| a[axis] + share * (b[axis] - a[axis]));
        match (*self, *later) {
            (
                Self::Box { centre_m, half_m, yaw_rad, slope_rad },
                Self::Box { centre_m: centre_later_m, yaw_rad: yaw_later_rad, .. },
            ) => Self::Box {
                centre_m: mix(centre_m, centre_later_m),
                half_m,
                yaw_rad: yaw_rad + share * crate::motion::wrapped(yaw_later_rad - yaw_rad),
                slope_rad,
            },
            (Self::Cylinder { foot_m, radius_m, height_m }, Self::Cylinder { foot_m: later_m, .. }) => {
                Self::Cylinder { foot_m: mix(foot_m, later_m), radius_m, height_m }
            }
            (Self::Capsule { from_m, to_m, radius_m }, Self::Capsule { from_m: a_m, to_m: b_m, .. }) => {
                Self::Capsule { from_m: mix(from_m, a_m), to_m: mix(to_m, b_m), radius_m }
            }
            (Self::Ball { centre_m, radius_m }, Self::Ball { centre_m: later_m, .. }) => {
                Self::Ball { centre_m: mix(centre_m, later_m), radius_m }
            }
            _ => *later,
        }
    }

    /// The same solid elsewhere.
    #[must_use]
    pub fn moved(&self, by_m: [f32; 2]) -> Self {
        let shift = |point: [f32; 3]| [point[0] + by_m[0], point[1] + by_m[1], point[2]];
        match *self {
            Self::Box { centre_m, half_m, yaw_rad, slope_rad } => {
                Self::Box { centre_m: shift(centre_m), half_m, yaw_rad, slope_rad }
            }
            Self::Cylinder { foot_m, radius_m, height_m } => {
                Self::Cylinder { foot_m: shift(foot_m), radius_m, height_m }
            }
            Self::Capsule { from_m, to_m, radius_m } => {
                Self::Capsule { from_m: shift(from_m), to_m: shift(to_m), radius_m }
            }
            Self::Ball { centre_m, radius_m } => Self::Ball { centre_m: shift(centre_m), radius_m },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_of_every_kind_by_hand() {
        let bounds = |solid: Solid| solid.placed().bounds();
        let near = |found: [Vector; 2], low: [f32; 3], high: [f32; 3]| {
            assert!((found[0] - vector(low)).length() < 1e-4, "{found:?}");
            assert!((found[1] - vector(high)).length() < 1e-4, "{found:?}");
        };
        let yaw_rad = core::f32::consts::FRAC_PI_2;
        let block =
            Solid::Box { centre_m: [1.0, 2.0, 0.5], half_m: [0.3, 0.1, 0.5], yaw_rad, slope_rad: 0.0 };
        near(bounds(block), [0.9, 1.7, 0.0], [1.1, 2.3, 1.0]);
        let post = Solid::Cylinder { foot_m: [0.0, 1.0, 0.2], radius_m: 0.1, height_m: 0.6 };
        near(bounds(post), [-0.1, 0.9, 0.2], [0.1, 1.1, 0.8]);
        let rod = Solid::Capsule { from_m: [0.0, 0.0, 0.1], to_m: [1.0, 0.0, 0.1], radius_m: 0.1 };
        near(bounds(rod), [-0.1, -0.1, 0.0], [1.1, 0.1, 0.2]);
        near(
            bounds(Solid::Ball { centre_m: [0.0, 0.0, 1.0], radius_m: 0.2 }),
            [-0.2, -0.2, 0.8],
            [0.2, 0.2, 1.2],
        );
    }

    /// A slope of 3 in 4 along x: the upper edge of the far end is higher than that of the near end.
    #[test]
    fn a_slope_rises_along_its_own_x() {
        let slope_rad = libm::atan2f(3.0, 4.0);
        let ramp = Solid::Box { centre_m: [0.0; 3], half_m: [2.5, 1.0, 0.01], yaw_rad: 0.0, slope_rad };
        let placed = ramp.placed();
        let far = placed.pose.transform_point(Vector::new(2.5, 0.0, 0.0));
        assert!((far - Vector::new(2.0, 0.0, 1.5)).length() < 1e-4, "{far:?}");
    }

    #[test]
    fn half_way_between_two_states() {
        let rod = |x_m: f32| Solid::Capsule { from_m: [x_m, 0.0, 0.1], to_m: [x_m, 0.0, 1.0], radius_m: 0.1 };
        assert_eq!(rod(0.0).between(&rod(1.0), 0.5), rod(0.5));
        assert_eq!(rod(0.0).moved([0.25, 0.0]), rod(0.25));
    }
}
