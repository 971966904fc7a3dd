//! The Kalman filter of a walker: constant velocity, position measured with the same doubt in x and y.
//!
//! With isotropic noise both axes share one 2 × 2 covariance, so the four-state filter (book, Tracking: Filters) costs
//! two two-state ones. For this linear model the unscented filter gives the same numbers.

use floorguard_types::geometry::Point2;

/// Position and velocity of a walker in a fixed frame.
///
/// # Invariants
/// The shared covariance `[[position, cross], [cross, velocity]]` is positive definite: every update uses the Joseph
/// form and variances are floored.
///
/// ```
/// use floorguard_perception::people::ConstantVelocity;
/// use floorguard_types::geometry::Point2;
///
/// // A person walks 1 m/s; the velocity is not known at first.
/// let mut person = ConstantVelocity::new(Point2::default(), Point2::default(), 0.1, 1.0);
/// for step in 1..=20_u8 {
///     person.advance(0.1, 0.4);
///     person.correct(Point2::new(0.1 * f32::from(step), 0.0), 0.05);
/// }
/// assert!((person.velocity.x_m - 1.0).abs() < 0.05);
/// // A place two metres aside would be a surprise.
/// assert!(person.distance2(Point2::new(2.0, 2.0), 0.05) > 100.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantVelocity {
    /// Position, metres.
    pub position: Point2,
    /// Velocity, m/s.
    pub velocity: Point2,
    /// Variance of each coordinate, m².
    pub position_variance: f32,
    /// Covariance of coordinate and speed along it, m²/s.
    pub cross_covariance: f32,
    /// Variance of each speed, m²/s².
    pub velocity_variance: f32,
}

/// Variances never fall below this, so that nothing divides by zero.
const VARIANCE_MIN: f32 = 1.0e-9;

impl ConstantVelocity {
    /// At `position` with `velocity`; standard deviations in m and m/s.
    #[must_use]
    pub fn new(position: Point2, velocity: Point2, position_sigma_m: f32, velocity_sigma_mps: f32) -> Self {
        Self {
            position,
            velocity,
            position_variance: (position_sigma_m * position_sigma_m).max(VARIANCE_MIN),
            cross_covariance: 0.0,
            velocity_variance: (velocity_sigma_mps * velocity_sigma_mps).max(VARIANCE_MIN),
        }
    }

    /// Moves on by `seconds` ≥ 0 with white acceleration of spectral density `density`, m²/s³ (rate-independent; book,
    /// Tracking: Motion model).
    pub fn advance(&mut self, seconds: f32, density: f32) {
        let t = seconds.max(0.0);
        let (xx, xv, vv) = (self.position_variance, self.cross_covariance, self.velocity_variance);
        self.position.x_m += t * self.velocity.x_m;
        self.position.y_m += t * self.velocity.y_m;
        self.position_variance = xx + 2.0 * t * xv + t * t * vv + density * t * t * t / 3.0;
        self.cross_covariance = xv + t * vv + density * t * t / 2.0;
        self.velocity_variance = vv + density * t;
    }

    /// Keeps a `share` 0…1 of the velocity: a walker of whom nothing is known slows down. Covariances follow.
    pub fn slow_down(&mut self, share: f32) {
        self.velocity.x_m *= share;
        self.velocity.y_m *= share;
        self.cross_covariance *= share;
        self.velocity_variance = (self.velocity_variance * share * share).max(VARIANCE_MIN);
    }

    /// Squared Mahalanobis distance of a measured position with standard deviation `sigma_m`.
    #[must_use]
    pub fn distance2(&self, measured: Point2, sigma_m: f32) -> f32 {
        let innovation = self.position.distance(measured);
        innovation * innovation / self.innovation_variance(sigma_m)
    }

    /// Variance of the innovation of each coordinate, m², > 0.
    #[must_use]
    pub fn innovation_variance(&self, sigma_m: f32) -> f32 {
        (self.position_variance + sigma_m * sigma_m).max(VARIANCE_MIN)
    }

