//! Turns in space by `libm`: nalgebra's own functions for angles take those of the machine's C library in some builds, whose last
//! bits differ from machine to machine.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// The turn as axis times angle, radians, at most π long.
#[must_use]
pub fn turn_vector(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    let q = rotation.quaternion();
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    let axis = q.imag() * sign;
    let sine = libm::sqrt(axis.norm_squared());
    // Twice the axis is the turn where it is small.
    if sine < 1.0e-12 { axis * 2.0 } else { axis * (2.0 * libm::atan2(sine, q.w * sign) / sine) }
}

/// The angle of the turn, 0 to π.
#[must_use]
pub fn turn_angle_rad(rotation: &UnitQuaternion<f64>) -> f64 {
    let q = rotation.quaternion();
    2.0 * libm::atan2(libm::sqrt(q.imag().norm_squared()), q.w.abs())
}

/// The turn about an axis by an angle, both in one vector.
#[must_use]
pub fn turn_about(vector: &Vector3<f64>) -> UnitQuaternion<f64> {
    let angle_rad = libm::sqrt(vector.norm_squared());
    let (sin, cos) = libm::sincos(0.5 * angle_rad);
    let part = if angle_rad < 1.0e-9 { 0.5 } else { sin / angle_rad };
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, vector * part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_agree_with_those_of_nalgebra() {
        let vectors =
            [[0.0, 0.0, 0.0], [1e-10, 0.0, 0.0], [0.3, -0.2, 0.9], [0.0, 3.1, 0.4], [0.0, 0.0, 3.1]];
        for vector in vectors.map(Vector3::from) {
            let ours = turn_about(&vector);
            assert!(ours.angle_to(&UnitQuaternion::from_scaled_axis(vector)) < 1e-12, "{vector}");
            assert!((turn_vector(&ours) - vector).norm() < 1e-12, "{vector}");
            assert!((turn_angle_rad(&ours) - vector.norm()).abs() < 1e-12, "{vector}");
            // The same turn has two quaternions.
            let other = UnitQuaternion::new_unchecked(-ours.into_inner());
            assert!((turn_vector(&other) - vector).norm() < 1e-12, "{vector}");
        }
    }
}
