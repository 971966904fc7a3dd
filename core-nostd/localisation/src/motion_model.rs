//! How a particle moves: the odometry step with its doubt.

use floorguard_types::geometry::{Pose2, wrap_angle};
use floorguard_types::random::Pcg32;

/// Below this translation the direction of travel says nothing, metres.
const DIRECTION_FLOOR_M: f32 = 0.005;

/// What the odometry saw since the last update: turn, drive, turn.
///
/// ```
/// use floorguard_localisation::{OdometryStep, sample_motion};
/// use floorguard_types::{geometry::Pose2, random::Pcg32};
///
/// let (before, after) = (Pose2::new(1.0, 2.0, 0.7), Pose2::new(1.1, 2.1, 0.8));
/// let step = OdometryStep::between(before, after);
/// assert!((step.forward_m - 0.02_f32.sqrt()).abs() < 1.0e-6);
/// // Without noise a particle moves as the robot did.
/// let moved = sample_motion(before, step, [0.0; 3], &mut Pcg32::new(1, 1));
/// assert!((moved.x_m - 1.1).abs() < 1.0e-6 && (moved.y_m - 2.1).abs() < 1.0e-6);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OdometryStep {
    /// Turn towards the direction of travel, radians.
    pub first_turn_rad: f32,
    /// Distance driven, metres; negative backwards.
    pub forward_m: f32,
    /// Turn to the final heading, radians.
    pub second_turn_rad: f32,
}

impl OdometryStep {
    /// The step from one odometry pose to the next, both in the odometry frame. Driving backwards is a negative
    /// distance, not a half turn.
    #[must_use]
    pub fn between(before: Pose2, after: Pose2) -> Self {
        let inner = before.inverse().compose(after);
        let distance = libm::sqrtf(inner.x_m * inner.x_m + inner.y_m * inner.y_m);
        if distance < DIRECTION_FLOOR_M {
            return Self { first_turn_rad: 0.0, forward_m: inner.x_m, second_turn_rad: inner.heading_rad };
        }
        let backwards = inner.x_m < 0.0;
        let direction =
            if backwards { libm::atan2f(-inner.y_m, -inner.x_m) } else { libm::atan2f(inner.y_m, inner.x_m) };
        Self {
            first_turn_rad: direction,
            forward_m: if backwards { -distance } else { distance },
            second_turn_rad: wrap_angle(inner.heading_rad - direction),
        }
    }
}

/// Variance coefficients α₁..α₄ of the odometry model (book, Cleaning: Motion noise): turn by turn, turn by drive,
/// drive by drive, drive by turn. Deviations are the square roots.
///
/// ```
/// use floorguard_localisation::{MotionNoise, OdometryStep};
///
/// let metre = OdometryStep { forward_m: 1.0, ..OdometryStep::default() };
/// let two = OdometryStep { forward_m: 2.0, ..OdometryStep::default() };
/// let deviation_m = |step| MotionNoise::MEASURED.deviations(step)[1];
/// assert!(deviation_m(two) > deviation_m(metre));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionNoise {
    /// α₁, rad²/rad².
    pub turn_by_turn: f32,
    /// α₂, rad²/m².
    pub turn_by_drive: f32,
    /// α₃, m²/m².
    pub drive_by_drive: f32,
    /// α₄, m²/rad².
    pub drive_by_turn: f32,
}

impl MotionNoise {
    /// The default of AMCL: 0.2 each.
    pub const AMCL: Self =
        Self { turn_by_turn: 0.2, turn_by_drive: 0.2, drive_by_drive: 0.2, drive_by_turn: 0.2 };
    /// A small robot with a gyroscope (book, Cleaning: Motion noise).
    pub const GYROSCOPE: Self =
        Self { turn_by_turn: 0.02, turn_by_drive: 0.02, drive_by_drive: 0.05, drive_by_turn: 0.02 };
    /// For the errors of the published protocol (5 % of the distance, 0.02 rad/m, 3 % of the turn) at steps of 0.1 m,
    /// deviations taken 1.6 times as large. Too tight a model loses the robot after slip; too wide a one blurs what was
    /// cleaned.
    pub const MEASURED: Self =
        Self { turn_by_turn: 0.0025, turn_by_drive: 0.01, drive_by_drive: 0.0064, drive_by_turn: 0.0001 };

