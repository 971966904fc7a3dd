//! From floats to whole numbers and to shorter floats.

/// Towards zero, within 0…255; 0 for a NaN.
///
/// ```
/// use floorguard_types::number::saturating_u8;
///
/// assert_eq!([-1.0, 7.9, 1.0e9, f32::NAN].map(saturating_u8), [0, 7, 255, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_u8(value: f32) -> u8 {
    value as u8
}

/// Towards zero, within 0…65,535; 0 for a NaN.
///
/// ```
/// use floorguard_types::number::saturating_u16;
///
/// assert_eq!([-1.0, 7.9, 1.0e9, f32::NAN].map(saturating_u16), [0, 7, u16::MAX, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_u16(value: f32) -> u16 {
    value as u16
}

/// Towards zero, within −128…127; 0 for a NaN.
///
/// ```
/// use floorguard_types::number::saturating_i8;
///
/// assert_eq!([-7.9, 7.9, 1.0e9, f32::NAN].map(saturating_i8), [-7, 7, i8::MAX, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_i8(value: f32) -> i8 {
    value as i8
}

/// Towards zero, within −32,768…32,767; 0 for a NaN.
///
/// ```
/// use floorguard_types::number::saturating_i16;
///
/// assert_eq!([-7.9, 7.9, -1.0e9, f32::NAN].map(saturating_i16), [-7, 7, i16::MIN, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_i16(value: f32) -> i16 {
    value as i16
}

/// Towards zero, within 0…4,294,967,295; 0 for a NaN.
///
/// ```
/// use floorguard_types::number::saturating_u32;
///
/// assert_eq!([-1.0, 7.9, 1.0e12, f32::NAN].map(saturating_u32), [0, 7, u32::MAX, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_u32(value: f32) -> u32 {
    value as u32
}

/// Towards zero, within 0…18,446,744,073,709,551,615; 0 for a NaN.
///
/// ```
/// use floorguard_types::number::saturating_u64;
///
/// assert_eq!([-1.0, 7.9, f32::INFINITY, f32::NAN].map(saturating_u64), [0, 7, u64::MAX, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_u64(value: f32) -> u64 {
    value as u64
}

/// Towards zero, within the numbers of 32 bits; 0 for a NaN. Not the floor: −0.5 becomes 0.
///
/// ```
/// use floorguard_types::number::saturating_i32;
///
/// assert_eq!([-0.5, -7.9, 1.0e12, f32::NAN].map(saturating_i32), [0, -7, i32::MAX, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_i32(value: f32) -> i32 {
    value as i32
}

/// Towards zero, at least 0, at most the largest index; 0 for a NaN.
///
/// ```
/// use floorguard_types::number::saturating_usize;
///
/// assert_eq!([-1.0, 7.9, f32::INFINITY, f32::NAN].map(saturating_usize), [0, 7, usize::MAX, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_usize(value: f32) -> usize {
    value as usize
}

/// Towards zero, within 0…4,294,967,295; 0 for a NaN.
///
/// ```
/// use floorguard_types::number::saturating_u32_of_f64;
///
/// assert_eq!([-1.0, 7.9, 1.0e12, f64::NAN].map(saturating_u32_of_f64), [0, 7, u32::MAX, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_u32_of_f64(value: f64) -> u32 {
    value as u32
}

/// Towards zero, at least 0, at most the largest index; 0 for a NaN.
///
/// ```
/// use floorguard_types::number::saturating_usize_of_f64;
///
/// assert_eq!([-1.0, 7.9, f64::INFINITY, f64::NAN].map(saturating_usize_of_f64), [0, 7, usize::MAX, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_usize_of_f64(value: f64) -> usize {
    value as usize
}

/// Towards zero, within the numbers of 64 bits; 0 for a NaN.
///
/// ```
/// use floorguard_types::number::saturating_i64_of_f64;
///
/// assert_eq!([-7.9, 7.9, 1.0e30, f64::NAN].map(saturating_i64_of_f64), [-7, 7, i64::MAX, 0]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_i64_of_f64(value: f64) -> i64 {
    value as i64
}

/// The nearest float of 32 bits, ties to even; infinite beyond the largest.
///
/// ```
/// use floorguard_types::number::nearest_f32_of_f64;
///
/// assert_eq!([0.1, 1.0e300].map(nearest_f32_of_f64), [0.1_f32, f32::INFINITY]);
/// ```
#[inline(always)]
#[must_use]
pub const fn nearest_f32_of_f64(value: f64) -> f32 {
    value as f32
}
