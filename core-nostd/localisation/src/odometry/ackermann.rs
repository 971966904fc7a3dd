//! A driven rear axle and steered front wheels that cannot be turned across (book, Odometry: Bases).

use core::f32::consts::FRAC_PI_6;

use floorguard_types::geometry::{Twist2, wrap_angle};

use super::base_model::{BaseModel, limited_turn};

/// Speed of the rear axle's middle, and the steering angle of a wheel in the middle of the front axle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SteeredAxle {
    /// Over ground, m/s.
    pub rear_mps: f32,
    /// Counter-clockwise, radians.
    pub steering_rad: f32,
}

/// Of the speed, while the steering is far from its angle: it turns hardly faster while the base stands.
const SHARE_MIN: f32 = 0.05;

/// A base that steers as a car does.
///
/// ```
/// use floorguard_localisation::odometry::{Ackermann, BaseModel};
/// use floorguard_types::geometry::Twist2;
///
/// let base = Ackermann { wheelbase_m: 1.0, track_m: 0.6, steering_max_rad: 0.785_398_2 };
/// // At 45° the turning point lies a wheelbase beside the rear axle: no tighter.
/// let tight = base.drivable(Twist2 { linear_mps: 0.5, angular_radps: 2.0 });
/// assert!((tight.angular_radps - 0.5).abs() < 1.0e-6);
/// // It cannot turn on the spot.
/// assert_eq!(base.drivable(Twist2 { linear_mps: 0.0, angular_radps: 1.0 }), Twist2::ZERO);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ackermann {
    /// Rear axle to front axle, metres, > 0.
    pub wheelbase_m: f32,
    /// Between the rear wheels, metres, > 0.
    pub track_m: f32,
    /// The mean of the front wheels turns at most this far to either side, radians, in (0, π/2).
    pub steering_max_rad: f32,
}

impl Ackermann {
    /// Tightest curve, 1/m: tan(α_max)/L.
    #[must_use]
    pub fn curvature_max_per_m(&self) -> f32 {
        libm::tanf(self.steering_max_rad) / self.wheelbase_m.max(1.0e-3)
    }

    /// Steering angle for a velocity; the angle it has already when it is to stand.
    #[must_use]
    pub fn steering_rad(&self, twist: Twist2, current_rad: f32) -> f32 {
        if libm::fabsf(twist.linear_mps) < 1.0e-3 {
            return current_rad;
        }
        let angle_rad = libm::atanf(twist.angular_radps * self.wheelbase_m / twist.linear_mps);
        angle_rad.min(self.steering_max_rad).max(-self.steering_max_rad)
    }

    /// Speed of the rear axle while the steering stands at `current_rad` and is to go to `target_rad`, m/s: slower while it turns, or
    /// the robot would leave its arc.
    #[must_use]
    pub fn rear_mps(&self, twist: Twist2, current_rad: f32, target_rad: f32) -> f32 {
        let error_rad = libm::fabsf(wrap_angle(target_rad - current_rad));
        // Half of the speed while the steering is 15° away, hardly any from 30° on.
        let share = (1.0 - error_rad / FRAC_PI_6).max(SHARE_MIN);
        twist.linear_mps * if current_rad.is_finite() { share } else { SHARE_MIN }
    }
}

impl BaseModel for Ackermann {
    type Wheels = SteeredAxle;

    fn wheels(&self, twist: Twist2) -> SteeredAxle {
        SteeredAxle { rear_mps: twist.linear_mps, steering_rad: self.steering_rad(twist, 0.0) }
    }

    fn twist(&self, wheels: &SteeredAxle) -> Twist2 {
        let curvature_per_m = libm::tanf(wheels.steering_rad) / self.wheelbase_m.max(1.0e-3);
        Twist2 { linear_mps: wheels.rear_mps, angular_radps: wheels.rear_mps * curvature_per_m }
    }

    fn drivable(&self, twist: Twist2) -> Twist2 {
        limited_turn(twist, libm::fabsf(twist.linear_mps) * self.curvature_max_per_m())
    }

    fn fastest_wheel_mps(&self, twist: Twist2) -> f32 {
        // The outer front wheel has the longest way: its distance from the turning point.
        let across_mps = twist.angular_radps * self.wheelbase_m;
        let outer_mps = libm::fabsf(twist.linear_mps) + 0.5 * libm::fabsf(twist.angular_radps) * self.track_m;
        libm::hypotf(outer_mps, across_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BASE: Ackermann = Ackermann { wheelbase_m: 0.9, track_m: 0.6, steering_max_rad: 0.6 };

    /// The turning point lies on the line of the rear axle; the front wheel stands at right angles to the line that leads to it.
    #[test]
    fn front_wheel_is_square_to_the_turning_point() {
        for radius_m in [-5.0_f32, -1.5, 1.5, 3.0, 20.0] {
            let twist = Twist2 { linear_mps: 0.5, angular_radps: 0.5 / radius_m };
            let SteeredAxle { steering_rad, .. } = BASE.wheels(twist);
            let (sin, cos) = libm::sincosf(steering_rad);
            let along = cos * (0.0 - 0.9) + sin * radius_m;
            assert!(along.abs() < 1.0e-4, "radius {radius_m}: {along}");
            let back = BASE.twist(&BASE.wheels(twist));
            assert!((back.angular_radps - twist.angular_radps).abs() < 1.0e-5);
        }
    }

    #[test]
    fn curves_are_never_tighter_than_the_steering() {
        for (linear_mps, angular_radps) in [(0.5, 3.0), (-0.2, 3.0), (0.0, 1.0), (0.01, -9.0)] {
            let twist = BASE.drivable(Twist2 { linear_mps, angular_radps });
            let most = linear_mps.abs() * BASE.curvature_max_per_m();
            assert!((twist.angular_radps.abs() - most).abs() < 1.0e-6 && twist.linear_mps == linear_mps);
            assert!(BASE.wheels(twist).steering_rad.abs() <= 0.6 + 1.0e-6);
        }
        let gentle = Twist2 { linear_mps: 0.7, angular_radps: 0.123_456 };
        assert_eq!(BASE.drivable(gentle), gentle);
    }

    #[test]
    fn speed_waits_for_the_steering() {
        let twist = Twist2 { linear_mps: 0.6, angular_radps: 0.3 };
        let target_rad = BASE.steering_rad(twist, 0.0);
        assert_eq!(BASE.rear_mps(twist, target_rad, target_rad), 0.6);
        assert!(BASE.rear_mps(twist, -0.4, 0.4) < 0.04);
        assert_eq!(BASE.rear_mps(twist, f32::NAN, 0.4), 0.6 * 0.05);
        assert_eq!(BASE.steering_rad(Twist2::ZERO, 0.2), 0.2);
    }
}