    /// Deviations of first turn, drive and second turn for a step.
    #[must_use]
    pub fn deviations(&self, step: OdometryStep) -> [f32; 3] {
        let drive = step.forward_m * step.forward_m;
        let first = step.first_turn_rad * step.first_turn_rad;
        let second = step.second_turn_rad * step.second_turn_rad;
        let root = |variance: f32| libm::sqrtf(variance.max(0.0));
        [
            root(self.turn_by_turn * first + self.turn_by_drive * drive),
            root(self.drive_by_drive * drive + self.drive_by_turn * (first + second)),
            root(self.turn_by_turn * second + self.turn_by_drive * drive),
        ]
    }
}

/// A pose after one noisy step; `deviations` from [`MotionNoise::deviations`].
#[inline]
#[must_use]
pub fn sample_motion(pose: Pose2, step: OdometryStep, deviations: [f32; 3], random: &mut Pcg32) -> Pose2 {
    let [first_deviation, drive_deviation, second_deviation] = deviations;
    let (a, b) = random.normal_pair();
    // The third number from a sum of uniforms (Irwin–Hall, 4 terms, unit variance): one logarithm less a particle.
    let sum = random.uniform() + random.uniform() + random.uniform() + random.uniform();
    let c = (sum - 2.0) * 1.732_050_8;
    let direction = pose.heading_rad + step.first_turn_rad + first_deviation * a;
    let distance = step.forward_m + drive_deviation * b;
    let (sin, cos) = libm::sincosf(direction);
    Pose2::new(
        pose.x_m + cos * distance,
        pose.y_m + sin * distance,
        direction + step.second_turn_rad + second_deviation * c,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn step_without_noise_reproduces_the_odometry() {
        let before = Pose2::new(1.0, 2.0, 0.7);
        let mut random = Pcg32::new(1, 1);
        for inner in [
            Pose2::new(0.1, 0.01, 0.1),
            Pose2::new(-0.1, 0.02, -0.1),
            Pose2::new(0.0, 0.0, 0.17),
            Pose2::default(),
        ] {
            let after = before.compose(inner);
            let moved = sample_motion(before, OdometryStep::between(before, after), [0.0; 3], &mut random);
            assert!((moved.x_m - after.x_m).abs() < 1e-6 && (moved.y_m - after.y_m).abs() < 1e-6);
            assert!(wrap_angle(moved.heading_rad - after.heading_rad).abs() < 1e-6);
        }
    }

    #[test]
    fn spread_follows_the_deviations() {
        let mut random = Pcg32::new(1, 1);
        let step = OdometryStep { forward_m: 0.1, ..OdometryStep::default() };
        let deviations = MotionNoise::MEASURED.deviations(step);
        let (mut sum, mut squares, mut heading) = (0.0_f64, 0.0_f64, 0.0_f64);
        for _ in 0..20_000 {
            let moved = sample_motion(Pose2::default(), step, deviations, &mut random);
            sum += f64::from(moved.x_m);
            squares += f64::from(moved.x_m).powi(2);
            heading += f64::from(moved.heading_rad).powi(2);
        }
        let mean = sum / 20_000.0;
        let deviation = (squares / 20_000.0 - mean * mean).sqrt();
        assert!((mean - 0.1).abs() < 2e-4 && (deviation - 0.008).abs() < 2e-4, "{mean} {deviation}");
        // Two turns of 0.1 · 0.1 rad each.
        assert!(((heading / 20_000.0).sqrt() - 0.01 * 2.0_f64.sqrt()).abs() < 3e-4);
    }
}
