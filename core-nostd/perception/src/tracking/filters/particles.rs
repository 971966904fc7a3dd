//! A particle filter of a walker (sampling, importance, resampling), for comparison. Source: book, Tracking: Filters.
//!
//! A thousand particles take 16 KiB a person: not for the MCU.

use nalgebra::{Matrix4, Vector4};

use super::gaussian::{Degenerate, Gaussian, Surprise, surprise};
use super::{Observation, PersonFilter};
use floorguard_types::number::nearest_f32;
use floorguard_types::random::Pcg32;

/// The particles of one person.
#[derive(Clone, Debug)]
pub struct Particles<const N: usize> {
    particles: [Vector4<f32>; N],
    random: Pcg32,
    /// Measurements that no particle could explain; the prediction was kept.
    pub unexplained: u32,
}

impl<const N: usize> Particles<N> {
    /// Drawn around a first belief, of which the covariance is taken as diagonal. The same seed gives the same run.
    #[must_use]
    pub fn new(belief: &Gaussian, seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 50);
        let sigma = belief.covariance.diagonal().map(|variance| libm::sqrtf(variance.max(0.0)));
        let mut particles = [belief.mean; N];
        for particle in &mut particles {
            *particle += sigma.component_mul(&normals(&mut random));
        }
        Self { particles, random, unexplained: 0 }
    }

    fn count() -> f32 {
        nearest_f32(N.max(1))
    }

    /// Spreads copies by K·(max − min)·N^(−1/4); K is 0.2: with the usual 1 the spread of the copies would be many
    /// times that of the belief.
    fn roughen(&mut self) {
        let first = self.particles.first().copied().unwrap_or_default();
        let (mut low, mut high) = (first, first);
        for particle in &self.particles {
            low = low.inf(particle);
            high = high.sup(particle);
        }
        let share = 0.2 / libm::sqrtf(libm::sqrtf(Self::count()));
        let sigma = (high - low) * share;
        let Self { particles, random, .. } = self;
        for particle in particles {
            *particle += sigma.component_mul(&normals(random));
        }
    }
}

/// Four independent standard normal numbers.
fn normals(random: &mut Pcg32) -> Vector4<f32> {
    Vector4::new(random.normal(), random.normal(), random.normal(), random.normal())
}

impl<const N: usize> PersonFilter for Particles<N> {
    /// White acceleration of the density, as one push during the step: the same covariance of the velocity.
    fn predict(&mut self, seconds: f32, density: f32) {
        let t = seconds.max(0.0);
        let sigma_v = libm::sqrtf(density * t);
        let sigma_x = libm::sqrtf(density * t * t * t / 12.0);
        let Self { particles, random, .. } = self;
        for particle in particles {
            let pushes = normals(random);
            let (dx, dy) = (pushes.x * sigma_v, pushes.z * sigma_v);
            particle.x += t * particle.y + 0.5 * t * dx + sigma_x * pushes.y;
            particle.z += t * particle.w + 0.5 * t * dy + sigma_x * pushes.w;
            particle.y += dx;
            particle.w += dy;
        }
    }

    fn surprise(&self, seen: &Observation) -> Result<Surprise, Degenerate> {
        let Gaussian { mean, covariance } = self.gaussian();
        let jacobian = seen.jacobian(&mean);
        let innovation = seen.difference(seen.measured(), seen.expected(&mean));
        surprise(innovation, &(jacobian * covariance * jacobian.transpose() + seen.noise()))
    }

    /// Weights by the likelihood, resamples systematically, spreads the copies. Linear in the particles.
    fn update(&mut self, seen: &Observation) -> Result<(), Degenerate> {
        let noise = seen.noise();
        let mut weights = [0.0_f32; N];
        let mut sum = 0.0;
        for (weight, particle) in weights.iter_mut().zip(&self.particles) {
            let away = seen.difference(seen.measured(), seen.expected(particle));
            *weight = libm::expf(-0.5 * surprise(away, &noise)?.distance2);
            sum += *weight;
        }
        if !(sum.is_finite() && sum > f32::MIN_POSITIVE) {
            self.unexplained = self.unexplained.saturating_add(1);
            return Ok(());
        }
        let old = self.particles;
        let step = sum / Self::count();
        let mut reached = step * self.random.uniform();
        let mut below = 0.0;
        for weight in &mut weights {
            below += *weight;
            *weight = below;
        }
        // Both run upwards, so the search goes on where it ended.
        let mut sources = old.iter().zip(&weights);
        let mut source = sources.next();
        for slot in &mut self.particles {
            if source.is_none_or(|(_, below)| *below <= reached) {
                source = sources.by_ref().find(|(_, below)| **below > reached).or(source);
            }
            if let Some((particle, _)) = source {
                *slot = *particle;
            }
            reached += step;
        }
        self.roughen();
        Ok(())
    }

    fn gaussian(&self) -> Gaussian {
        let mean = self.particles.iter().sum::<Vector4<f32>>() / Self::count();
        let mut covariance = Matrix4::zeros();
        for particle in &self.particles {
            let away = particle - mean;
            covariance += away * away.transpose();
        }
        Gaussian { mean, covariance: covariance / Self::count() }
    }
}
