//! Conversions between the units of the wire and SI.

/// Radians in one degree.
pub const RADIANS_PER_DEGREE: f32 = core::f32::consts::PI / 180.0;

/// Degrees to radians.
///
/// ```
/// assert_eq!(floorguard_types::units::radians(180.0), core::f32::consts::PI);
/// ```
#[must_use]
pub fn radians(degrees: f32) -> f32 {
    degrees * RADIANS_PER_DEGREE
}

/// Hundredths of a degree, as lidars send azimuths, to radians.
///
/// ```
/// use floorguard_types::units::centidegrees_to_radians;
///
/// assert!((centidegrees_to_radians(9_000) - core::f32::consts::FRAC_PI_2).abs() < 1.0e-6);
/// ```
#[must_use]
pub fn centidegrees_to_radians(centidegrees: u16) -> f32 {
    f32::from(centidegrees) * (RADIANS_PER_DEGREE / 100.0)
}

/// Standard gravity, m/s² (ISO 80000-3).
pub const GRAVITY_MPS2: f32 = 9.806_65;
