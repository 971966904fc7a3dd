//! Weights that sum to one, and drawing particles by them.

use floorguard_types::number::{nearest_f32, saturating_usize};
use floorguard_types::random::Pcg32;

/// Turns logarithms of weights into weights that sum to 1 (log-sum-exp). Returns the effective number of particles,
/// 1/Σw². `None` if no weight was usable: the weights are then uniform and the caller must flag it.
///
/// ```
/// use floorguard_localisation::normalise;
///
/// let mut weights = [0.0; 4];
/// let effective = normalise(&[f32::NAN, 0.0, f32::NEG_INFINITY, 0.0], &mut weights);
/// assert_eq!((weights, effective), ([0.0, 0.5, 0.0, 0.5], Some(2.0)));
/// ```
pub fn normalise<const N: usize>(log_weights: &[f32; N], weights: &mut [f32; N]) -> Option<f32> {
    let uniform = 1.0 / nearest_f32(N).max(1.0);
    let largest = log_weights.iter().copied().filter(|w| w.is_finite()).fold(f32::NEG_INFINITY, f32::max);
    if !largest.is_finite() {
        *weights = [uniform; N];
        return None;
    }
    let mut sum = 0.0_f32;
    for (weight, &logarithm) in weights.iter_mut().zip(log_weights) {
        *weight = if logarithm.is_finite() { libm::expf(logarithm - largest) } else { 0.0 };
        sum += *weight;
    }
    // The largest contributes exactly 1.
    let mut squares = 0.0_f32;
    for weight in weights.iter_mut() {
        *weight /= sum;
        squares += *weight * *weight;
    }
    debug_assert!(squares > 0.0 && squares < 1.001, "weights that sum to 1 have squares of {squares}");
    Some(1.0 / squares)
}

/// Systematic resampling: one uniform number, N equally spaced marks. `parents[k]` is the particle that k continues.
///
/// ```
/// use floorguard_localisation::systematic;
/// use floorguard_types::random::Pcg32;
///
/// let mut parents = [9; 4];
/// systematic(&[0.0, 0.5, 0.0, 0.5], &mut Pcg32::new(1, 1), &mut parents);
/// assert_eq!(parents, [1, 1, 3, 3]);
/// ```
pub fn systematic<const N: usize>(weights: &[f32; N], random: &mut Pcg32, parents: &mut [u16; N]) {
    let mut filled = 0_usize;
    let mut cumulated = 0.0_f32;
    let first = random.uniform();
    let mut last_parent = 0_u16;
    for (&weight, index) in weights.iter().zip(0_u16..) {
        cumulated += weight;
        if weight <= 0.0 {
            continue;
        }
        last_parent = index;
        // Marks at (k + u)/N below the cumulated weight belong to this particle.
        let until = saturating_usize(libm::ceilf(cumulated * nearest_f32(N) - first).max(0.0));
        let until = until.min(N);
        for parent in parents.iter_mut().take(until).skip(filled) {
            *parent = index;
        }
        filled = filled.max(until);
    }
    // Rounding can leave the last marks open.
    for parent in parents.iter_mut().skip(filled) {
        *parent = last_parent;
    }
    debug_assert!(parents.is_sorted(), "marks are taken in order");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_particle_gets_its_share_within_one() {
        let mut random = Pcg32::new(4, 4);
        let mut log_weights = [0.0_f32; 500];
        for weight in &mut log_weights {
            *weight = 3.0 * random.normal() - 1_000.0;
        }
        let mut weights = [0.0; 500];
        let effective = normalise(&log_weights, &mut weights).unwrap();
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-4 && effective > 1.0 && effective < 500.0);
        for _ in 0..100 {
            let mut parents = [0; 500];
            systematic(&weights, &mut random, &mut parents);
            for (index, weight) in weights.iter().enumerate() {
                let count = parents.iter().filter(|&&p| usize::from(p) == index).count() as f32;
                assert!((count - weight * 500.0).abs() < 1.01, "{index}: {count} for {}", weight * 500.0);
            }
        }
    }

    #[test]
    fn unusable_weights_become_uniform_and_are_reported() {
        let mut weights = [0.0; 4];
        assert_eq!(
            normalise(&[f32::NEG_INFINITY, f32::NAN, f32::NEG_INFINITY, f32::NAN], &mut weights),
            None
        );
        assert_eq!(weights, [0.25; 4]);
        let effective = normalise(&[f32::NAN, 0.0, f32::NEG_INFINITY, 0.0], &mut weights).unwrap();
        assert_eq!((weights, effective), ([0.0, 0.5, 0.0, 0.5], 2.0));
    }
}
