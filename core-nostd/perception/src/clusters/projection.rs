//! From cells of the range image to points of the robot's frame.

use core::f32::consts::FRAC_PI_4;

use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::geometry::{Point3, Transform3, Twist2};
use floorguard_types::number::{nearest_f32, truncating_i32};
use floorguard_types::profile::Profile;
use floorguard_types::sensing::{SweepColumnOf, SweepOf};
use floorguard_types::units::RADIANS_PER_DEGREE;

/// Sines of the elevations of the rings, 0 lowest.
///
/// ```
/// use floorguard_perception::people::RingAngles;
///
/// let (sine, cosine, height_m) = RingAngles::vlp16().rings[15];
/// assert!((sine - 0.258_819).abs() < 1.0e-5 && (cosine - 0.965_926).abs() < 1.0e-5);
/// assert!((height_m + 0.011_23).abs() < 1.0e-4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingAngles {
    /// Sine, cosine and height of the laser's virtual origin in metres, per ring.
    pub rings: [(f32, f32, f32); SWEEP_RINGS],
}

impl RingAngles {
    /// No angles yet.
    pub const NONE: Self = Self { rings: [(0.0, 1.0, 0.0); SWEEP_RINGS] };

    /// Evenly spaced rings from `lowest_deg` in steps of `step_deg`: −15° and 2° for a VLP-16 (book, Velodyne: Laser
    /// angles). The origin of each laser lies 41.91 mm · tan(elevation) below or above the centre.
    #[must_use]
    pub fn even(lowest_deg: f32, step_deg: f32) -> Self {
        let mut rings = [(0.0, 1.0, 0.0); SWEEP_RINGS];
        for (index, ring) in rings.iter_mut().enumerate() {
            let (sin, cos) =
                libm::sincosf(floorguard_types::units::radians(lowest_deg + step_deg * nearest_f32(index)));
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

    /// A PandarXT-16: the same elevations, and all lasers from one point (book, Hesai: Angles).
    #[must_use]
    pub fn pandar_xt16() -> Self {
        Self { rings: Self::vlp16().rings.map(|(sin, cos, _)| (sin, cos, 0.0)) }
    }
}

/// What the columns of a sweep have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweepFrame {
    mounting: Transform3,
    twist: Twist2,
    metres_per_count: f32,
    /// From the first to the last column.
    duration_us: u32,
}

impl SweepFrame {
    /// With the robot's motion during the sweep taken out: points are expressed in the robot's frame at the end of the
    /// sweep (book, Conventions: Deskewing, constant speed within the sweep).
    pub(crate) fn new<P: Profile>(sweep: &SweepOf<P>, mounting: &Transform3, twist: Twist2) -> Self {
        let duration_us = sweep.end_stamp.as_micros().saturating_sub(sweep.stamp.as_micros());
        Self {
            mounting: *mounting,
            twist,
            metres_per_count: f32::from(sweep.range_unit_mm) * 1.0e-3,
            duration_us: u32::try_from(duration_us).unwrap_or(u32::MAX),
        }
    }

    /// The map of a column.
    pub(crate) fn column<P: Profile>(&self, column: &SweepColumnOf<P>) -> ColumnFrame {
        let before_end_us = self.duration_us.saturating_sub(column.offset_us);
        let frame = self.still(column);
        if self.twist == Twist2::ZERO {
            frame
        } else {
            frame.moved(nearest_f32(before_end_us) * -1.0e-6, self.twist)
        }
    }

    /// The lidar stands upright: heights do not depend on the azimuth, so one profile serves all columns.
    pub(crate) fn is_level(&self) -> bool {
        let [.., [zx, zy, _]] = self.mounting.rotation;
        zx == 0.0 && zy == 0.0
    }

    /// The map of a column for a robot that does not move: heights and distances do not depend on that.
    pub(crate) fn still<P: Profile>(&self, column: &SweepColumnOf<P>) -> ColumnFrame {
        let (sin, cos) = sincos_cdeg(column.azimuth_cdeg);
        let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = self.mounting.rotation;
        let Point3 { x_m, y_m, z_m } = self.mounting.translation;
        ColumnFrame {
            // Azimuth runs clockwise: forward is x, right is −y.
            horizontal: [xx * cos - xy * sin, yx * cos - yy * sin, zx * cos - zy * sin],
            vertical: [xz, yz, zz],
            origin: [x_m, y_m, z_m],
            metres_per_count: self.metres_per_count,
        }
    }
}

/// What a count of range means along each ring: horizontal distance, height, and height at range 0, metres.
pub(crate) type RingProfile = [(f32, f32, f32); SWEEP_RINGS];

/// The affine map of one column: point = range · (cos · horizontal + sin · vertical) + height · vertical + origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ColumnFrame {
    horizontal: [f32; 3],
    vertical: [f32; 3],
    origin: [f32; 3],
    metres_per_count: f32,
}

