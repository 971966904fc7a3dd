//! Conversions between the units of the wire and SI.

/// Radians in one degree.
pub const RADIANS_PER_DEGREE: f32 = core::f32::consts::PI / 180.0;

/// Degrees to radians.
#[must_use]
pub fn radians(degrees: f32) -> f32 {
    degrees * RADIANS_PER_DEGREE
}

/// Hundredths of a degree, as lidars send azimuths, to radians.
#[must_use]
pub fn centidegrees_to_radians(centidegrees: u16) -> f32 {
    f32::from(centidegrees) * (RADIANS_PER_DEGREE / 100.0)
}

/// Standard gravity, m/s² (ISO 80000-3).
pub const GRAVITY_MPS2: f32 = 9.806_65;
