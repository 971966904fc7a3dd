//! Filters of one person behind one interface: Kalman, extended, unscented, particles; places or bearing and range.
//!
//! The tracker of the robot uses [`ConstantVelocity`](super::ConstantVelocity), the special case that costs a tenth;
//! the others are for bearings, for other detectors and for comparison. Source: book, Tracking: Filters.

mod constant;
mod gaussian;
mod kalman;
mod observation;
mod particles;
mod unscented;

pub use gaussian::{Degenerate, Gaussian, Surprise};
pub use kalman::ExtendedKalman;
pub use observation::Observation;
pub use particles::Particles;
pub use unscented::Unscented;

/// What every filter of a person does.
pub trait PersonFilter {
    /// Moves on by `seconds` with white acceleration of spectral density `density`, m²/s³.
    fn predict(&mut self, seconds: f32, density: f32);

    /// How surprising a measurement would be, for gates and costs.
    ///
    /// # Errors
    /// The innovation's covariance is not positive definite.
    fn surprise(&self, seen: &Observation) -> Result<Surprise, Degenerate>;

    /// Takes in a measurement.
    ///
    /// # Errors
    /// The belief would not be a Gaussian any more; it stays as it was.
    fn update(&mut self, seen: &Observation) -> Result<(), Degenerate>;

    /// Mean and covariance of the belief.
    fn gaussian(&self) -> Gaussian;
}
