//! From cells of the range image to points of the robot's frame.

use crate::capacities::SWEEP_RINGS;
use crate::geometry::{Point3, Transform3, Twist2};
use crate::sensing::{Sweep, SweepColumn};
use crate::units::centidegrees_to_radians;

/// Sines of the elevations of the rings, 0 lowest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingAngles {
    /// Sine, cosine and height of the laser's virtual origin in metres, per ring.
    pub rings: [(f32, f32, f32); SWEEP_RINGS],
}

impl RingAngles {
    /// Evenly spaced rings from `lowest_deg` in steps of `step_deg`: −15° and 2° for a VLP-16 (wire-formats 1.3). The
    /// origin of each laser lies 41.91 mm · tan(elevation) below or above the centre.
    #[must_use]
    pub fn even(lowest_deg: f32, step_deg: f32) -> Self {
        let mut rings = [(0.0, 1.0, 0.0); SWEEP_RINGS];
        for (index, ring) in rings.iter_mut().enumerate() {
            let (sin, cos) = libm::sincosf(crate::units::radians(lowest_deg + step_deg * index as f32));
            // No elevation of a lidar reaches ±90°.
            *ring = (sin, cos, -0.041_91 * sin / cos.max(0.01));
        }
        Self { rings }
    }

    /// A VLP-16.
    #[must_use]
    pub fn vlp16() -> Self {
        Self::even(-15.0, 2.0)
    }
}

/// The affine map of one column: point = range · (cos · horizontal + sin · vertical) + height · vertical + origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColumnFrame {
    horizontal: [f32; 3],
    vertical: [f32; 3],
    origin: [f32; 3],
    metres_per_count: f32,
}

impl ColumnFrame {
    /// For a column of a sweep, with the robot's motion during the sweep taken out: the point is expressed in the
    /// robot's frame at the end of the sweep (algorithms X.8, constant speed within the sweep).
    pub(super) fn new(sweep: &Sweep, column: &SweepColumn, mounting: &Transform3, twist: Twist2) -> Self {
        let (sin, cos) = libm::sincosf(centidegrees_to_radians(column.azimuth_cdeg));
        let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = mounting.rotation;
        // Azimuth runs clockwise: forward is x, right is −y.
        let horizontal = [xx * cos - xy * sin, yx * cos - yy * sin, zx * cos - zy * sin];
        let vertical = [xz, yz, zz];
        let origin = [mounting.translation.x_m, mounting.translation.y_m, mounting.translation.z_m];
        let measured = sweep.stamp.plus_micros(u64::from(column.offset_us));
        let before_end_s = measured.seconds_since(sweep.end_stamp);
        let frame =
            Self { horizontal, vertical, origin, metres_per_count: f32::from(sweep.range_unit_mm) * 1.0e-3 };
        frame.moved(before_end_s, twist)
    }

    fn moved(self, seconds: f32, twist: Twist2) -> Self {
        let turned_rad = twist.angular_radps * seconds;
        let driven_m = twist.linear_mps * seconds;
        if turned_rad == 0.0 && driven_m == 0.0 {
            return self;
        }
        let (sin, cos) = libm::sincosf(turned_rad);
        let turn = |[x, y, z]: [f32; 3]| [cos * x - sin * y, sin * x + cos * y, z];
        let half = turned_rad * 0.5;
        let (half_sin, half_cos) = libm::sincosf(half);
        let [x, y, z] = turn(self.origin);
        Self {
            horizontal: turn(self.horizontal),
            vertical: turn(self.vertical),
            origin: [x + driven_m * half_cos, y + driven_m * half_sin, z],
            ..self
        }
    }

    /// Range in metres.
    pub(super) fn range_m(&self, raw: u16) -> f32 {
        f32::from(raw) * self.metres_per_count
    }

    /// The point of a return.
    pub(super) fn point(&self, raw: u16, (sin, cos, height_m): (f32, f32, f32)) -> Point3 {
        let range_m = self.range_m(raw);
        let (along, up) = (range_m * cos, range_m * sin + height_m);
        let [hx, hy, hz] = self.horizontal;
        let [vx, vy, vz] = self.vertical;
        let [ox, oy, oz] = self.origin;
        Point3::new(along * hx + up * vx + ox, along * hy + up * vy + oy, along * hz + up * vz + oz)
    }

    /// Height of a return above the floor of the robot's frame, metres.
    pub(super) fn height_m(&self, raw: u16, (sin, cos, height_m): (f32, f32, f32)) -> f32 {
        let range_m = self.range_m(raw);
        range_m * cos * self.horizontal[2] + (range_m * sin + height_m) * self.vertical[2] + self.origin[2]
    }
}
