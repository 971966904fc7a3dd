//! A steered and driven front wheel (book, Odometry: Tricycle).

use core::f32::consts::FRAC_PI_2;

use floorguard_types::geometry::{Twist2, wrap_angle};

use super::base_model::{BaseModel, limited_turn};

/// Speed of the front wheel, and where it points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SteeredWheel {
    /// Over ground, m/s.
    pub wheel_mps: f32,
    /// Counter-clockwise, radians.
    pub steering_rad: f32,
}

/// The base of FLOBOT: two free rear wheels, one front wheel that drives and steers.
///
/// ```
/// use floorguard_localisation::odometry::Tricycle;
/// use floorguard_types::geometry::Twist2;
///
/// let base = Tricycle { wheelbase_m: 1.1, steering_max_rad: 1.57 };
/// let wanted = Twist2 { linear_mps: 0.5, angular_radps: 0.066_666_7 };
/// let steering_rad = base.steering_rad(wanted, 0.0);
/// assert!((steering_rad - 0.145_628).abs() < 1.0e-6);
/// let driven = base.twist_at(base.wheel_mps(wanted, steering_rad, steering_rad), steering_rad);
/// assert!((driven.linear_mps - 0.5).abs() < 1.0e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tricycle {
    /// Rear axle to front wheel, metres, > 0.
    pub wheelbase_m: f32,
    /// The front wheel turns at most this far to either side, radians.
    pub steering_max_rad: f32,
}

/// What the rear axle may do beyond the wanted speed so that a turn on the spot can begin, m/s.
const CREEP_MPS: f32 = 0.02;
/// From this angle on the wheel turns the base about its rear axle, radians.
const ACROSS_RAD: f32 = 1.4;

impl Tricycle {
    /// Velocity of the middle of the rear axle from the front wheel's speed over ground and angle.
    #[must_use]
    pub fn twist_at(&self, wheel_mps: f32, steering_rad: f32) -> Twist2 {
        let (sin, cos) = libm::sincosf(steering_rad);
        Twist2 { linear_mps: wheel_mps * cos, angular_radps: wheel_mps * sin / self.wheelbase_m.max(1.0e-3) }
    }

    /// Steering angle for a wanted velocity; the angle it has already when it is to stand. Backwards the wheel points
    /// the other way for the same turn; a turn on the spot needs ±π/2, which is cut to what the wheel can do.
    #[must_use]
    pub fn steering_rad(&self, wanted: Twist2, current_rad: f32) -> f32 {
        let across_mps = wanted.angular_radps * self.wheelbase_m;
        if libm::fabsf(wanted.linear_mps) < 1.0e-3 && libm::fabsf(across_mps) < 1.0e-3 {
            return current_rad;
        }
        let angle_rad = if wanted.linear_mps < 0.0 {
            libm::atan2f(-across_mps, -wanted.linear_mps)
        } else {
            libm::atan2f(across_mps, wanted.linear_mps)
        };
        // Not `clamp`: it panics where the limit is negative or no number.
        angle_rad.min(self.steering_max_rad).max(-self.steering_max_rad)
    }

    /// Speed of the front wheel over ground for a wanted velocity, m/s, while the wheel still stands at `current_rad`
    /// and is to go to `target_rad`: slower while it turns, or the robot would leave its arc.
    #[must_use]
    pub fn wheel_mps(&self, wanted: Twist2, current_rad: f32, target_rad: f32) -> f32 {
        let across_mps = wanted.angular_radps * self.wheelbase_m;
        let full_mps = libm::hypotf(wanted.linear_mps, across_mps);
        // While the wheel is still on its way the rear axle must not be faster than permitted either.
        let slow_mps = libm::fabsf(wanted.linear_mps) + CREEP_MPS;
        let full_mps = full_mps.min(slow_mps / libm::fabsf(libm::cosf(current_rad)).max(1.0e-3));
        let full_mps = if wanted.linear_mps < 0.0 { -full_mps } else { full_mps };
        let error_rad = libm::fabsf(wrap_angle(target_rad - current_rad));
        let share = if error_rad < FRAC_PI_2 / 3.0 {
            1.0
        } else if error_rad <= FRAC_PI_2 {
            libm::cosf(error_rad).max(0.01)
        } else {
            0.01
        };
        full_mps * share
    }
}

impl BaseModel for Tricycle {
    type Wheels = SteeredWheel;

    fn wheels(&self, twist: Twist2) -> SteeredWheel {
        let steering_rad = self.steering_rad(twist, 0.0);
        SteeredWheel { wheel_mps: self.wheel_mps(twist, steering_rad, steering_rad), steering_rad }
    }

    fn twist(&self, wheels: &SteeredWheel) -> Twist2 {
        Self::twist_at(self, wheels.wheel_mps, wheels.steering_rad)
    }

    /// A wheel that turns nearly across turns the base on the spot.
    fn drivable(&self, twist: Twist2) -> Twist2 {
        if self.steering_max_rad >= ACROSS_RAD {
            return twist;
        }
        let curvature_per_m = libm::tanf(self.steering_max_rad) / self.wheelbase_m.max(1.0e-3);
        limited_turn(twist, libm::fabsf(twist.linear_mps) * curvature_per_m)
    }

    fn fastest_wheel_mps(&self, twist: Twist2) -> f32 {
        libm::hypotf(twist.linear_mps, twist.angular_radps * self.wheelbase_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BASE: Tricycle = Tricycle { wheelbase_m: 1.1, steering_max_rad: 1.57 };

    /// The test values of the book, Odometry: Tricycle.
    #[test]
    fn published_vector() {
        let wanted = Twist2 { linear_mps: 0.5, angular_radps: 0.066_666_7 };
        let steering_rad = BASE.steering_rad(wanted, 0.0);
        assert!((steering_rad - 0.145_628).abs() < 1e-6, "{steering_rad}");
        let wheel_mps = BASE.wheel_mps(wanted, steering_rad, steering_rad);
        assert!((wheel_mps - 0.505_349).abs() < 1e-5, "{wheel_mps}");
    }

    #[test]
    fn commands_come_back_as_motion_in_all_directions() {
        for (linear_mps, angular_radps) in [(0.5, 0.3), (0.5, -0.3), (-0.2, 0.1), (-0.2, -0.1), (0.0, 0.2)] {
            let wanted = Twist2 { linear_mps, angular_radps };
            let angle = BASE.steering_rad(wanted, 0.0);
            let twist = BASE.twist_at(BASE.wheel_mps(wanted, angle, angle), angle);
            assert!((twist.linear_mps - linear_mps).abs() < 1e-3, "{wanted:?} {twist:?}");
            assert!((twist.angular_radps - angular_radps).abs() < 1e-3, "{wanted:?} {twist:?}");
        }
    }

    #[test]
    fn a_wheel_that_must_turn_far_turns_first() {
        let wanted = Twist2 { linear_mps: 0.0, angular_radps: 0.5 };
        let target = BASE.steering_rad(wanted, 0.0);
        assert!(BASE.wheel_mps(wanted, 0.0, target) < 0.02);
        assert!(BASE.wheel_mps(wanted, target, target) > 0.5);
        assert_eq!(BASE.steering_rad(Twist2::ZERO, 0.7), 0.7);
    }
}
