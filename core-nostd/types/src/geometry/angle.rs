//! Angles on the circle.

use core::f32::consts::PI;

/// The same direction within [−π, π). Constant time; a value that is not finite becomes 0, because a NaN must never
/// travel on (book, Conventions: Numbers).
///
/// ```
/// use core::f32::consts::{FRAC_PI_2, PI};
/// use floorguard_types::geometry::wrap_angle;
///
/// assert!((wrap_angle(3.0 * FRAC_PI_2) + FRAC_PI_2).abs() < 1.0e-6);
/// assert_eq!(wrap_angle(PI), -PI);
/// assert_eq!(wrap_angle(f32::NAN), 0.0);
/// ```
#[must_use]
pub fn wrap_angle(angle_rad: f32) -> f32 {
    if !angle_rad.is_finite() {
        return 0.0;
    }
    let wrapped = angle_rad - 2.0 * PI * libm::floorf((angle_rad + PI) / (2.0 * PI));
    // Rounding can land on +π exactly, or just outside for huge inputs.
    if (-PI..PI).contains(&wrapped) { wrapped } else { -PI }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wraps_to_the_half_open_circle() {
        assert_eq!(wrap_angle(0.0), 0.0);
        assert_eq!(wrap_angle(PI), -PI);
        assert!((wrap_angle(3.0 * PI + 0.1) - (-PI + 0.1)).abs() < 1e-5);
        assert!((wrap_angle(-7.0) - (2.0 * PI - 7.0)).abs() < 1e-6);
        assert_eq!(wrap_angle(f32::NAN), 0.0);
        for huge in [1e30_f32, -1e30, f32::MAX] {
            assert!((-PI..PI).contains(&wrap_angle(huge)));
        }
    }
}