    /// Takes in a measured position.
    pub fn correct(&mut self, measured: Point2, sigma_m: f32) {
        let noise = (sigma_m * sigma_m).max(VARIANCE_MIN);
        let (xx, xv, vv) = (self.position_variance, self.cross_covariance, self.velocity_variance);
        let innovation_variance = self.innovation_variance(sigma_m);
        let (gain_x, gain_v) = (xx / innovation_variance, xv / innovation_variance);
        let innovation = Point2::new(measured.x_m - self.position.x_m, measured.y_m - self.position.y_m);
        self.position.x_m += gain_x * innovation.x_m;
        self.position.y_m += gain_x * innovation.y_m;
        self.velocity.x_m += gain_v * innovation.x_m;
        self.velocity.y_m += gain_v * innovation.y_m;
        // Joseph form: (I − KH) P (I − KH)ᵀ + K R Kᵀ.
        let keep = 1.0 - gain_x;
        self.position_variance = (keep * keep * xx + gain_x * gain_x * noise).max(VARIANCE_MIN);
        self.cross_covariance = keep * (xv - gain_v * xx) + gain_x * gain_v * noise;
        self.velocity_variance =
            (vv - 2.0 * gain_v * xv + gain_v * gain_v * xx + gain_v * gain_v * noise).max(VARIANCE_MIN);
    }

    /// Speed, m/s.
    #[must_use]
    pub fn speed_mps(&self) -> f32 {
        self.velocity.norm()
    }

    /// Everything is a finite number.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let Self { position, velocity, position_variance, cross_covariance, velocity_variance } = self;
        [
            position.x_m,
            position.y_m,
            velocity.x_m,
            velocity.y_m,
            *position_variance,
            *cross_covariance,
            *velocity_variance,
        ]
        .iter()
        .all(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The update of the test values of the book, Tracking: Filters, from their prediction.
    #[test]
    fn update_equals_the_vector() {
        let mut filter = ConstantVelocity {
            position: Point2::new(1.05, 1.975),
            velocity: Point2::new(0.5, -0.25),
            position_variance: 0.050_049,
            cross_covariance: 0.100_98,
            velocity_variance: 1.019_6,
        };
        assert!((filter.distance2(Point2::new(1.10, 1.90), 0.1) - 0.367_840 * 0.367_840).abs() < 1.0e-4);
        filter.correct(Point2::new(1.10, 1.90), 0.1);
        let found = [
            filter.position.x_m,
            filter.velocity.x_m,
            filter.position.y_m,
            filter.velocity.y_m,
            filter.position_variance,
            filter.cross_covariance,
            filter.velocity_variance,
        ];
        let wanted =
            [1.091_673_5, 0.584_081_3, 1.912_489_8, -0.376_122, 0.008_334_693, 0.016_816_267, 0.849_789_3];
        for (value, expected) in found.iter().zip(wanted) {
            assert!((value - expected).abs() < 2.0e-5, "{found:?}");
        }
    }

    /// Two half steps equal one whole step: the noise does not depend on the rate.
    #[test]
    fn prediction_does_not_depend_on_the_rate() {
        let mut whole = ConstantVelocity::new(Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), 0.2, 1.0);
        let mut halves = whole;
        whole.advance(0.2, 0.065);
        halves.advance(0.1, 0.065);
        halves.advance(0.1, 0.065);
        assert!((whole.position_variance - halves.position_variance).abs() < 1.0e-6);
        assert!((whole.cross_covariance - halves.cross_covariance).abs() < 1.0e-6);
        assert!((whole.velocity_variance - halves.velocity_variance).abs() < 1.0e-6);
    }

    /// Prediction of the same values with the published noise: only the q part differs, so the noise-free part is
    /// checked.
    #[test]
    fn noise_free_prediction_equals_the_vector() {
        let mut filter = ConstantVelocity::new(Point2::new(1.0, 2.0), Point2::new(0.5, -0.25), 0.2, 1.0);
        filter.advance(0.1, 0.0);
        assert!((filter.position.x_m - 1.05).abs() < 1.0e-6 && (filter.position.y_m - 1.975).abs() < 1.0e-6);
        assert!((filter.position_variance - 0.05).abs() < 1.0e-6);
        assert!((filter.cross_covariance - 0.1).abs() < 1.0e-6);
    }
}
