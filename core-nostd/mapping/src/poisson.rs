//! Tails of the Poisson law: how much dirt a cell may still hold.
//!
//! The guarantee asks whether the (1−δ) quantile of Poisson(λ) exceeds τ. That is the same as λ > λ*(τ, δ), so one
//! bisection at start turns the test of every cell into one comparison (book, Cleaning: Poisson tails).

use floorguard_types::number::saturating_u32_of_f64;

/// Largest rate that the forward recurrence takes: e⁻⁷⁰⁰ is still a normal f64.
const RATE_MAX: f64 = 700.0;
/// Most terms of a sum: 40 deviations above the largest rate are 1,819.
const TERMS_MAX: u32 = 2_048;
/// Most counts that the negative binomial search examines.
const COUNTS_MAX: u32 = 1_000_000;

/// P(D ≤ count) for D ~ Poisson(rate). A rate below 0 or not finite gives NaN-free bounds: 1 for ≤ 0, 0 for the rest.
#[must_use]
pub fn poisson_cdf(count: u32, rate: f64) -> f64 {
    if rate <= 0.0 {
        return 1.0;
    }
    if !rate.is_finite() || rate > RATE_MAX {
        return 0.0;
    }
    let mut term = libm::exp(-rate);
    let mut sum = term;
    // Terms beyond the mean by 40 deviations add nothing, which also bounds the loop.
    let last = count.min(saturating_u32_of_f64(rate + 40.0 * libm::sqrt(rate) + 60.0));
    for i in 0..last.min(TERMS_MAX) {
        term *= rate / (f64::from(i) + 1.0);
        sum += term;
    }
    sum.min(1.0)
}

/// P(D > count) for D ~ Poisson(rate).
#[must_use]
pub fn poisson_tail(count: u32, rate: f64) -> f64 {
    1.0 - poisson_cdf(count, rate)
}

/// Smallest count whose cumulative probability reaches `confidence`; the search ends at λ + 10√λ + 20.
#[must_use]
pub fn poisson_quantile(confidence: f64, rate: f64) -> u32 {
    let rate = if rate.is_finite() { rate.clamp(0.0, RATE_MAX) } else { RATE_MAX };
    let bound = saturating_u32_of_f64(rate + 10.0 * libm::sqrt(rate) + 20.0).min(TERMS_MAX);
    let mut term = libm::exp(-rate);
    let mut sum = term;
    for count in 0..bound {
        if sum >= confidence {
            return count;
        }
        term *= rate / (f64::from(count) + 1.0);
        sum += term;
    }
    bound
}

/// λ*(τ, δ): the largest rate of which at most δ of the draws exceed τ. Sixty halvings of [0, τ + 20]; accurate to
/// 1e-12 for δ within (0, 1). A δ of 0 or less gives 0: nothing is ever clean enough.
///
/// ```
/// use floorguard_mapping::{poisson_tail, threshold_rate};
///
/// // At which mean do at most 1 % of all cells hold more than five units?
/// let rate = threshold_rate(5, 0.01);
/// assert!((rate - 1.785_3).abs() < 1.0e-3);
/// assert!((poisson_tail(5, rate) - 0.01).abs() < 1.0e-9);
/// ```
#[must_use]
pub fn threshold_rate(tolerated_units: u32, delta: f64) -> f64 {
    if delta.is_nan() || delta <= 0.0 {
        return 0.0;
    }
    let mut low = 0.0;
    let mut high = f64::from(tolerated_units) + 20.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if poisson_tail(tolerated_units, middle) <= delta {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Quantile of the negative binomial law that a Poisson rate with Gamma(shape, rate) doubt predicts over `exposure`;
/// the search ends at 4·mean + 60 (book, Cleaning: Dirt rate).
#[must_use]
pub fn negative_binomial_quantile(confidence: f64, shape: f64, rate: f64, exposure: f64) -> u32 {
    if !(shape > 0.0 && rate > 0.0 && exposure > 0.0) {
        return 0;
    }
    let success = rate / (rate + exposure);
    let mut term = libm::pow(success, shape);
    let mut sum = term;
    let bound = saturating_u32_of_f64(4.0 * shape * exposure / rate + 60.0).min(COUNTS_MAX);
    for count in 0..bound {
        if sum >= confidence {
            return count;
        }
        term *= (f64::from(count) + shape) / (f64::from(count) + 1.0) * (1.0 - success);
        sum += term;
    }
    bound
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of the book, Cleaning: Poisson tails, δ = 0.01.
    #[test]
    fn threshold_rates_of_the_table() {
        let table = [
            (0, 0.010_050),
            (1, 0.148_555),
            (2, 0.436_045),
            (3, 0.823_249),
            (4, 1.279_106),
            (5, 1.785_284),
            (6, 2.330_213),
            (8, 3.507_455),
            (10, 4.771_246),
        ];
        for (tolerated, rate) in table {
            assert!((threshold_rate(tolerated, 0.01) - rate).abs() < 6e-7, "τ={tolerated}");
        }
        assert_eq!(threshold_rate(5, 0.0), 0.0);
    }

    #[test]
    fn quantiles_of_the_table() {
        let table = [
            (1.0, 4),
            (2.0, 6),
            (2.5, 7),
            (5.0, 11),
            (10.0, 18),
            (15.0, 25),
            (20.0, 31),
            (25.0, 37),
            (30.0, 43),
        ];
        for (rate, quantile) in table {
            assert_eq!(poisson_quantile(0.99, rate), quantile, "λ={rate}");
        }
    }

    /// P(4; λ = 3) = 0.168031 as a difference of the cumulative law, and values computed with SciPy 1.17
    /// (`poisson.cdf`, `nbinom.ppf`).
    #[test]
    fn agrees_with_the_vectors_and_with_scipy() {
        assert!((poisson_cdf(4, 3.0) - poisson_cdf(3, 3.0) - 0.168_031).abs() < 1e-6);
        assert!(
            (poisson_cdf(60, 80.0) / 0.011_921_574_017_520_444 - 1.0).abs() < 1e-9,
            "{}",
            poisson_cdf(60, 80.0)
        );
        assert_eq!(negative_binomial_quantile(0.99, 6.0, 34.8, 24.0), 12);
    }

    #[test]
    fn quantile_test_and_rate_test_agree() {
        for tolerated in [0_u32, 3, 5, 9] {
            for delta in [0.001, 0.01, 0.05] {
                let limit = threshold_rate(tolerated, delta);
                for step in 0..200 {
                    let rate = f64::from(step) * 0.05 + 0.001;
                    let exceeds = poisson_quantile(1.0 - delta, rate) > tolerated;
                    assert_eq!(exceeds, rate > limit, "τ={tolerated} δ={delta} λ={rate}");
                }
            }
        }
    }

    #[test]
    fn hostile_arguments_stay_bounded() {
        assert_eq!(poisson_cdf(3, f64::NAN).to_bits(), 0.0_f64.to_bits());
        assert_eq!(poisson_cdf(u32::MAX, 1e300), 0.0);
        assert_eq!(poisson_cdf(0, -1.0), 1.0);
        assert!(poisson_quantile(2.0, f64::NAN) < 2_000);
        assert_eq!(negative_binomial_quantile(0.99, f64::NAN, 1.0, 1.0), 0);
    }
}
