//! How fast dirt arrives: a Poisson process in every cell, learned between runs and predicted within them.
//!
//! The published work (Hess et al. 2013) is open only as an abstract; this is the conjugate Gamma–Poisson form of
//! the book, Cleaning: Dirt rate.

use floorguard_types::number::{nearest_f32, nearest_f32_of_f64};

use super::poisson::{negative_binomial_quantile, threshold_rate};

/// What is believed of the arrival rate of one cell: Gamma(shape, hours), mean shape/hours units per hour.
///
/// ```
/// use floorguard_mapping::{DirtRate, RunObservation};
///
/// // A day's dirt, all of it picked up: ten units.
/// let run = RunObservation { hours_since_cleaning: 24.0, measured_units: 10.0, observed_share: 1.0 };
/// let rate = DirtRate::PRIOR.observe(run);
/// assert!((rate.units_per_hour() - 11.0 / 48.0).abs() < 1.0e-6);
/// assert!((rate.predict(0.0, 48.0) - 11.0).abs() < 1.0e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirtRate {
    /// Shape a > 0: units seen so far, and the prior's.
    pub shape: f32,
    /// Rate b > 0, hours: time watched so far, and the prior's.
    pub hours: f32,
}

/// What one run saw of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunObservation {
    /// Hours since the cell was last cleaned, Δt > 0.
    pub hours_since_cleaning: f32,
    /// Units attributed to the cell, k ≥ 0; a fraction is allowed because hits are shared among the cells under the
    /// brush.
    pub measured_units: f32,
    /// Share of the dirt that the run was expected to pick up, e = coverage · (1 − (1−p)^m), within [0, 1].
    pub observed_share: f32,
}

impl Default for DirtRate {
    fn default() -> Self {
        Self::PRIOR
    }
}

impl DirtRate {
    /// The weak prior (book, Cleaning: Dirt rate): one unit a day, worth one unit of evidence.
    pub const PRIOR: Self = Self { shape: 1.0, hours: 24.0 };
    /// Share of the evidence that survives a run, so that old habits of the place fade (book, Cleaning: Dirt rate).
    pub const FORGETTING: f32 = 0.95;

    /// From the environment model: a mean rate in units per hour, worth `hours` of watching. Values that are not
    /// positive and finite give [`Self::PRIOR`].
    #[must_use]
    pub fn from_expectation(units_per_hour: f32, hours: f32) -> Self {
        let usable = units_per_hour > 0.0 && hours > 0.0 && (units_per_hour * hours).is_finite();
        if usable { Self { shape: units_per_hour * hours, hours } } else { Self::PRIOR }
    }

    /// Mean rate, units per hour.
    #[must_use]
    pub fn units_per_hour(&self) -> f32 {
        self.shape / self.hours.max(f32::MIN_POSITIVE)
    }

    /// Between runs: (a, b) ← (a + k, b + e·Δt). An observation with a negative or undefined number changes nothing.
    #[must_use]
    pub fn observe(self, run: RunObservation) -> Self {
        let exposure = run.observed_share.clamp(0.0, 1.0) * run.hours_since_cleaning;
        let usable = exposure >= 0.0 && exposure.is_finite() && run.measured_units >= 0.0;
        if !(usable && run.measured_units.is_finite()) {
            return self;
        }
        Self { shape: self.shape + run.measured_units, hours: self.hours + exposure }
    }

    /// Lets evidence fade towards the prior's mean by keeping `share` of it; within (0, 1].
    #[must_use]
    pub fn forget(self, share: f32) -> Self {
        let share = if share > 0.0 { share.min(1.0) } else { Self::FORGETTING };
        Self { shape: self.shape * share, hours: self.hours * share }
    }

    /// Within a run: λ₀ = what the last run left + r̂·Δt.
    #[must_use]
    pub fn predict(&self, residual_units: f32, hours: f32) -> f32 {
        residual_units.max(0.0) + self.units_per_hour() * hours.max(0.0)
    }

