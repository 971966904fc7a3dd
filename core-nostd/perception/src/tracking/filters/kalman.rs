//! The Kalman filter of a walker, extended for bearings. Source: book, Tracking: Filters.

use nalgebra::Matrix4;

use super::gaussian::{Degenerate, Gaussian, Surprise, inverse, surprise};
use super::{Observation, PersonFilter};

/// Linear for places, linearised for bearing and range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtendedKalman {
    /// What is believed.
    pub state: Gaussian,
}

impl PersonFilter for ExtendedKalman {
    fn predict(&mut self, seconds: f32, density: f32) {
        self.state.predict(seconds, density);
    }

    fn surprise(&self, seen: &Observation) -> Result<Surprise, Degenerate> {
        let jacobian = seen.jacobian(&self.state.mean);
        let innovation = seen.difference(seen.measured(), seen.expected(&self.state.mean));
        surprise(innovation, &(jacobian * self.state.covariance * jacobian.transpose() + seen.noise()))
    }

    fn update(&mut self, seen: &Observation) -> Result<(), Degenerate> {
        let Gaussian { mean, covariance } = self.state;
        let (jacobian, noise) = (seen.jacobian(&mean), seen.noise());
        let innovation = seen.difference(seen.measured(), seen.expected(&mean));
        let (inverse, _) = inverse(&(jacobian * covariance * jacobian.transpose() + noise))?;
        let gain = covariance * jacobian.transpose() * inverse;
        // Joseph form: stays positive definite.
        let keep = Matrix4::identity() - gain * jacobian;
        let covariance = keep * covariance * keep.transpose() + gain * noise * gain.transpose();
        self.state = Gaussian { mean: mean + gain * innovation, covariance }.checked()?;
        Ok(())
    }

    fn gaussian(&self) -> Gaussian {
        self.state
    }
}
