//! Seeded random numbers: PCG32 and the distributions that the cleaning belief draws from.
//!
//! The same seed gives the same run on every machine, so every stochastic result can be repeated (book, Conventions:
//! Random numbers). Every sampler is bounded: no rejection loops.

use crate::number::{nearest_f32, saturating_u32, truncating_u32};

/// PCG-XSH-RR 64/32 (O'Neill 2014). Invariant: `increment` is odd.
///
/// ```
/// use floorguard_types::random::Pcg32;
///
/// // The demonstration of the reference implementation: seed 42, stream 54.
/// let mut random = Pcg32::new(42, 54);
/// assert_eq!(random.next_u32(), 0xa15c_02b7);
/// assert_eq!(random.next_u32(), 0x7b47_f409);
/// ```
#[derive(Clone, Debug)]
pub struct Pcg32 {
    state: u64,
    increment: u64,
}

/// Largest Poisson number: 80 + 12·√80 + 20.
const POISSON_MAX: u32 = 208;
const MULTIPLIER: u64 = 6_364_136_223_846_793_005;
/// Smallest uniform number that Box–Muller sees: 2⁻²⁴.
const UNIFORM_FLOOR: f32 = 1.0 / 16_777_216.0;

impl Pcg32 {
    /// A generator from a seed and a stream number; different streams of one seed are independent.
    #[must_use]
    pub const fn new(seed: u64, stream: u64) -> Self {
        let increment = (stream << 1) | 1;
        let state = increment.wrapping_add(seed).wrapping_mul(MULTIPLIER).wrapping_add(increment);
        Self { state, increment }
    }

