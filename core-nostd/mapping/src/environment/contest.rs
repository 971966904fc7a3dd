//! Which of several formulas predicts best, judged by predictions made before the answer was known.
//!
//! Held-out data in fixed memory (book, Environment: Choice of model): every sample is first predicted, then learned.

/// Running mean losses of `FORMULAS` formulas, the simplest first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contest<const FORMULAS: usize> {
    sums: [f32; FORMULAS],
    weight: f32,
}

impl<const FORMULAS: usize> Default for Contest<FORMULAS> {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl<const FORMULAS: usize> Contest<FORMULAS> {
    /// Nothing predicted yet.
    pub const EMPTY: Self = Self { sums: [0.0; FORMULAS], weight: 0.0 };
    /// Share of the past that survives each sample: a week at one sample every ten minutes. What a formula got wrong
    /// while it knew little is forgiven.
    const KEPT: f32 = 0.999;
    /// A later formula must be better by this much, mean loss (book, Environment: Choice of model).
    const GAIN: f32 = 0.001;

    /// Takes the loss of each formula for one sample. A loss that is not finite: nothing is taken.
    pub fn add(&mut self, losses: &[f32; FORMULAS]) {
        if losses.iter().any(|loss| !loss.is_finite()) {
            return;
        }
        self.weight = self.weight * Self::KEPT + 1.0;
        for (sum, loss) in self.sums.iter_mut().zip(losses) {
            *sum = *sum * Self::KEPT + loss;
        }
    }

    /// Mean loss of a formula; 0 without samples.
    #[must_use]
    pub fn mean(&self, formula: usize) -> f32 {
        let sum = self.sums.get(formula).copied().unwrap_or_default();
        if self.weight > 0.0 { sum / self.weight } else { 0.0 }
    }

    /// The formula to predict with: a later one wins only by more than the gain.
    #[must_use]
    pub fn best(&self) -> usize {
        let mut best = 0;
        for formula in 1..FORMULAS {
            if self.mean(formula) < self.mean(best) - Self::GAIN {
                best = formula;
            }
        }
        best
    }

    /// The sums and their weight, to be kept in a file.
    #[must_use]
    pub const fn parts(&self) -> (&[f32; FORMULAS], f32) {
        (&self.sums, self.weight)
    }

    /// From what [`Self::parts`] gave.
    #[must_use]
    pub const fn from_parts(sums: [f32; FORMULAS], weight: f32) -> Self {
        Self { sums, weight }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_longer_formula_must_be_worth_it() {
        let mut contest = Contest::default();
        assert_eq!(contest.best(), 0);
        (0..50).for_each(|_| contest.add(&[0.5, 0.3, 0.2, 0.1995, 0.4]));
        assert_eq!(contest.best(), 2);
        contest.add(&[f32::NAN; 5]);
        assert!((contest.mean(1) - 0.3).abs() < 1e-5);
        (0..5_000).for_each(|_| contest.add(&[0.1, 0.3, 0.3, 0.3, 0.05]));
        assert_eq!(contest.best(), 4);
    }
}
