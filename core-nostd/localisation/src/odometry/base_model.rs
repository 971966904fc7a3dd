//! One contract for every wheeled base (book, Odometry: Bases): from a wanted velocity to wheels, from wheels to a velocity, which
//! velocities it can drive at all, how fast its wheels get, and how sure its encoders are.

use floorguard_types::geometry::Twist2;

/// Kinematics of a base. The base point is the middle of the axle that does not steer, or of the base where none does.
///
/// Every function is total: numbers that are not finite give numbers that are not finite, and no panic. Cost: at most one pair
/// of sine and cosine and one arc tangent.
pub trait BaseModel: Copy + PartialEq {
    /// Speeds of the wheels over ground, m/s, and angles, radians, counter-clockwise.
    type Wheels: Copy + PartialEq + core::fmt::Debug;

    /// Inverse kinematics: the wheels for a velocity that the base can drive, robot frame.
    fn wheels(&self, twist: Twist2) -> Self::Wheels;

    /// Forward kinematics: the velocity of the base point, robot frame.
    fn twist(&self, wheels: &Self::Wheels) -> Twist2;

    /// The nearest velocity that the base can drive: the same speed, and as much of the turning rate as its wheels allow at that
    /// speed. Velocities that can be driven stay as they are, to the bit.
    fn drivable(&self, twist: Twist2) -> Twist2;

    /// Speed of the fastest wheel over ground, m/s, ≥ 0: what has to be braked.
    fn fastest_wheel_mps(&self, twist: Twist2) -> f32;
}

/// How sure a velocity is that encoders measured; forward speed and turning rate do not depend on each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityCovariance {
    /// Variance of the forward speed, (m/s)².
    pub speed_m2ps2: f32,
    /// Variance of the turning rate, (rad/s)².
    pub turn_rad2ps2: f32,
}

impl VelocityCovariance {
    /// Of the mean and of the difference of two sides whose speeds have this standard deviation each, m/s, on wheels that stand
    /// `track_m` apart: σ²/2 and 2·σ²/track² (book, Odometry: Bases).
    ///
    /// ```
    /// use floorguard_localisation::odometry::VelocityCovariance;
    ///
    /// let sure = VelocityCovariance::of_sides(0.02, 0.5);
    /// assert!((sure.speed_m2ps2 - 2.0e-4).abs() < 1.0e-9);
    /// assert!((sure.turn_rad2ps2 - 3.2e-3).abs() < 1.0e-8);
    /// ```
    #[must_use]
    pub fn of_sides(side_sigma_mps: f32, track_m: f32) -> Self {
        let (variance, track_m) = (side_sigma_mps * side_sigma_mps, track_m.max(1.0e-3));
        Self { speed_m2ps2: 0.5 * variance, turn_rad2ps2: 2.0 * variance / (track_m * track_m) }
    }
}

/// Turning rate within ±`limit_radps`, and the very same bits where it is.
pub(super) fn limited_turn(twist: Twist2, limit_radps: f32) -> Twist2 {
    // Not `clamp`: it panics where the limit is no number.
    let angular_radps = twist.angular_radps.min(limit_radps).max(-limit_radps);
    Twist2 { angular_radps, ..twist }
}
