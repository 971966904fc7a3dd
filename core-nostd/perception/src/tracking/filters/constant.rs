//! The tracker's own filter behind the common interface.

use nalgebra::{Matrix4, Vector4};

use super::gaussian::{Degenerate, Gaussian, Surprise};
use super::{Observation, PersonFilter};
use crate::tracking::ConstantVelocity;

impl PersonFilter for ConstantVelocity {
    fn predict(&mut self, seconds: f32, density: f32) {
        self.advance(seconds, density);
    }

    /// A bearing and range is taken as the place with the larger of both doubts.
    fn surprise(&self, seen: &Observation) -> Result<Surprise, Degenerate> {
        let (place, sigma_m) = seen.place();
        let variance = self.innovation_variance(sigma_m);
        if !variance.is_finite() {
            return Err(Degenerate);
        }
        Ok(Surprise {
            distance2: self.distance2(place, sigma_m),
            log_determinant: 2.0 * libm::logf(variance),
        })
    }

    fn update(&mut self, seen: &Observation) -> Result<(), Degenerate> {
        let (place, sigma_m) = seen.place();
        let mut next = *self;
        next.correct(place, sigma_m);
        if !next.is_finite() {
            return Err(Degenerate);
        }
        *self = next;
        Ok(())
    }

    fn gaussian(&self) -> Gaussian {
        let (p, c, v) = (self.position_variance, self.cross_covariance, self.velocity_variance);
        Gaussian {
            mean: Vector4::new(self.position.x_m, self.velocity.x_m, self.position.y_m, self.velocity.y_m),
            covariance: Matrix4::new(p, c, 0.0, 0.0, c, v, 0.0, 0.0, 0.0, 0.0, p, c, 0.0, 0.0, c, v),
        }
    }
}
