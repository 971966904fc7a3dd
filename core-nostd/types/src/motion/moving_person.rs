//! A person near the robot, as prediction and planning see them.

use crate::geometry::Point2;

/// A tracked person. All in the map frame, at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MovingPerson {
    /// Middle of the body, metres.
    pub position_in_map: Point2,
    /// Velocity, m/s along x and y.
    pub velocity_in_map_mps: Point2,
    /// Standard deviation of the position along its worst direction, metres, ≥ 0.
    pub position_deviation_m: f32,
    /// Standard deviation of the velocity, m/s, ≥ 0.
    pub velocity_deviation_mps: f32,
}

impl MovingPerson {
    /// Everything is finite and the deviations are not negative.
    #[must_use]
    pub fn is_legal(&self) -> bool {
        self.position_in_map.norm().is_finite()
            && self.velocity_in_map_mps.norm().is_finite()
            && (0.0..f32::INFINITY).contains(&self.position_deviation_m)
            && (0.0..f32::INFINITY).contains(&self.velocity_deviation_mps)
    }

    /// Where the person is after some time at constant velocity, and with which deviation. The doubt grows with the
    /// velocity's deviation and with accelerations nobody announced, `acceleration_mps2` (a standard deviation).
    #[must_use]
    pub fn after(&self, time_s: f32, acceleration_mps2: f32) -> Self {
        let drift_m = self.velocity_deviation_mps * time_s;
        let surprise_m = 0.5 * acceleration_mps2 * time_s * time_s;
        let variance_m2 = self.position_deviation_m * self.position_deviation_m
            + drift_m * drift_m
            + surprise_m * surprise_m;
        Self {
            position_in_map: Point2::new(
                self.position_in_map.x_m + self.velocity_in_map_mps.x_m * time_s,
                self.position_in_map.y_m + self.velocity_in_map_mps.y_m * time_s,
            ),
            position_deviation_m: libm::sqrtf(variance_m2),
            ..*self
        }
    }
}
