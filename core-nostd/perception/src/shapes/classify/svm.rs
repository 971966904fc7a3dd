//! Support-vector machine with a radial kernel and a calibrated probability, as libsvm computes it. Source: book,
//! People: Support-vector machine.

/// Sigmoid that turns a decision value into a probability (Platt).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Platt {
    /// Slope, normally negative.
    pub a: f64,
    /// Offset.
    pub b: f64,
}

/// libsvm keeps probabilities this far from 0 and 1.
const PROBABILITY_MIN: f64 = 1.0e-7;

impl Platt {
    /// Probability of the first label, within [1e-7, 1 − 1e-7]. The branch keeps the exponential from overflowing.
    #[must_use]
    pub fn probability(&self, decision: f64) -> f64 {
        let t = self.a * decision + self.b;
        let p = if t >= 0.0 { libm::exp(-t) / (1.0 + libm::exp(-t)) } else { 1.0 / (1.0 + libm::exp(t)) };
        p.clamp(PROBABILITY_MIN, 1.0 - PROBABILITY_MIN)
    }
}

/// A two-class model. Borrowed: constant tables of `f32` on the target, a file's content in `f64` on the host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvmModel<'a, const DIMENSIONS: usize, Scalar = f32> {
    /// γ of the kernel exp(−γ‖x − s‖²).
    pub gamma: f64,
    /// Offset subtracted from the sum.
    pub rho: f64,
    /// Label of a positive and of a negative decision value.
    pub labels: [i32; 2],
    /// Signed weight of each support vector.
    pub weights: &'a [f64],
    /// Support vectors, scaled; entries that a sparse file leaves out are 0.
    pub vectors: &'a [[Scalar; DIMENSIONS]],
    /// Calibration, where the model has one.
    pub platt: Option<Platt>,
}

/// What a model says about a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// Signed distance from the border, in units of the margin.
    pub decision: f64,
    /// Label by the sign of the decision value.
    pub label: i32,
    /// Probability of label 1, where the model is calibrated.
    pub probability: Option<f64>,
}

impl<const DIMENSIONS: usize, Scalar: Copy + Into<f64>> SvmModel<'_, DIMENSIONS, Scalar> {
    /// Σ αᵢ exp(−γ‖x − sᵢ‖²) − ρ. Support vectors × dimensions multiplications.
    #[must_use]
    pub fn decision(&self, scaled: &[Scalar; DIMENSIONS]) -> f64 {
        let kernels = self
            .weights
            .iter()
            .zip(self.vectors)
            .map(|(weight, vector)| weight * libm::exp(-self.gamma * distance2(scaled, vector)));
        kernels.sum::<f64>() - self.rho
    }

    /// Decision, label and probability of a scaled vector.
    #[must_use]
    pub fn judge(&self, scaled: &[Scalar; DIMENSIONS]) -> Verdict {
        let decision = self.decision(scaled);
        let [positive, negative] = self.labels;
        let probability = self.platt.map(|platt| {
            let first = platt.probability(decision);
            if positive == 1 { first } else { 1.0 - first }
        });
        Verdict { decision, label: if decision > 0.0 { positive } else { negative }, probability }
    }
}

/// Sums that do not wait for each other.
const LANES: usize = 8;

/// Squared distance of two vectors. The order of the sum is fixed: same bits everywhere.
fn distance2<const DIMENSIONS: usize, Scalar: Copy + Into<f64>>(
    a: &[Scalar; DIMENSIONS],
    b: &[Scalar; DIMENSIONS],
) -> f64 {
    let mut lanes = [0.0_f64; LANES];
    for (a, b) in a.chunks(LANES).zip(b.chunks(LANES)) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            let difference: f64 = (*a).into() - (*b).into();
            *lane += difference * difference;
        }
    }
    lanes.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_class_is_decided_by_its_neighbour() {
        let model = SvmModel {
            gamma: 0.5,
            rho: 0.0,
            labels: [1, -1],
            weights: &[1.0, -1.0],
            vectors: &[[1.0_f32, 0.0], [-1.0, 0.0]],
            platt: Some(Platt { a: -2.0, b: 0.0 }),
        };
        let near = model.judge(&[0.9, 0.1]);
        assert!(near.label == 1 && near.probability.is_some_and(|p| p > 0.5), "{near:?}");
        assert_eq!(model.judge(&[-0.9, 0.1]).label, -1);
        // Between both: exp(−γ·1) cancels.
        assert!(model.decision(&[0.0, 0.3]).abs() < 1e-15);
    }

    #[test]
    fn probabilities_stay_inside_for_any_decision() {
        let platt = Platt { a: -2.258_88, b: -0.024_817_4 };
        for decision in [-1.0e9, -3.0, 0.0, 3.0, 1.0e9] {
            assert!((1.0e-7..=1.0 - 1.0e-7).contains(&platt.probability(decision)), "{decision}");
        }
    }
}
