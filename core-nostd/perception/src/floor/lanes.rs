//! Four numbers at a time: plain arithmetic on arrays, which compilers turn into one instruction where there is one.
//!
//! Sums over an image are taken in four lanes and added at the end in a fixed order, so every machine rounds alike.

use core::ops::{Add, Mul, Sub};

use super::root::{greater, inverse_root, lesser};

/// Numbers that are handled together.
pub(super) const LANES: usize = 4;

/// Four numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lanes(pub(super) [f32; LANES]);

impl Lanes {
    /// The same number four times.
    #[inline]
    pub(super) const fn all(value: f32) -> Self {
        Self([value; LANES])
    }

    /// A number each from two.
    #[inline]
    fn with(self, other: Self, combine: impl Fn(f32, f32) -> f32) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, other.0);
        Self([combine(a, p), combine(b, q), combine(c, r), combine(d, s)])
    }

    /// 1 where a number is below the other, else 0; a NaN is below nothing.
    #[inline]
    pub(super) fn is_below(self, other: Self) -> Self {
        self.with(other, |a, b| if a < b { 1.0 } else { 0.0 })
    }

    /// The larger ones.
    #[inline]
    pub(super) fn larger(self, other: Self) -> Self {
        self.with(other, greater)
    }

    /// The smaller ones.
    #[inline]
    pub(super) fn smaller(self, other: Self) -> Self {
        self.with(other, lesser)
    }

    /// Distances from zero.
    #[inline]
    pub(super) fn size(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    /// One over the square roots of positive numbers, within 10⁻⁵.
    #[inline]
    pub(super) fn inverse_root(self) -> Self {
        Self(self.0.map(inverse_root::<2>))
    }

    /// The four added, always in the same order.
    #[inline]
    pub(super) fn total(self) -> f32 {
        let [a, b, c, d] = self.0;
        (a + b) + (c + d)
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl Mul<f32> for Lanes {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self(self.0.map(|value| value * factor))
    }
}

impl Add<f32> for Lanes {
    type Output = Self;
    #[inline]
    fn add(self, value: f32) -> Self {
        Self(self.0.map(|own| own + value))
    }
}

/// `N` sums in four lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneSums<const N: usize>([Lanes; N]);

impl<const N: usize> Default for LaneSums<N> {
    fn default() -> Self {
        Self([Lanes::all(0.0); N])
    }
}

impl<const N: usize> LaneSums<N> {
    /// Adds to every sum.
    #[inline]
    pub(super) fn take(&mut self, values: [Lanes; N]) {
        for (sum, value) in self.0.iter_mut().zip(values) {
            *sum = *sum + value;
        }
    }

    /// Adds the lanes to `sums`; sums of rows first keep the rounding of 10⁵ samples small.
    #[inline]
    pub(super) fn pour_into(&self, sums: &mut [f32; N]) {
        for (sum, lanes) in sums.iter_mut().zip(&self.0) {
            *sum += lanes.total();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_plain_arithmetic() {
        let (a, b) = (Lanes([1.0, -2.0, 3.0, 4.0]), Lanes([0.5, 2.0, 3.0, -1.0]));
        assert_eq!((a + b).0, [1.5, 0.0, 6.0, 3.0]);
        assert_eq!((a - b).0, [0.5, -4.0, 0.0, 5.0]);
        assert_eq!((a * b).0, [0.5, -4.0, 9.0, -4.0]);
        assert_eq!(a.is_below(b).0, [0.0, 1.0, 0.0, 0.0]);
        assert_eq!((a.larger(b).0, a.smaller(b).0), ([1.0, 2.0, 3.0, 4.0], [0.5, -2.0, 3.0, -1.0]));
        assert_eq!(Lanes::all(f32::NAN).is_below(a).0, [0.0; 4]);
        for x in [1.0e-9_f32, 0.3, 2.0, 400.0, 1.0e6] {
            let [found, ..] = Lanes::all(x).inverse_root().0;
            assert!((found * x.sqrt() - 1.0).abs() < 1e-5, "{x}: {found}");
        }
    }
}