    /// The next 32 random bits.
    #[inline]
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(MULTIPLIER).wrapping_add(self.increment);
        let shifted = truncating_u32(((old >> 18) ^ old) >> 27);
        shifted.rotate_right(truncating_u32(old >> 59))
    }

    /// Uniform within [0, 1), from the top 24 bits.
    #[inline]
    pub fn uniform(&mut self) -> f32 {
        nearest_f32(self.next_u32() >> 8) * UNIFORM_FLOOR
    }

    /// Uniform within [low, high).
    pub fn uniform_between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.uniform()
    }

    /// Uniform within 0..bound by multiplication; 0 for a bound of 0. Bias below bound / 2³².
    ///
    /// ```
    /// use floorguard_types::random::Pcg32;
    ///
    /// let mut random = Pcg32::new(1, 1);
    /// assert!((0..100).all(|_| random.below(6) < 6));
    /// assert_eq!(random.below(0), 0);
    /// ```
    #[inline]
    pub fn below(&mut self, bound: u32) -> u32 {
        truncating_u32((u64::from(self.next_u32()) * u64::from(bound)) >> 32)
    }

    /// Two independent standard normal numbers (Box–Muller, u₁ floored at 2⁻²⁴).
    #[inline]
    pub fn normal_pair(&mut self) -> (f32, f32) {
        let radius = libm::sqrtf(-2.0 * libm::logf(self.uniform().max(UNIFORM_FLOOR)));
        let (sin, cos) = libm::sincosf(core::f32::consts::TAU * self.uniform());
        (radius * cos, radius * sin)
    }

    /// One standard normal number.
    pub fn normal(&mut self) -> f32 {
        self.normal_pair().0
    }

    /// True with this probability.
    #[inline]
    pub fn bernoulli(&mut self, probability: f32) -> bool {
        self.uniform() < probability
    }

    /// A whole number whose mean is `value` ≥ 0: the floor, plus one with the probability of the fraction.
    #[inline]
    pub fn round_randomly(&mut self, value: f32) -> u32 {
        let floor = libm::floorf(value.max(0.0));
        saturating_u32(floor).saturating_add(u32::from(self.bernoulli(value - floor)))
    }

    /// Binomial(n, p) with n ≤ 255, as n Bernoulli draws.
    #[inline]
    pub fn binomial(&mut self, trials: u8, probability: f32) -> u8 {
        let mut successes = 0_u8;
        for _ in 0..trials {
            successes = successes.saturating_add(u8::from(self.bernoulli(probability)));
        }
        successes
    }

    /// Poisson(λ) by inversion; the search ends at λ + 12√λ + 20. λ is clamped to 0..=80 (e⁻⁸⁰ is the last power that
    /// f32 holds with full precision); a λ that is not finite counts as 0.
    ///
    /// ```
    /// use floorguard_types::random::Pcg32;
    ///
    /// let mut random = Pcg32::new(1, 1);
    /// let sum: u32 = (0..1_000).map(|_| random.poisson(3.0)).sum();
    /// assert!((2_700..3_300).contains(&sum));
    /// assert_eq!(random.poisson(f32::NAN), 0);
    /// ```
    #[inline]
    pub fn poisson(&mut self, rate: f32) -> u32 {
        if !rate.is_finite() || rate <= 0.0 {
            return 0;
        }
        let rate = rate.min(80.0);
        self.poisson_with(rate, libm::expf(-rate))
    }

    /// As [`Self::poisson`], with e^−λ already known; λ within 0..=80.
    #[inline]
    pub fn poisson_with(&mut self, rate: f32, exp_of_minus_rate: f32) -> u32 {
        let mut left = self.uniform();
        let mut term = exp_of_minus_rate;
        let bound = saturating_u32(rate + 12.0 * libm::sqrtf(rate.max(0.0)) + 20.0).min(POISSON_MAX);
        for count in 0..bound {
            if left < term {
                return count;
            }
            left -= term;
            term *= rate / (nearest_f32(count) + 1.0);
        }
        bound
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The demonstration of the reference implementation: seed 42, stream 54.
    #[test]
    fn matches_the_reference_sequence() {
        let mut generator = Pcg32::new(42, 54);
        let expected = [0xa15c_02b7_u32, 0x7b47_f409, 0xba1d_3330, 0x83d2_f293, 0xbfa4_784b, 0xcbed_606e];
        for value in expected {
            assert_eq!(generator.next_u32(), value);
        }
    }

    fn moments(mut draw: impl FnMut() -> f64) -> (f64, f64) {
        let n = 200_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let value = draw();
            sum += value;
            squares += value * value;
        }
        let mean = sum / f64::from(n);
        (mean, squares / f64::from(n) - mean * mean)
    }

    /// Standard error of the mean over 200,000 draws is σ/447; five of them allowed.
    #[test]
    fn moments_are_those_of_the_distribution() {
        let mut generator = Pcg32::new(1, 2);
        let (mean, variance) = moments(|| f64::from(generator.normal()));
        assert!(mean.abs() < 0.012 && (variance - 1.0).abs() < 0.02);
        for rate in [0.05_f32, 1.0, 5.0, 25.0, 60.0] {
            let (mean, variance) = moments(|| f64::from(generator.poisson(rate)));
            let expected = f64::from(rate);
            assert!((mean - expected).abs() < 5.0 * expected.sqrt() / 447.0, "{rate} {mean}");
            assert!((variance - expected).abs() < 0.03 * expected + 0.01, "{rate} {variance}");
        }
        let (mean, variance) = moments(|| f64::from(generator.binomial(10, 0.9)));
        assert!((mean - 9.0).abs() < 0.012 && (variance - 0.9).abs() < 0.03);
        let (mean, _) = moments(|| f64::from(generator.round_randomly(2.3)));
        assert!((mean - 2.3).abs() < 0.006);
    }

    #[test]
    fn hostile_rates_are_bounded() {
        let mut generator = Pcg32::new(3, 4);
        for rate in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0] {
            assert_eq!(generator.poisson(rate), 0);
        }
        assert!(generator.poisson(f32::MAX) <= 208);
        assert_eq!(generator.below(0), 0);
    }
}