    /// As [`Self::predict`], but keeps the doubt about the rate: the λ whose (1−δ) quantile is that of the negative
    /// binomial prediction. Never below the plain prediction.
    #[must_use]
    pub fn predict_conservatively(&self, residual_units: f32, hours: f32, delta: f64) -> f32 {
        let plain = self.predict(residual_units, hours);
        let quantile = negative_binomial_quantile(
            1.0 - delta,
            f64::from(self.shape),
            f64::from(self.hours),
            f64::from(hours.max(0.0)),
        );
        let equivalent = nearest_f32_of_f64(threshold_rate(quantile, delta)) + residual_units.max(0.0);
        plain.max(equivalent)
    }
}

/// e: expected share of the dirt picked up in `passes` passes, each with `pickup_probability`, over `coverage`.
#[must_use]
pub fn observed_share(pickup_probability: f32, passes: u8, coverage: f32) -> f32 {
    let left = libm::powf((1.0 - pickup_probability).clamp(0.0, 1.0), f32::from(passes));
    coverage.clamp(0.0, 1.0) * (1.0 - left)
}

/// Shares `hits` among the cells under the brush in proportion to their expected removal P_i·λ_i (Poisson thinning).
/// Without any expectation the hits are shared equally.
pub fn attribute_hits(hits: f32, removals: &mut [f32]) {
    let sum: f32 = removals.iter().sum();
    let count = nearest_f32(removals.len());
    for removal in removals {
        *removal = if sum > 0.0 { hits * *removal / sum } else { hits / count.max(1.0) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test values of the book, Cleaning: Dirt rate.
    #[test]
    fn golden_vector() {
        let run = RunObservation { hours_since_cleaning: 12.0, measured_units: 5.0, observed_share: 0.9 };
        let rate = DirtRate::PRIOR.observe(run);
        assert_eq!(rate.shape, 6.0);
        assert!((rate.hours - 34.8).abs() < 1e-5);
        assert!((rate.units_per_hour() - 0.172_414).abs() < 1e-6);
        assert!((rate.predict(0.0, 24.0) - 4.138).abs() < 1e-3);
        // SciPy: nbinom.ppf(.99, 6, 34.8/58.8) = 12, and λ*(12, .01) = 6.0991.
        assert!((rate.predict_conservatively(0.0, 24.0, 0.01) - 6.099_1).abs() < 1e-3);
    }

    #[test]
    fn learns_the_true_rate_over_many_runs() {
        let mut generator = floorguard_types::random::Pcg32::new(11, 0);
        let mut rate = DirtRate::PRIOR;
        for _ in 0..400 {
            let units = generator.poisson(0.5 * 12.0 * 0.9) as f32;
            rate = rate.observe(RunObservation {
                hours_since_cleaning: 12.0,
                measured_units: units,
                observed_share: observed_share(0.9, 1, 1.0),
            });
        }
        assert!((rate.units_per_hour() - 0.5).abs() < 0.05, "{rate:?}");
        let faded = rate.forget(0.5);
        assert!((faded.units_per_hour() - rate.units_per_hour()).abs() < 1e-5 && faded.hours < rate.hours);
    }

    #[test]
    fn hits_are_shared_by_expected_removal() {
        let mut removals = [3.0, 1.0, 0.0];
        attribute_hits(8.0, &mut removals);
        assert_eq!(removals, [6.0, 2.0, 0.0]);
        let mut nothing_expected = [0.0, 0.0];
        attribute_hits(3.0, &mut nothing_expected);
        assert_eq!(nothing_expected, [1.5, 1.5]);
    }

    #[test]
    fn nonsense_teaches_nothing() {
        for bad in [f32::NAN, -1.0, f32::INFINITY] {
            let run = RunObservation { hours_since_cleaning: bad, measured_units: 1.0, observed_share: 0.5 };
            assert_eq!(DirtRate::PRIOR.observe(run), DirtRate::PRIOR);
            assert_eq!(DirtRate::from_expectation(bad, 1.0), DirtRate::PRIOR);
        }
    }
}
