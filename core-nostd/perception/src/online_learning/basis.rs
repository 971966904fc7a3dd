//! Random waves in place of a radial kernel: their sums can bend any border, with constant memory.
//!
//! `z(x) = √(2/D) · cos(Ωx + b)` with normal Ω and even b approximates exp(−γ‖x − y‖²) (Rahimi and Recht 2007; book,
//! Online learning: Random waves). The waves follow from a seed, so a file needs no more than the weights.

use crate::shapes::shape::{SHAPE_FEATURES, ShapeVector};
use floorguard_types::number::nearest_f32;
use floorguard_types::random::Pcg32;

/// Waves.
pub const BASIS: usize = 128;
/// Seed of the waves: weights of another seed are worth nothing.
const SEED: u64 = 0xBA5E;
/// Width of the kernel, of standardised shapes: published 0.02 for 61 features, so that the exponent has the same mean.
const GAMMA: f32 = 0.05;

/// The waves and what shapes are standardised with.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    waves: [[f32; SHAPE_FEATURES]; BASIS],
    phases: [f32; BASIS],
    means: ShapeVector,
    scales: ShapeVector,
}

impl Basis {
    /// Waves over shapes like these: their means and spreads are the units. Without any, metres.
    #[must_use]
    pub fn new<'a>(shapes: impl Iterator<Item = &'a ShapeVector> + Clone) -> Self {
        let mut random = Pcg32::new(SEED, 1);
        let spread = libm::sqrtf(2.0 * GAMMA);
        let mut basis = Self {
            waves: [[0.0; SHAPE_FEATURES]; BASIS],
            phases: [0.0; BASIS],
            means: [0.0; SHAPE_FEATURES],
            scales: [1.0; SHAPE_FEATURES],
        };
        for wave in &mut basis.waves {
            for value in wave {
                *value = spread * random.normal();
            }
        }
        for phase in &mut basis.phases {
            *phase = random.uniform_between(0.0, core::f32::consts::TAU);
        }
        for (feature, (mean, scale)) in basis.means.iter_mut().zip(&mut basis.scales).enumerate() {
            let values =
                shapes.clone().filter_map(|shape| shape.get(feature)).filter(|value| value.is_finite());
            let (mut sum, mut squares, mut count) = (0.0_f32, 0.0_f32, 0.0_f32);
            for value in values {
                sum += value;
                squares += value * value;
                count += 1.0;
            }
            if count >= 2.0 {
                *mean = sum / count;
                let variance = (squares / count - *mean * *mean).max(0.0);
                *scale = 1.0 / libm::sqrtf(variance).max(1.0e-3);
            }
        }
        basis
    }

    /// The waves at a shape. A non-finite number counts as average.
    pub(super) fn at(&self, shape: &ShapeVector) -> [f32; BASIS] {
        let mut standard = [0.0; SHAPE_FEATURES];
        let units = self.means.iter().zip(&self.scales);
        for ((out, value), (mean, scale)) in standard.iter_mut().zip(shape).zip(units) {
            let scaled = (value - mean) * scale;
            // Beyond four spreads a wave would mean nothing.
            *out = if scaled.is_finite() { scaled.clamp(-4.0, 4.0) } else { 0.0 };
        }
        let height = libm::sqrtf(2.0 / nearest_f32(BASIS));
        let mut found = [0.0; BASIS];
        for (out, (wave, phase)) in found.iter_mut().zip(self.waves.iter().zip(self.phases)) {
            let angle: f32 = wave.iter().zip(standard).map(|(a, b)| a * b).sum();
            *out = height * libm::cosf(angle + phase);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The product of two waves is the radial kernel, to the accuracy of 128 waves.
    #[test]
    fn products_approximate_the_kernel() {
        let basis = Basis::new([].iter());
        let mut random = Pcg32::new(3, 3);
        let mut worst = 0.0_f32;
        for _ in 0..50 {
            let (mut a, mut b, mut squared) = ([0.0; SHAPE_FEATURES], [0.0; SHAPE_FEATURES], 0.0);
            for (x, y) in a.iter_mut().zip(&mut b) {
                (*x, *y) = (random.uniform_between(-1.0, 1.0), random.uniform_between(-1.0, 1.0));
                squared += (*x - *y) * (*x - *y);
            }
            let product: f32 = basis.at(&a).iter().zip(basis.at(&b)).map(|(x, y)| x * y).sum();
            worst = worst.max((product - libm::expf(-GAMMA * squared)).abs());
        }
        assert!(worst < 0.35, "{worst}");
        let broken = basis.at(&[f32::NAN; SHAPE_FEATURES]);
        assert!(broken.iter().all(|value| value.is_finite()));
    }
}
