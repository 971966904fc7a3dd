//! A person as a Gaussian of four numbers, and what all Kalman filters do with it. Source: book, Tracking: Motion
//! model.

use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};

use floorguard_types::geometry::Point2;

/// Position and velocity with their covariance; state order x, vx, y, vy (book, Tracking: Motion model).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Metres and m/s.
    pub mean: Vector4<f32>,
    /// Covariance.
    pub covariance: Matrix4<f32>,
}

/// A filter could not take in a measurement: its covariance is no longer positive definite, or a number is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Degenerate;

/// How surprising a measurement is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surprise {
    /// Squared Mahalanobis distance.
    pub distance2: f32,
    /// Logarithm of the determinant of the innovation's covariance.
    pub log_determinant: f32,
}

/// Determinants below this are none.
const DETERMINANT_MIN: f32 = 1.0e-18;

impl Gaussian {
    /// At a place with a velocity; standard deviations in m and m/s.
    #[must_use]
    pub fn new(position: Point2, velocity: Point2, position_sigma_m: f32, velocity_sigma_mps: f32) -> Self {
        let (p, v) = (position_sigma_m * position_sigma_m, velocity_sigma_mps * velocity_sigma_mps);
        Self {
            mean: Vector4::new(position.x_m, velocity.x_m, position.y_m, velocity.y_m),
            covariance: Matrix4::from_diagonal(&Vector4::new(p, v, p, v)),
        }
    }

    /// Moves on with constant velocity and white acceleration of spectral density `density`, m²/s³ (book, Tracking:
    /// Motion model). For this linear model the unscented transform gives the same numbers.
    pub fn predict(&mut self, seconds: f32, density: f32) {
        let t = seconds.max(0.0);
        let (a, b, c) = (density * t * t * t / 3.0, density * t * t / 2.0, density * t);
        let motion = Matrix4::new(1.0, t, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, t, 0.0, 0.0, 0.0, 1.0);
        let noise = Matrix4::new(a, b, 0.0, 0.0, b, c, 0.0, 0.0, 0.0, 0.0, a, b, 0.0, 0.0, b, c);
        self.mean = motion * self.mean;
        self.covariance = motion * self.covariance * motion.transpose() + noise;
    }

    /// The same on both sides of the diagonal, and every number finite.
    pub(super) fn checked(&self) -> Result<Self, Degenerate> {
        let covariance = (self.covariance + self.covariance.transpose()) * 0.5;
        let finite = self.mean.iter().chain(covariance.iter()).all(|value| value.is_finite());
        let positive = covariance.diagonal().iter().all(|variance| *variance > 0.0);
        if finite && positive { Ok(Self { mean: self.mean, covariance }) } else { Err(Degenerate) }
    }
}

/// Inverse and determinant of a covariance of two numbers.
pub(super) fn inverse(matrix: &Matrix2<f32>) -> Result<(Matrix2<f32>, f32), Degenerate> {
    let determinant = matrix.m11 * matrix.m22 - matrix.m12 * matrix.m21;
    if !determinant.is_finite() || determinant < DETERMINANT_MIN {
        return Err(Degenerate);
    }
    let adjugate = Matrix2::new(matrix.m22, -matrix.m12, -matrix.m21, matrix.m11);
    Ok((adjugate / determinant, determinant))
}

/// How surprising an innovation is.
pub(super) fn surprise(innovation: Vector2<f32>, covariance: &Matrix2<f32>) -> Result<Surprise, Degenerate> {
    let (inverse, determinant) = inverse(covariance)?;
    let distance2 = (innovation.transpose() * inverse * innovation).x;
    Ok(Surprise { distance2, log_determinant: libm::logf(determinant) })
}
