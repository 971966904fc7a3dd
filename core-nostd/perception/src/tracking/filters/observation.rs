//! What a detector measures of a person, in its own coordinates. Source: book, Tracking: Observations.

use nalgebra::{Matrix2, Matrix2x4, Vector2, Vector4};

use floorguard_types::geometry::{Point2, Pose2, wrap_angle};

/// One measurement of where a person is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Observation {
    /// A place in the fixed frame, the same doubt in both coordinates.
    Cartesian {
        /// Metres.
        position: Point2,
        /// Standard deviation of each coordinate, metres.
        sigma_m: f32,
    },
    /// Bearing and range from a sensor whose pose is given: the published code leaves the sensor at the origin.
    Polar {
        /// The sensor in the fixed frame.
        sensor: Pose2,
        /// Counter-clockwise from straight ahead, radians.
        bearing_rad: f32,
        /// Metres.
        range_m: f32,
        /// Standard deviations, radians and metres.
        sigma: [f32; 2],
    },
}

/// Nobody is nearer to a sensor than this, squared metres: bounds the Jacobian.
const RANGE2_MIN: f32 = 1.0e-6;

impl Observation {
    /// The measured numbers.
    pub(super) fn measured(&self) -> Vector2<f32> {
        match *self {
            Self::Cartesian { position, .. } => Vector2::new(position.x_m, position.y_m),
            Self::Polar { bearing_rad, range_m, .. } => Vector2::new(bearing_rad, range_m),
        }
    }

    /// What would be measured of somebody with this state [x, vx, y, vy].
    pub(super) fn expected(&self, state: &Vector4<f32>) -> Vector2<f32> {
        match *self {
            Self::Cartesian { .. } => Vector2::new(state.x, state.z),
            Self::Polar { sensor, .. } => {
                let (dx, dy) = (state.x - sensor.x_m, state.z - sensor.y_m);
                let bearing_rad = wrap_angle(libm::atan2f(dy, dx) - sensor.heading_rad);
                Vector2::new(bearing_rad, libm::hypotf(dx, dy))
            }
        }
    }

    /// Derivatives of what is measured by the state.
    pub(super) fn jacobian(&self, state: &Vector4<f32>) -> Matrix2x4<f32> {
        match *self {
            Self::Cartesian { .. } => Matrix2x4::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0),
            Self::Polar { sensor, .. } => {
                let (dx, dy) = (state.x - sensor.x_m, state.z - sensor.y_m);
                let range2 = (dx * dx + dy * dy).max(RANGE2_MIN);
                let range = libm::sqrtf(range2);
                Matrix2x4::new(-dy / range2, 0.0, dx / range2, 0.0, dx / range, 0.0, dy / range, 0.0)
            }
        }
    }

    /// Covariance of the measurement.
    pub(super) fn noise(&self) -> Matrix2<f32> {
        let [a, b] = match *self {
            Self::Cartesian { sigma_m, .. } => [sigma_m; 2],
            Self::Polar { sigma, .. } => sigma,
        };
        Matrix2::new(a * a, 0.0, 0.0, b * b)
    }

    /// `one − other`, wrapped to the shorter arc.
    pub(super) fn difference(&self, one: Vector2<f32>, other: Vector2<f32>) -> Vector2<f32> {
        let difference = one - other;
        match self {
            Self::Cartesian { .. } => difference,
            Self::Polar { .. } => Vector2::new(wrap_angle(difference.x), difference.y),
        }
    }

    /// The place that was measured, fixed frame, and the larger of its doubts across and along the line of sight.
    pub(super) fn place(&self) -> (Point2, f32) {
        match *self {
            Self::Cartesian { position, sigma_m } => (position, sigma_m),
            Self::Polar { sensor, bearing_rad, range_m, sigma } => {
                let (sin, cos) = libm::sincosf(sensor.heading_rad + bearing_rad);
                let place = Point2::new(sensor.x_m + range_m * cos, sensor.y_m + range_m * sin);
                let [across, along] = sigma;
                (place, (across * range_m).max(along))
            }
        }
    }
}
