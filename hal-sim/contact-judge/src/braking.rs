//! The brakes of the machine, as physics allows them.

use crate::RobotMotion;

/// How a machine comes to rest.
///
/// From the order to full effect it goes on as it does, then it slows down evenly. Speeds are those of the wheel that is
/// braked, so that a robot that spins has a braking way, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brakes {
    /// From the order to the full effect, seconds.
    pub response_s: f32,
    /// m/s².
    pub deceleration_mps2: f32,
    /// The braked wheel, robot frame, metres.
    pub wheel_m: [f32; 2],
}

impl Brakes {
    /// Speed of the braked wheel, m/s.
    #[must_use]
    pub fn wheel_mps(&self, motion: RobotMotion) -> f32 {
        motion.speed_at(self.wheel_m)
    }

    /// From the order to standing, seconds.
    #[must_use]
    pub fn stopping_s(&self, wheel_mps: f32) -> f32 {
        self.response_s + wheel_mps / self.deceleration_mps2.max(0.01)
    }

    /// Way of the braked wheel from the order to standing, metres: v·t + v²/(2b).
    #[must_use]
    pub fn stopping_m(&self, wheel_mps: f32) -> f32 {
        self.path_m(wheel_mps, f32::INFINITY)
    }

    /// Way of the braked wheel `seconds` after the order, metres.
    #[must_use]
    pub fn path_m(&self, wheel_mps: f32, seconds: f32) -> f32 {
        let b = self.deceleration_mps2.max(0.01);
        let steady_s = seconds.min(self.response_s);
        let braked_s = (seconds - self.response_s).clamp(0.0, wheel_mps / b);
        wheel_mps * steady_s + wheel_mps * braked_s - b * braked_s * braked_s / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_of_the_formula() {
        let brakes = Brakes { response_s: 0.15, deceleration_mps2: 0.8, wheel_m: [0.8, 0.0] };
        // 1 m/s: 0.15 m, then 1/1.6 m in 1.25 s.
        assert!((brakes.stopping_m(1.0) - 0.775).abs() < 1e-6);
        assert!((brakes.stopping_s(1.0) - 1.4).abs() < 1e-6);
        assert!((brakes.path_m(1.0, 0.1) - 0.1).abs() < 1e-6);
        assert!((brakes.path_m(1.0, 1.15) - (0.15 + 1.0 - 0.4)).abs() < 1e-6);
        // A spin of 0.5 rad/s about the rear axle: the front wheel goes 0.4 m/s.
        let spin = RobotMotion { forward_mps: 0.0, turn_radps: 0.5 };
        assert!((brakes.wheel_mps(spin) - 0.4).abs() < 1e-6);
    }
}
