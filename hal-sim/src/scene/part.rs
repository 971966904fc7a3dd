//! A part of the standing world in plain numbers: what sensors meet, and what judges receive.

use parry3d::math::{Pose, Rotation, Vector};
use parry3d::shape::SharedShape;

use super::Material;

/// Shape of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartShape {
    /// Half of length, width and height, metres.
    Box([f32; 3]),
    /// An upright post: radius and height, metres.
    Post(f32, f32),
}

/// A part: everything of it is true.
#[derive(Clone, Debug, PartialEq)]
pub struct PartTruth {
    /// Kind of object and its number in the scenario.
    pub name: String,
    /// Shape.
    pub shape: PartShape,
    /// Middle, world frame, metres.
    pub centre_m: [f32; 3],
    /// Counter-clockwise, radians.
    pub yaw_rad: f32,
    /// Rise along its own x, radians.
    pub slope_rad: f32,
    /// Surface.
    pub material: Material,
}

impl PartTruth {
    /// As parry wants it.
    pub(super) fn placed(&self) -> (Pose, SharedShape) {
        let [x, y, z] = self.centre_m;
        let turn = Rotation::from_rotation_z(self.yaw_rad);
        match self.shape {
            PartShape::Box([a, b, c]) => {
                let tilt = if self.slope_rad == 0.0 {
                    turn
                } else {
                    turn * Rotation::from_rotation_y(-self.slope_rad)
                };
                (Pose::from_parts(Vector::new(x, y, z), tilt), SharedShape::cuboid(a, b, c))
            }
            PartShape::Post(radius_m, height_m) => {
                // A cylinder of parry stands along y.
                let upright = Rotation::from_rotation_x(core::f32::consts::FRAC_PI_2);
                let shape = SharedShape::cylinder(height_m / 2.0, radius_m);
                (Pose::from_parts(Vector::new(x, y, z), upright), shape)
            }
        }
    }
}

/// A hole in the floor: a loading dock, a stairwell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DropTruth {
    /// Middle, world frame, metres.
    pub centre_m: [f32; 2],
    /// Length and width, metres.
    pub size_m: [f32; 2],
    /// Counter-clockwise, radians.
    pub yaw_rad: f32,
    /// How much lower the floor is, metres.
    pub depth_m: f32,
}

impl DropTruth {
    /// A place of the floor plan is over the hole.
    #[must_use]
    pub fn contains(&self, place_m: [f32; 2]) -> bool {
        let (sin, cos) = libm::sincosf(self.yaw_rad);
        let (dx, dy) = (place_m[0] - self.centre_m[0], place_m[1] - self.centre_m[1]);
        let (along, across) = (cos * dx + sin * dy, cos * dy - sin * dx);
        along.abs() < self.size_m[0] / 2.0 && across.abs() < self.size_m[1] / 2.0
    }
}
