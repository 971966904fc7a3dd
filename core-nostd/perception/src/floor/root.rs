//! Roots, logarithms and roundings in plain arithmetic, which compilers vectorise and every machine rounds alike.

use floorguard_types::number::{exact_usize, nearest_f32};

/// 1/√x for x > 0, in plain arithmetic that compilers vectorise: steps of Newton's method from a guess by halving the
/// exponent. Two are within 10⁻⁵ of its value, three within 10⁻⁶.
#[inline]
pub(super) fn inverse_root<const STEPS: usize>(x: f32) -> f32 {
    let mut inverse = f32::from_bits(0x5f37_59df_u32.wrapping_sub(x.to_bits() >> 1));
    for _ in 0..STEPS {
        inverse *= 1.5 - 0.5 * x * inverse * inverse;
    }
    inverse
}

/// √x for x ≥ 0 within 10⁻⁶ of its value.
#[inline]
pub(super) fn square_root(x: f32) -> f32 {
    x * inverse_root::<3>(x)
}

/// ln x for normal x > 0 within 2·10⁻⁵: the exponent, and a series of the fraction 1…2.
#[inline]
pub(super) fn logarithm(x: f32) -> f32 {
    const ONE: u32 = 0x3f80_0000;
    let bits = x.to_bits();
    let exponent = nearest_f32(bits >> 23) - 127.0;
    let fraction = f32::from_bits((bits & 0x007f_ffff) | ONE);
    let part = (fraction - 1.0) / (fraction + 1.0);
    let square = part * part;
    // 2 artanh, its first four terms.
    let series = 2.0 + square * (2.0 / 3.0 + square * (0.4 + square * (2.0 / 7.0)));
    exponent * core::f32::consts::LN_2 + part * series
}

/// The whole number next to a value within 0..=2²², by the rounding of one addition: no saturating conversion.
#[inline]
pub(super) fn nearest(value: f32) -> usize {
    const WHOLE: f32 = 8_388_608.0;
    exact_usize((value + WHOLE).to_bits() & 0x003f_ffff)
}

/// The smaller of two, the second for NaN: one instruction, which `min` is not.
#[inline]
pub(super) fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger of two, the second for NaN.
#[inline]
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms() {
        for x in [1.0e-9_f32, 0.02, 0.999, 1.0, 1.999, 2.0, 77.7, 1.0e7] {
            assert!((logarithm(x) - x.ln()).abs() < 2.0e-5, "{x}: {}", logarithm(x));
        }
    }

    #[test]
    fn roots() {
        for x in [0.0_f32, 1.0e-12, 0.3, 2.0, 400.0, 1.0e6] {
            assert!((square_root(x) - x.sqrt()).abs() <= 2e-6 * x.sqrt(), "{x}");
        }
    }
}
