//! How far predictions are off, by step: along the person's direction and across it, in relation to the speed.

use floorguard_types::geometry::Point2;
use floorguard_types::number::nearest_f32;

use super::STEPS;

/// Part of the doubt that even a standing person has, metres a step.
const STANDING_M: f32 = 0.15;
/// Outcomes that count.
const MEMORY: f32 = 400.0;
/// Of so many outcomes 95 lie within the ellipse.
const COVERED: f32 = 0.95;
/// How fast the ellipse follows.
const LEARNING: f32 = 0.02;

#[derive(Clone, Copy, Debug, PartialEq)]
struct StepDoubt {
    along_squared: f32,
    across_squared: f32,
    outcomes: f32,
    /// Mahalanobis distance within which 95 % of the outcomes lie.
    quantile: f32,
}

/// Errors by step of the horizon, in units of 0.15 m + last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubt {
    steps: [StepDoubt; STEPS],
}

impl Default for Doubt {
    /// Before anything was learnt: errors of constant velocity on recorded pedestrians, about 0.13 units a step along and
    /// across, growing a little faster than linearly.
    fn default() -> Self {
        let steps = core::array::from_fn(|step| {
            let steps = nearest_f32(step) + 1.0;
            let deviation = 0.13 * steps + 0.012 * steps * steps;
            let squared = deviation * deviation;
            // √5.99 is 2.448, the ellipse of a Gaussian; errors have longer tails.
            StepDoubt { along_squared: squared, across_squared: squared, outcomes: 30.0, quantile: 2.6 }
        });
        Self { steps }
    }
}

/// An error in the person's own directions.
struct Parts {
    along: f32,
    across: f32,
}

fn parts(last_step: Point2, error: Point2) -> Parts {
    let length_m = last_step.norm();
    let (ux, uy) =
        if length_m > 1.0e-3 { (last_step.x_m / length_m, last_step.y_m / length_m) } else { (1.0, 0.0) };
    let unit_m = STANDING_M + length_m;
    Parts {
        along: (error.x_m * ux + error.y_m * uy) / unit_m,
        across: (error.y_m * ux - error.x_m * uy) / unit_m,
    }
}

impl Doubt {
    /// Takes in the error of a prediction.
    pub(super) fn learn(&mut self, step: usize, last_step: Point2, error: Point2) {
        let Some(doubt) = self.steps.get_mut(step).filter(|_| error.norm().is_finite()) else { return };
        let Parts { along, across } = parts(last_step, error);
        let distance =
            libm::sqrtf(along * along / doubt.along_squared + across * across / doubt.across_squared);
        let is_outside = distance > doubt.quantile;
        let push = if is_outside { COVERED } else { COVERED - 1.0 };
        doubt.quantile = (doubt.quantile * (1.0 + LEARNING * push)).clamp(1.0, 8.0);
        doubt.outcomes = (doubt.outcomes + 1.0).min(MEMORY);
        doubt.along_squared =
            (doubt.along_squared + (along * along - doubt.along_squared) / doubt.outcomes).max(1.0e-4);
        doubt.across_squared =
            (doubt.across_squared + (across * across - doubt.across_squared) / doubt.outcomes).max(1.0e-4);
    }

    /// Half axes of the 95 % ellipse, metres: along the person's direction and across it.
    pub(super) fn half_axes_m(&self, step: usize, last_step: Point2) -> [f32; 2] {
        let unit_m = STANDING_M + last_step.norm();
        self.steps.get(step).map_or([f32::INFINITY; 2], |doubt| {
            [doubt.along_squared, doubt.across_squared]
                .map(|squared| doubt.quantile * libm::sqrtf(squared) * unit_m)
        })
    }

    /// An error lies within the 95 % ellipse.
    #[must_use]
    pub fn covers(&self, step: usize, last_step: Point2, error: Point2) -> bool {
        let Parts { along, across } = parts(last_step, error);
        self.steps.get(step).is_some_and(|doubt| {
            let squared = along * along / doubt.along_squared + across * across / doubt.across_squared;
            squared <= doubt.quantile * doubt.quantile
        })
    }
}
