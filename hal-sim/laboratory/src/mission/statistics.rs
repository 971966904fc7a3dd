//! The little statistics that the reports need: intervals for shares, paired t-tests.

/// Wilson 95 % interval of a share. No observations: everything is possible.
#[must_use]
pub fn wilson95(successes: u64, all: u64) -> (f64, f64) {
    if all == 0 {
        return (0.0, 1.0);
    }
    let (k, n, z) = (successes as f64, all as f64, 1.959_964);
    let share = k / n;
    let middle = share + z * z / (2.0 * n);
    let spread = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + z * z / n;
    (((middle - spread) / scale).max(0.0), ((middle + spread) / scale).min(1.0))
}

/// Mean of some values; 0 of none.
#[must_use]
pub fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u32);
    for value in values {
        sum += value;
        count += 1;
    }
    sum / f64::from(count.max(1))
}

/// A paired t-test of "the first is smaller than the second".
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PairedTest {
    /// Pairs.
    pub pairs: usize,
    /// Mean of second minus first.
    pub mean_difference: f64,
    /// The statistic.
    pub t: f64,
    /// One-sided probability of a difference this large by chance.
    pub p: f64,
}

/// Compares pairs. Fewer than two pairs, or pairs that never differ, prove nothing: p = 1.
#[must_use]
pub fn paired_t_test(first: &[f64], second: &[f64]) -> PairedTest {
    let differences: Vec<f64> = first.iter().zip(second).map(|(a, b)| b - a).collect();
    let pairs = differences.len();
    let average = mean(differences.iter().copied());
    let squares: f64 = differences.iter().map(|d| (d - average).powi(2)).sum();
    let nothing = PairedTest { pairs, mean_difference: average, t: 0.0, p: 1.0 };
    if pairs < 2 {
        return nothing;
    }
    let degrees = (pairs - 1) as f64;
    let error = (squares / degrees / pairs as f64).sqrt();
    if error <= 0.0 {
        // All pairs differ by the same amount: certain if that amount is positive.
        return if average > 0.0 { PairedTest { t: f64::INFINITY, p: 0.0, ..nothing } } else { nothing };
    }
    let t = average / error;
    let tail = 0.5 * incomplete_beta(0.5 * degrees, 0.5, degrees / (degrees + t * t));
    PairedTest { t, p: if t > 0.0 { tail } else { 1.0 - tail }, ..nothing }
}

/// Regularised incomplete beta function by its continued fraction (Lentz; Abramowitz & Stegun 26.5.8).
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, 1.0 - x);
    }
    let front =
        (libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * x.ln() + b * (1.0 - x).ln()).exp() / a;
    let guard = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let (mut c, mut d) = (1.0, 1.0 / guard(1.0 - (a + b) * x / (a + 1.0)));
    let mut result = d;
    for step in 1..=300 {
        let m = f64::from(step);
        for term in [
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)),
        ] {
            d = 1.0 / guard(1.0 + term * d);
            c = guard(1.0 + term / c);
            result *= c * d;
        }
        if (c * d - 1.0).abs() < 1e-14 {
            break;
        }
    }
    front * result
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SciPy 1.17: `ttest_rel(b, a, alternative="greater")`, `t.sf`, and statsmodels' Wilson interval.
    #[test]
    fn agrees_with_scipy() {
        let a = [1.0, 2.0, 3.0, 4.0, 5.0];
        let b = [1.5, 2.1, 3.9, 4.2, 5.6];
        let test = paired_t_test(&a, &b);
        assert!((test.t - 3.204_971_9).abs() < 1e-6, "{test:?}");
        assert!((test.p - 0.016_372_7).abs() < 1e-6, "{test:?}");
        assert!((paired_t_test(&b, &a).p - (1.0 - test.p)).abs() < 1e-12);
        let (low, high) = wilson95(32, 35);
        assert!((low - 0.776).abs() < 1e-3 && (high - 0.970).abs() < 1e-3);
    }

    #[test]
    fn nothing_proves_nothing() {
        assert_eq!(wilson95(0, 0), (0.0, 1.0));
        assert_eq!(paired_t_test(&[1.0], &[2.0]).p, 1.0);
        assert_eq!(paired_t_test(&[1.0, 1.0], &[1.0, 1.0]).p, 1.0);
    }
}
