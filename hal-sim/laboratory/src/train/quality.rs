//! What a classifier is worth on samples that it has not seen.

use floorguard_perception::people::person_model::probability;
use serde::Serialize;

use super::boosting::{Forest, Sample};

/// Figures at probability one half, and how far probabilities can be taken at their word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quality {
    /// Samples.
    pub samples: usize,
    /// Of them positive.
    pub positives: usize,
    /// Share of what is called positive that is.
    pub precision: f64,
    /// Share of the positives that are found.
    pub recall: f64,
    /// Mean of −ln of the probability given to the truth.
    pub log_loss: f64,
    /// Mean difference of probability and share of positives, over ten bins of probability, weighted by their samples.
    pub calibration_error: f64,
}

/// Measures.
#[must_use]
pub fn quality<const FEATURES: usize>(forest: &Forest, samples: &[Sample<FEATURES>]) -> Quality {
    let mut bins = [(0.0_f64, 0.0_f64, 0.0_f64); 10];
    let (mut called, mut right, mut loss) = (0, 0, 0.0);
    for sample in samples {
        let p = f64::from(probability(forest.log_odds(&sample.features)));
        let truth = f64::from(u8::from(sample.positive));
        called += usize::from(p >= 0.5);
        right += usize::from(p >= 0.5 && sample.positive);
        loss -= (truth * p + (1.0 - truth) * (1.0 - p)).max(1.0e-9).ln();
        let bin = &mut bins[((p * 10.0) as usize).min(9)];
        *bin = (bin.0 + 1.0, bin.1 + p, bin.2 + truth);
    }
    let positives = samples.iter().filter(|sample| sample.positive).count();
    let count = samples.len().max(1) as f64;
    Quality {
        samples: samples.len(),
        positives,
        precision: right as f64 / called.max(1) as f64,
        recall: right as f64 / positives.max(1) as f64,
        log_loss: loss / count,
        calibration_error: bins.iter().map(|(_, p, truth)| (p - truth).abs()).sum::<f64>() / count,
    }
}
