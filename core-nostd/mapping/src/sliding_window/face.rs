//! The three vertical grids of the window, and how a point around the robot is seen in one of them.
//!
//! Each grid is a wall that faces the robot: ahead, and 75° to the left and to the right (Dalmedico et al. 2019, section
//! 4). A point belongs to the grid whose normal is nearest in direction, so that borders lie at ±37.5° and the window
//! ends at ±112.5°.

use floorguard_types::geometry::Point3;

/// Sine and cosine of 75°, the direction of the lateral normals.
const SIN_75: f32 = 0.965_925_8;
const COS_75: f32 = 0.258_819_04;
/// Sine and cosine of 37.5°, the border between the grid ahead and a lateral one.
const SIN_37_5: f32 = 0.608_761_4;
const COS_37_5: f32 = 0.793_353_3;
/// Sine and cosine of 112.5°, where the window ends.
const SIN_112_5: f32 = 0.923_879_5;
const COS_112_5: f32 = -0.382_683_43;

/// One of the three grids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Face {
    /// Normal straight ahead.
    #[default]
    Front,
    /// Normal at +75°.
    Left,
    /// Normal at −75°.
    Right,
}

/// The direction of a normal on the floor, as cosine and sine of its azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Normal {
    pub(super) cos: f32,
    pub(super) sin: f32,
}

/// A point as a grid sees it, metres.
///
/// ```
/// use floorguard_mapping::sliding_window::Face;
/// use floorguard_types::geometry::Point3;
///
/// let seen = Face::Front.project(Point3::new(1.0, 0.2, 0.5));
/// assert_eq!((seen.elevation_m, seen.along_m, seen.up_m), (1.0, 0.2, 0.5));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FacePoint {
    /// Along the grid, to the left of its normal.
    pub along_m: f32,
    /// Height above the floor.
    pub up_m: f32,
    /// Distance along the normal from the robot's centre: the value that a cell keeps.
    pub elevation_m: f32,
}

impl Face {
    /// All grids.
    pub const ALL: [Self; 3] = [Self::Front, Self::Left, Self::Right];

    /// Azimuth of the normal, radians, left positive.
    #[must_use]
    pub const fn azimuth_rad(self) -> f32 {
        match self {
            Self::Front => 0.0,
            Self::Left => 1.308_997,
            Self::Right => -1.308_997,
        }
    }

    pub(super) const fn number(self) -> usize {
        match self {
            Self::Front => 0,
            Self::Left => 1,
            Self::Right => 2,
        }
    }

    pub(super) const fn normal(self) -> Normal {
        match self {
            Self::Front => Normal { cos: 1.0, sin: 0.0 },
            Self::Left => Normal { cos: COS_75, sin: SIN_75 },
            Self::Right => Normal { cos: COS_75, sin: -SIN_75 },
        }
    }

    /// The grid of a direction; `None` beyond ±112.5°, and for coordinates that are not finite. Constant time.
    ///
    /// ```
    /// use floorguard_mapping::sliding_window::Face;
    ///
    /// assert_eq!(Face::of_direction(1.0, 0.7), Some(Face::Front));
    /// assert_eq!(Face::of_direction(1.0, 0.8), Some(Face::Left));
    /// assert_eq!(Face::of_direction(-1.0, 0.0), None);
    /// ```
    #[must_use]
    pub fn of_direction(x_m: f32, y_m: f32) -> Option<Self> {
        let aside_m = libm::fabsf(y_m);
        if aside_m * COS_37_5 <= x_m * SIN_37_5 {
            return Some(Self::Front);
        }
        let is_inside = x_m * SIN_112_5 - aside_m * COS_112_5 >= 0.0;
        let lateral = if y_m > 0.0 { Self::Left } else { Self::Right };
        is_inside.then_some(lateral)
    }

    /// A point of the window's frame as this grid sees it.
    #[must_use]
    pub fn project(self, point: Point3) -> FacePoint {
        let Normal { cos, sin } = self.normal();
        FacePoint {
            along_m: -point.x_m * sin + point.y_m * cos,
            up_m: point.z_m,
            elevation_m: point.x_m * cos + point.y_m * sin,
        }
    }

    /// The point of the window's frame that this grid sees so: undoes [`Self::project`].
    #[must_use]
    pub fn point(self, seen: FacePoint) -> Point3 {
        let Normal { cos, sin } = self.normal();
        Point3::new(
            seen.elevation_m * cos - seen.along_m * sin,
            seen.elevation_m * sin + seen.along_m * cos,
            seen.up_m,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_lie_between_the_normals() {
        for degrees in -180..180 {
            let azimuth = f64::from(degrees).to_radians();
            let found = Face::of_direction(azimuth.cos() as f32, azimuth.sin() as f32);
            let expected = match degrees {
                -37..=37 => Some(Face::Front),
                38..=112 => Some(Face::Left),
                -112..=-38 => Some(Face::Right),
                _ => None,
            };
            assert_eq!(found, expected, "{degrees}°");
        }
        assert_eq!(Face::of_direction(f32::NAN, 1.0), None);
    }

    #[test]
    fn projection_is_undone() {
        for face in Face::ALL {
            let azimuth = f64::from(face.azimuth_rad());
            assert!((azimuth.cos() as f32 - face.normal().cos).abs() < 1e-6);
            assert!((azimuth.sin() as f32 - face.normal().sin).abs() < 1e-6);
            let point = Point3::new(1.3, -0.4, 0.9);
            let back = face.point(face.project(point));
            assert!((back.x_m - 1.3).abs() < 1e-6 && (back.y_m + 0.4).abs() < 1e-6 && back.z_m == 0.9);
        }
    }
}
