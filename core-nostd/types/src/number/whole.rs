//! From whole numbers to floats and to other whole numbers.

/// A whole number of a machine: `u8` to `u64`, `usize`, `i8` to `i64`, `isize`.
pub trait Whole: Copy {
    /// Its bits in 64, with the sign spread to the left.
    fn low_bits(self) -> u64;
    /// The nearest float, ties to even.
    fn nearest_f32(self) -> f32;
    /// The nearest float, ties to even.
    fn nearest_f64(self) -> f64;
}

/// The same three casts serve every type.
macro_rules! casts {
    () => {
        #[inline(always)]
        fn low_bits(self) -> u64 {
            self as u64
        }

        #[inline(always)]
        fn nearest_f32(self) -> f32 {
            self as f32
        }

        #[inline(always)]
        fn nearest_f64(self) -> f64 {
            self as f64
        }
    };
}

impl Whole for u8 {
    casts!();
}

impl Whole for u16 {
    casts!();
}

impl Whole for u32 {
    casts!();
}

impl Whole for u64 {
    casts!();
}

impl Whole for usize {
    casts!();
}

impl Whole for i8 {
    casts!();
}

impl Whole for i16 {
    casts!();
}

impl Whole for i32 {
    casts!();
}

impl Whole for i64 {
    casts!();
}

impl Whole for isize {
    casts!();
}

const _: () = assert!(usize::BITS >= 32 && usize::BITS <= 64, "a number of 32 bits must fit an address");

/// A number of 32 bits as an index: every processor that this is built for has addresses at least as long.
///
/// ```
/// use floorguard_types::number::exact_usize;
///
/// assert_eq!([10, 20, 30][exact_usize(2)], 30);
/// ```
#[inline(always)]
#[must_use]
pub const fn exact_usize(value: u32) -> usize {
    value as usize
}

/// As `u64::from`, of a count, also in constants: no processor that this is built for has longer addresses.
#[inline(always)]
#[must_use]
pub const fn count_u64(count: usize) -> u64 {
    count as u64
}

/// As [`truncating_u32`], of a count, also in constants.
#[inline(always)]
#[must_use]
pub const fn count_u32(count: usize) -> u32 {
    count as u32
}

/// As [`truncating_i32`], of a count, also in constants.
#[inline(always)]
#[must_use]
pub const fn count_i32(count: usize) -> i32 {
    count as i32
}

/// As [`nearest_f32`], of a count, also in constants.
///
/// ```
/// use floorguard_types::number::count_f32;
///
/// const STEP: f32 = 1.0 / count_f32(4);
/// assert_eq!(STEP, 0.25);
/// ```
#[inline(always)]
#[must_use]
pub const fn count_f32(count: usize) -> f32 {
    count as f32
}

/// At most 65,535; also in constants.
///
/// ```
/// use floorguard_types::number::saturating_u16_of_u32;
///
/// assert_eq!([7, 0x1_0002].map(saturating_u16_of_u32), [7, u16::MAX]);
/// ```
#[inline(always)]
#[must_use]
pub const fn saturating_u16_of_u32(value: u32) -> u16 {
    if value > u16::MAX as u32 { u16::MAX } else { value as u16 }
}

/// As `usize::from`, also in constants.
#[inline(always)]
#[must_use]
pub const fn short_usize(value: u16) -> usize {
    value as usize
}

/// The nearest float: exact up to 2²⁴, ties to even beyond.
///
/// ```
/// use floorguard_types::number::nearest_f32;
///
/// assert_eq!(nearest_f32(-7_i32), -7.0);
/// assert_eq!(nearest_f32(16_777_217_u32), 16_777_216.0);
/// ```
#[inline(always)]
#[must_use]
pub fn nearest_f32(value: impl Whole) -> f32 {
    value.nearest_f32()
}

/// The nearest float: exact up to 2⁵³, ties to even beyond.
///
/// ```
/// use floorguard_types::number::nearest_f64;
///
/// assert_eq!(nearest_f64(16_777_217_u64), 16_777_217.0);
/// ```
#[inline(always)]
#[must_use]
pub fn nearest_f64(value: impl Whole) -> f64 {
    value.nearest_f64()
}

/// The low 8 bits; what lies above is dropped.
///
/// ```
/// use floorguard_types::number::truncating_u8;
///
/// assert_eq!([7_u32, 0x1FE].map(truncating_u8), [7, 0xFE]);
/// ```
#[inline(always)]
#[must_use]
pub fn truncating_u8(value: impl Whole) -> u8 {
    value.low_bits() as u8
}

/// The low 16 bits; what lies above is dropped.
///
/// ```
/// use floorguard_types::number::truncating_u16;
///
/// assert_eq!([7_u32, 0x1_0002].map(truncating_u16), [7, 2]);
/// ```
#[inline(always)]
#[must_use]
pub fn truncating_u16(value: impl Whole) -> u16 {
    value.low_bits() as u16
}

/// The low 32 bits; what lies above is dropped.
///
/// ```
/// use floorguard_types::number::truncating_u32;
///
/// assert_eq!([7_u64, 0x1_0000_0002].map(truncating_u32), [7, 2]);
/// ```
#[inline(always)]
#[must_use]
pub fn truncating_u32(value: impl Whole) -> u32 {
    value.low_bits() as u32
}

/// The low 64 bits; what lies above is dropped.
///
/// ```
/// use floorguard_types::number::truncating_u64;
///
/// assert_eq!([7_i64, -1].map(truncating_u64), [7, u64::MAX]);
/// ```
#[inline(always)]
#[must_use]
pub fn truncating_u64(value: impl Whole) -> u64 {
    value.low_bits()
}

/// The low 32 or 64 bits; what lies above is dropped.
///
/// ```
/// use floorguard_types::number::truncating_usize;
///
/// assert_eq!([7_i32, -1].map(truncating_usize), [7, usize::MAX]);
/// ```
#[inline(always)]
#[must_use]
pub fn truncating_usize(value: impl Whole) -> usize {
    value.low_bits() as usize
}

/// The low 32 bits; what lies above is dropped, and the highest of them is the sign.
///
/// ```
/// use floorguard_types::number::truncating_i32;
///
/// assert_eq!([7_u32, 0xFFFF_FFFE].map(truncating_i32), [7, -2]);
/// ```
#[inline(always)]
#[must_use]
pub fn truncating_i32(value: impl Whole) -> i32 {
    value.low_bits() as i32
}

/// The low 64 bits; what lies above is dropped, and the highest of them is the sign.
///
/// ```
/// use floorguard_types::number::truncating_i64;
///
/// assert_eq!([7_u64, u64::MAX].map(truncating_i64), [7, -1]);
/// ```
#[inline(always)]
#[must_use]
pub fn truncating_i64(value: impl Whole) -> i64 {
    value.low_bits() as i64
}