impl ColumnFrame {
    fn moved(self, seconds: f32, twist: Twist2) -> Self {
        let turned_rad = twist.angular_radps * seconds;
        let driven_m = twist.linear_mps * seconds;
        let (sin, cos) = sincos_small(turned_rad);
        let turn = |[x, y, z]: [f32; 3]| [cos * x - sin * y, sin * x + cos * y, z];
        let (half_sin, half_cos) = sincos_small(turned_rad * 0.5);
        let [x, y, z] = turn(self.origin);
        Self {
            horizontal: turn(self.horizontal),
            vertical: turn(self.vertical),
            origin: [x + driven_m * half_cos, y + driven_m * half_sin, z],
            ..self
        }
    }

    /// Range in metres.
    pub(crate) fn range_m(&self, raw: u16) -> f32 {
        f32::from(raw) * self.metres_per_count
    }

    /// Where the lidar was.
    pub(crate) const fn sensor(&self) -> Point3 {
        let [x_m, y_m, z_m] = self.origin;
        Point3::new(x_m, y_m, z_m)
    }

    /// The point of a return.
    pub(crate) fn point(&self, raw: u16, (sin, cos, height_m): (f32, f32, f32)) -> Point3 {
        let range_m = self.range_m(raw);
        let (along, up) = (range_m * cos, range_m * sin + height_m);
        let [hx, hy, hz] = self.horizontal;
        let [vx, vy, vz] = self.vertical;
        let [ox, oy, oz] = self.origin;
        Point3::new(along * hx + up * vx + ox, along * hy + up * vy + oy, along * hz + up * vz + oz)
    }

    /// Distances and heights along each ring.
    pub(crate) fn profile(&self, angles: &RingAngles) -> RingProfile {
        let ([.., horizontal], [.., vertical], [.., origin]) = (self.horizontal, self.vertical, self.origin);
        let unit = self.metres_per_count;
        angles.rings.map(|(sin, cos, height_m)| {
            let rise = unit * (cos * horizontal + sin * vertical);
            (unit * cos, rise, height_m * vertical + origin)
        })
    }
}

/// The series, for ±45°. Products with constants instead of divisions.
fn sincos_series(x: f32) -> (f32, f32) {
    let x2 = x * x;
    let sin = x * (1.0 + x2 * (-1.0 / 6.0 + x2 * (1.0 / 120.0 - x2 * (1.0 / 5_040.0))));
    let cos = 1.0 + x2 * (-0.5 + x2 * (1.0 / 24.0 + x2 * (-1.0 / 720.0 + x2 * (1.0 / 40_320.0))));
    (sin, cos)
}

/// Sine and cosine of an angle that is mostly small: what a robot turns during a sweep.
fn sincos_small(angle_rad: f32) -> (f32, f32) {
    if angle_rad.abs() < FRAC_PI_4 { sincos_series(angle_rad) } else { libm::sincosf(angle_rad) }
}

/// Sine and cosine of hundredths of a degree. The reduction to ±45° is exact in integers, so two short Taylor series
/// (to x⁷ and x⁸, error below 4·10⁻⁷) replace the general function in the hottest loop.
fn sincos_cdeg(azimuth_cdeg: u16) -> (f32, f32) {
    let quarter = (u32::from(azimuth_cdeg) + 4_500) / 9_000;
    let rest_cdeg = i32::from(azimuth_cdeg) - truncating_i32(quarter * 9_000);
    let (sin, cos) = sincos_series(nearest_f32(rest_cdeg) * (RADIANS_PER_DEGREE / 100.0));
    match quarter % 4 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_equal_the_library_everywhere() {
        for cdeg in 0..=u16::MAX {
            let (sin, cos) = sincos_cdeg(cdeg);
            let (wanted_sin, wanted_cos) =
                f64::from(cdeg).mul_add(core::f64::consts::PI / 18_000.0, 0.0).sin_cos();
            assert!((f64::from(sin) - wanted_sin).abs() < 6.0e-7, "{cdeg}");
            assert!((f64::from(cos) - wanted_cos).abs() < 6.0e-7, "{cdeg}");
        }
    }
}
