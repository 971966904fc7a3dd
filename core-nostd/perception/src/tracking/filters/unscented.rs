//! The unscented filter of a walker (Julier, scaled by κ alone). Source: book, Tracking: Filters.

use nalgebra::{Matrix2, Matrix4, Matrix4x2, Vector2, Vector4};

use super::gaussian::{Degenerate, Gaussian, Surprise, inverse, surprise};
use super::{Observation, PersonFilter};

/// n + κ with n = 4 and κ = 3 − n.
const SPREAD2: f32 = 3.0;
/// Weights of the middle, κ/(n + κ), and of each other point, 1/(2(n + κ)).
const MIDDLE: f32 = -1.0 / 3.0;
const OTHER: f32 = 1.0 / 6.0;
/// Share of the trace that is added once when the covariance is not positive definite.
const REPAIR: f32 = 1.0e-6;

/// Carries nine points through what is measured instead of a derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unscented {
    /// What is believed.
    pub state: Gaussian,
}

/// What the points say about a measurement.
struct Expected {
    measurement: Vector2<f32>,
    covariance: Matrix2<f32>,
    cross: Matrix4x2<f32>,
}

impl Unscented {
    fn expected(&self, seen: &Observation) -> Result<Expected, Degenerate> {
        let Gaussian { mean, covariance } = self.state;
        let root = cholesky(&covariance)
            .or_else(|_| cholesky(&(covariance + Matrix4::identity() * (REPAIR * covariance.trace()))))?;
        let root = root * libm::sqrtf(SPREAD2);
        let middle = seen.expected(&mean);
        // Bearings are averaged relative to the middle.
        let offset = |step: Vector4<f32>| seen.difference(seen.expected(&(mean + step)), middle);
        let mut shift = Vector2::zeros();
        for column in root.column_iter() {
            shift += (offset(column.into_owned()) + offset(-column)) * OTHER;
        }
        let mut expected = Expected {
            measurement: middle + shift,
            covariance: shift * shift.transpose() * MIDDLE + seen.noise(),
            cross: Matrix4x2::zeros(),
        };
        for column in root.column_iter() {
            for step in [column.into_owned(), -column] {
                let away = offset(step) - shift;
                expected.covariance += away * away.transpose() * OTHER;
                expected.cross += step * away.transpose() * OTHER;
            }
        }
        Ok(expected)
    }
}

impl PersonFilter for Unscented {
    fn predict(&mut self, seconds: f32, density: f32) {
        self.state.predict(seconds, density);
    }

    fn surprise(&self, seen: &Observation) -> Result<Surprise, Degenerate> {
        let expected = self.expected(seen)?;
        surprise(seen.difference(seen.measured(), expected.measurement), &expected.covariance)
    }

    fn update(&mut self, seen: &Observation) -> Result<(), Degenerate> {
        let expected = self.expected(seen)?;
        let (inverse, _) = inverse(&expected.covariance)?;
        let gain = expected.cross * inverse;
        let innovation = seen.difference(seen.measured(), expected.measurement);
        let mean = self.state.mean + gain * innovation;
        let covariance = self.state.covariance - gain * expected.covariance * gain.transpose();
        self.state = Gaussian { mean, covariance }.checked()?;
        Ok(())
    }

    fn gaussian(&self) -> Gaussian {
        self.state
    }
}

/// Lower triangle L with L·Lᵀ = the matrix.
fn cholesky(m: &Matrix4<f32>) -> Result<Matrix4<f32>, Degenerate> {
    let root = |square: f32| if square > 0.0 { Ok(libm::sqrtf(square)) } else { Err(Degenerate) };
    let a = root(m.m11)?;
    let (b, c, d) = (m.m21 / a, m.m31 / a, m.m41 / a);
    let e = root(m.m22 - b * b)?;
    let (f, g) = ((m.m32 - b * c) / e, (m.m42 - b * d) / e);
    let h = root(m.m33 - c * c - f * f)?;
    let i = (m.m43 - c * d - f * g) / h;
    let j = root(m.m44 - d * d - g * g - i * i)?;
    Ok(Matrix4::new(a, 0.0, 0.0, 0.0, b, e, 0.0, 0.0, c, f, h, 0.0, d, g, i, j))
}
