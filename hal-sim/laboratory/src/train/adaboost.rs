//! AdaBoost on decision stumps, as the book, Legs: Committees, defines it.

use floorguard_perception::legs::{Stump, score};

use super::boosting::Sample;

/// Errors are kept this far from 0, so that a perfect comparison has a finite vote.
const ERROR_MIN: f64 = 1.0e-6;

/// Learns a committee. Exact: every border between two neighbouring values is tried, and a constant answer. The same samples give the same
/// committee.
#[must_use]
pub fn adaboost<const FEATURES: usize>(samples: &[Sample<FEATURES>], rounds: usize) -> Vec<Stump> {
    let count = samples.len();
    let mut weights = vec![1.0 / count.max(1) as f64; count];
    let orders: Vec<Vec<usize>> = (0..FEATURES)
        .map(|feature| {
            let mut order: Vec<usize> = (0..count).collect();
            order.sort_by(|a, b| samples[*a].features[feature].total_cmp(&samples[*b].features[feature]));
            order
        })
        .collect();
    let mut stumps = Vec::new();
    for _ in 0..rounds {
        let (error, mut stump) = best_stump(samples, &weights, &orders);
        if error >= 0.5 {
            break;
        }
        let error = error.max(ERROR_MIN);
        let vote = 0.5 * ((1.0 - error) / error).ln();
        stump.vote *= vote as f32;
        let mut sum = 0.0;
        for (weight, sample) in weights.iter_mut().zip(samples) {
            let above = sample.features[usize::from(stump.feature)] > stump.threshold;
            let says = above == (stump.vote > 0.0);
            *weight *= if says == sample.positive { (-vote).exp() } else { vote.exp() };
            sum += *weight;
        }
        weights.iter_mut().for_each(|weight| *weight /= sum);
        stumps.push(stump);
    }
    stumps
}

/// The constant vote that puts the best balance of precision and recall on these samples at score 0: legs are rare, and
/// a committee that counts errors would rather miss them.
#[must_use]
pub fn lean<const FEATURES: usize>(stumps: &[Stump], samples: &[Sample<FEATURES>]) -> Stump {
    let mut scores: Vec<(f32, bool)> =
        samples.iter().map(|sample| (score(stumps, &sample.features), sample.positive)).collect();
    scores.sort_by(|a, b| b.0.total_cmp(&a.0));
    let positives = scores.iter().filter(|(_, positive)| *positive).count();
    let (mut right, mut best, mut cut) = (0_u32, -1.0, 0.0);
    for (index, (value, positive)) in scores.iter().enumerate() {
        right += u32::from(*positive);
        let Some((next, _)) = scores.get(index + 1).filter(|(next, _)| next < value) else { continue };
        let f1 = 2.0 * f64::from(right) / (index + 1 + positives) as f64;
        if f1 > best {
            (best, cut) = (f1, 0.5 * (value + next));
        }
    }
    Stump { feature: 0, threshold: f32::MIN, vote: -cut }
}

/// The comparison with the least weighted error; its vote is ±1.
fn best_stump<const FEATURES: usize>(
    samples: &[Sample<FEATURES>],
    weights: &[f64],
    orders: &[Vec<usize>],
) -> (f64, Stump) {
    let positive: f64 = samples.iter().zip(weights).filter(|(each, _)| each.positive).map(|(_, w)| w).sum();
    let negative: f64 = weights.iter().sum::<f64>() - positive;
    // Without a constant vote a committee cannot lean to the commoner answer.
    let constant = |vote| Stump { feature: 0, threshold: f32::MIN, vote };
    let mut best = if negative < positive { (negative, constant(1.0)) } else { (positive, constant(-1.0)) };
    for (feature, order) in orders.iter().enumerate() {
        // Everything is above: the error of calling all positive is the weight of the negatives.
        let mut error_above = negative;
        for (place, index) in order.iter().enumerate() {
            let sample = &samples[*index];
            error_above += if sample.positive { weights[*index] } else { -weights[*index] };
            let value = sample.features[feature];
            let next = order.get(place + 1).map(|next| samples[*next].features[feature]);
            let Some(next) = next.filter(|next| *next > value) else { continue };
            let error_below = positive + negative - error_above;
            for (error, vote) in [(error_above, 1.0), (error_below, -1.0)] {
                if error < best.0 {
                    let threshold = value + 0.5 * (next - value);
                    best = (error, Stump { feature: feature as u8, threshold, vote });
                }
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(x: f32, y: f32, positive: bool) -> Sample<2> {
        Sample { features: [x, y], positive }
    }

    #[test]
    fn one_comparison_is_found_exactly() {
        let samples = [
            sample(1.0, 5.0, false),
            sample(2.0, 4.0, false),
            sample(3.0, 6.0, true),
            sample(9.0, 1.0, true),
        ];
        let stumps = adaboost(&samples, 1);
        assert_eq!((stumps[0].feature, stumps[0].threshold), (0, 2.5));
        assert!(stumps[0].vote > 6.0 && stumps[0].vote < 7.0, "½ ln of a million: {}", stumps[0].vote);
    }

    /// A band: below 1 and above 2 is negative. One stump cannot, a committee can.
    #[test]
    fn a_committee_learns_a_band() {
        let samples: Vec<_> =
            (0..60).map(|step| 0.05 * step as f32).map(|x| sample(x, 0.0, (1.0..2.0).contains(&x))).collect();
        let wrong = |rounds| {
            let stumps = adaboost(&samples, rounds);
            samples.iter().filter(|each| (score(&stumps, &each.features) > 0.0) != each.positive).count()
        };
        assert!(wrong(1) >= 15);
        assert_eq!(wrong(30), 0);
    }

    /// One positive among three where the number is high: few errors are made by never claiming one, but all are missed.
    #[test]
    fn a_lean_finds_what_is_rare() {
        let samples: Vec<_> =
            (0..40).map(|step| sample(step as f32, 0.0, step > 30 && step % 3 == 0)).collect();
        let stumps = [
            Stump { feature: 0, threshold: 30.5, vote: 0.2 },
            Stump { feature: 1, threshold: -1.0, vote: -0.5 },
        ];
        let claimed =
            |stumps: &[Stump]| samples.iter().filter(|each| score(stumps, &each.features) > 0.0).count();
        assert_eq!(claimed(&stumps), 0);
        let [a, b] = stumps;
        assert_eq!(claimed(&[a, b, lean(&stumps, &samples)]), 9);
    }
}
