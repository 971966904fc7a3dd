//! How a drive can move: its limits, and what of a requested velocity it reaches within a period.

use crate::geometry::{Pose2, Twist2};

/// How the wheels bind forward speed and turning rate to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DriveGeometry {
    /// Two driven wheels on one axle: speed and turning rate are free of each other.
    #[default]
    Differential,
    /// A steered and driven front wheel. The base point is the middle of the rear axle.
    Tricycle {
        /// From the rear axle to the front wheel, metres, > 0.
        wheelbase_m: f32,
        /// Largest steering angle to either side, radians, within (0, π/2].
        steering_max_rad: f32,
    },
}

/// Limits of a drive. Invariant: all are finite and ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DriveKinematics {
    /// How speed and turning rate are bound.
    pub geometry: DriveGeometry,
    /// Forward, m/s.
    pub speed_max_mps: f32,
    /// Backwards, m/s, as a positive number; 0: it never reverses.
    pub reverse_max_mps: f32,
    /// Turning rate, rad/s.
    pub turn_max_radps: f32,
    /// Speeding up, m/s².
    pub acceleration_mps2: f32,
    /// Slowing down, m/s².
    pub braking_mps2: f32,
    /// Change of the turning rate, rad/s².
    pub turn_acceleration_radps2: f32,
}

impl DriveKinematics {
    /// The nearest velocity to the requested one that the drive reaches from `current` within `period_s` ≥ 0. A request that
    /// is not finite counts as standing still.
    #[must_use]
    pub fn reachable(&self, current: Twist2, requested: Twist2, period_s: f32) -> Twist2 {
        let requested = if requested.is_finite() { requested } else { Twist2::ZERO };
        let wanted_mps = requested.linear_mps.clamp(-self.reverse_max_mps, self.speed_max_mps);
        let change_mps = wanted_mps - current.linear_mps;
        let is_braking = change_mps * current.linear_mps < 0.0;
        let rate_mps2 = if is_braking { self.braking_mps2 } else { self.acceleration_mps2 };
        let step_mps = rate_mps2 * period_s;
        let linear_mps = current.linear_mps + change_mps.clamp(-step_mps, step_mps);
        let limit_radps = self.turn_limit_radps(linear_mps);
        let turn_radps = requested.angular_radps.clamp(-limit_radps, limit_radps);
        let step_radps = self.turn_acceleration_radps2 * period_s;
        let change_radps = (turn_radps - current.angular_radps).clamp(-step_radps, step_radps);
        let angular_radps = (current.angular_radps + change_radps).clamp(-limit_radps, limit_radps);
        Twist2 { linear_mps, angular_radps }
    }

    /// Largest turning rate at a forward speed, rad/s. A front wheel that steers to 90° turns on the spot.
    #[must_use]
    pub fn turn_limit_radps(&self, linear_mps: f32) -> f32 {
        match self.geometry {
            DriveGeometry::Differential => self.turn_max_radps,
            DriveGeometry::Tricycle { wheelbase_m, steering_max_rad } => {
                let spins = steering_max_rad >= core::f32::consts::FRAC_PI_2 - 1.0e-3;
                let curved_radps =
                    libm::fabsf(linear_mps) * libm::tanf(steering_max_rad) / wheelbase_m.max(1.0e-3);
                if spins { self.turn_max_radps } else { curved_radps.min(self.turn_max_radps) }
            }
        }
    }

    /// Way until standstill from a speed, metres, by the drive's own braking.
    #[must_use]
    pub fn stopping_distance_m(&self, speed_mps: f32) -> f32 {
        speed_mps * speed_mps / (2.0 * self.braking_mps2.max(1.0e-3))
    }
}

impl Pose2 {
    /// The pose after a constant velocity for some time: the exact arc. Cost: two sine-cosine pairs.
    #[must_use]
    pub fn after(self, twist: Twist2, period_s: f32) -> Self {
        let turn_rad = twist.angular_radps * period_s;
        let path_m = twist.linear_mps * period_s;
        // The chord of the arc; sin(x)/x by its series where x is small.
        let half_rad = 0.5 * turn_rad;
        let ratio = if libm::fabsf(half_rad) < 1.0e-2 {
            1.0 - half_rad * half_rad / 6.0
        } else {
            libm::sinf(half_rad) / half_rad
        };
        let (sin, cos) = libm::sincosf(self.heading_rad + half_rad);
        let chord_m = path_m * ratio;
        Self::new(self.x_m + chord_m * cos, self.y_m + chord_m * sin, self.heading_rad + turn_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRIVE: DriveKinematics = DriveKinematics {
        geometry: DriveGeometry::Differential,
        speed_max_mps: 1.0,
        reverse_max_mps: 0.3,
        turn_max_radps: 1.0,
        acceleration_mps2: 0.5,
        braking_mps2: 1.0,
        turn_acceleration_radps2: 2.0,
    };

    #[test]
    fn a_request_is_reached_step_by_step() {
        let fast = Twist2 { linear_mps: 9.0, angular_radps: -9.0 };
        let first = DRIVE.reachable(Twist2::ZERO, fast, 0.1);
        assert!((first.linear_mps - 0.05).abs() < 1e-6 && (first.angular_radps + 0.2).abs() < 1e-6);
        let braked = DRIVE.reachable(Twist2 { linear_mps: 0.5, angular_radps: 0.0 }, Twist2::ZERO, 0.1);
        assert!((braked.linear_mps - 0.4).abs() < 1e-6);
        let lost = Twist2 { linear_mps: f32::NAN, angular_radps: 1.0 };
        assert_eq!(DRIVE.reachable(Twist2::ZERO, lost, 0.1), Twist2::ZERO);
    }

    /// A steering limit of 45° and a wheelbase of 1 m: no tighter than a radius of 1 m.
    #[test]
    fn a_steered_wheel_limits_the_curvature() {
        let steering_max_rad = core::f32::consts::FRAC_PI_4;
        let geometry = DriveGeometry::Tricycle { wheelbase_m: 1.0, steering_max_rad };
        let drive = DriveKinematics { geometry, turn_acceleration_radps2: 100.0, ..DRIVE };
        let twist = Twist2 { linear_mps: 0.4, angular_radps: 0.0 };
        let turning = drive.reachable(twist, Twist2 { linear_mps: 0.4, angular_radps: 1.0 }, 0.1);
        assert!((turning.angular_radps - 0.4).abs() < 1e-5);
    }

    #[test]
    fn an_arc_ends_where_the_circle_says() {
        let quarter = Pose2::default()
            .after(Twist2 { linear_mps: 1.0, angular_radps: 1.0 }, core::f32::consts::FRAC_PI_2);
        assert!((quarter.x_m - 1.0).abs() < 1e-5 && (quarter.y_m - 1.0).abs() < 1e-5);
        let straight = Pose2::default().after(Twist2 { linear_mps: 2.0, angular_radps: 0.0 }, 1.5);
        assert!((straight.x_m - 3.0).abs() < 1e-6 && straight.y_m == 0.0);
    }
}
