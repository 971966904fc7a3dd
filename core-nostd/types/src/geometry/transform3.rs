//! Rigid transforms in space: where a sensor is mounted on the robot.

use super::Pose2;

/// A point in space, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Point3 {
    /// Forward, metres.
    pub x_m: f32,
    /// Left, metres.
    pub y_m: f32,
    /// Up, metres.
    pub z_m: f32,
}

impl Point3 {
    /// A point from its coordinates in metres.
    #[must_use]
    pub const fn new(x_m: f32, y_m: f32, z_m: f32) -> Self {
        Self { x_m, y_m, z_m }
    }
}

/// A rotation followed by a translation. Invariant: the rows of `rotation` are orthonormal.
///
/// ```
/// use floorguard_types::geometry::{Point3, Transform3};
///
/// // A lidar 0.8 m above the floor, turned to the left: what it sees ahead is on the left of the robot.
/// let turn_rad = core::f32::consts::FRAC_PI_2;
/// let lidar_in_robot = Transform3::from_mounting(Point3::new(0.5, 0.0, 0.8), 0.0, 0.0, turn_rad);
/// let point = lidar_in_robot.transform(Point3::new(2.0, 0.0, 0.0));
/// assert!((point.x_m - 0.5).abs() < 1.0e-6 && (point.y_m - 2.0).abs() < 1.0e-6);
/// assert_eq!(point.z_m, 0.8);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform3 {
    /// Rotation matrix, row by row.
    pub rotation: [[f32; 3]; 3],
    /// Translation, metres.
    pub translation: Point3,
}

impl Transform3 {
    /// The frame itself.
    pub const IDENTITY: Self = Self {
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: Point3::new(0.0, 0.0, 0.0),
    };

    /// From a mounting point and roll, pitch, yaw in radians (applied in that order about fixed axes, as in ROS).
    #[must_use]
    pub fn from_mounting(translation: Point3, roll_rad: f32, pitch_rad: f32, yaw_rad: f32) -> Self {
        let (sr, cr) = libm::sincosf(roll_rad);
        let (sp, cp) = libm::sincosf(pitch_rad);
        let (sy, cy) = libm::sincosf(yaw_rad);
        Self {
            rotation: [
                [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                [-sp, cp * sr, cp * cr],
            ],
            translation,
        }
    }

    /// What it is on the floor: place and heading, height and tilt forgotten.
    ///
    /// ```
    /// use floorguard_types::geometry::{Point3, Transform3};
    ///
    /// let tilted = Transform3::from_mounting(Point3::new(0.3, 0.1, 1.2), 0.0, 0.2, 0.5);
    /// let pose = tilted.on_floor();
    /// assert_eq!((pose.x_m, pose.y_m), (0.3, 0.1));
    /// assert!((pose.heading_rad - 0.5).abs() < 1.0e-6);
    /// ```
    #[must_use]
    pub fn on_floor(&self) -> Pose2 {
        let [[cos, ..], [sin, ..], _] = self.rotation;
        Pose2::new(self.translation.x_m, self.translation.y_m, libm::atan2f(sin, cos))
    }

    /// A point of the inner frame, expressed in the outer one.
    #[must_use]
    pub fn transform(&self, point: Point3) -> Point3 {
        let [rx, ry, rz] = &self.rotation;
        let dot = |row: &[f32; 3]| row[0] * point.x_m + row[1] * point.y_m + row[2] * point.z_m;
        Point3::new(
            dot(rx) + self.translation.x_m,
            dot(ry) + self.translation.y_m,
            dot(rz) + self.translation.z_m,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yaw_turns_left_and_pitch_dips() {
        let quarter = core::f32::consts::FRAC_PI_2;
        let yawed = Transform3::from_mounting(Point3::new(0.0, 0.0, 0.8), 0.0, 0.0, quarter);
        let p = yawed.transform(Point3::new(1.0, 0.0, 0.0));
        assert!(p.x_m.abs() < 1e-6 && (p.y_m - 1.0).abs() < 1e-6 && (p.z_m - 0.8).abs() < 1e-6);
        let pitched = Transform3::from_mounting(Point3::default(), 0.0, quarter, 0.0);
        assert!((pitched.transform(Point3::new(1.0, 0.0, 0.0)).z_m + 1.0).abs() < 1e-6);
    }
}
