//! Whether the robot stands.

use floorguard_types::geometry::Twist2;

/// Slower requests are standing, m/s and rad/s.
const STANDS: (f32, f32) = (0.03, 0.06);

/// Slower than what counts as motion.
pub(super) fn is_standing(twist: Twist2) -> bool {
    twist.linear_mps.abs() < STANDS.0 && twist.angular_radps.abs() < STANDS.1
}
