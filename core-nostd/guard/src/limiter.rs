//! From the wanted command to the permitted one: the same curve, never faster.

use super::rules::Escape;
use crate::protection::{Action, Cause, DriveLimits};
use floorguard_types::geometry::Twist2;

/// Turning slower than this is driving straight, rad/s: only that may leave an obstacle.
const STRAIGHT_RADPS: f32 = 0.02;

/// The speed that matters of a motion, m/s: of the rear axle, or of the steered wheel where it turns on the spot.
#[must_use]
pub fn effective_speed_mps(twist: Twist2, drive: &DriveLimits) -> f32 {
    twist.linear_mps.abs().max((twist.angular_radps * drive.wheelbase_m).abs())
}

/// How many times faster than the effective speed the fastest point of the body goes, at least 1. One number for all
/// commands of a curve, because both speeds scale with the command.
#[must_use]
pub fn body_ratio(wanted: Twist2, (fastest_mps, drive): (f32, &DriveLimits)) -> f32 {
    let speed_mps = effective_speed_mps(wanted, drive);
    if fastest_mps > speed_mps && speed_mps > 0.0 { fastest_mps / speed_mps } else { 1.0 }
}

/// Scales the wanted command down to the limit, the turning rate, and what acceleration permits after `previous`
/// within `step_s`. One factor in [0, 1] for both numbers: the curve stays, the output never exceeds the input
/// (FG-REQ-006).
#[must_use]
pub fn limited(
    wanted: Twist2,
    limit_mps: f32,
    drive: &DriveLimits,
    (previous, step_s): (Twist2, f32),
) -> Twist2 {
    let speed_mps = effective_speed_mps(wanted, drive);
    if !wanted.is_finite() || speed_mps <= 0.0 || limit_mps <= 0.0 {
        return Twist2::ZERO;
    }
    let turns_back = previous.linear_mps * wanted.linear_mps < 0.0;
    let from_mps = if turns_back { 0.0 } else { effective_speed_mps(previous, drive) };
    let reachable_mps = from_mps + drive.acceleration_mps2 * step_s;
    let allowed_mps = limit_mps.min(drive.speed_mps).min(reachable_mps);
    let turn_share = drive.turn_radps / wanted.angular_radps.abs().max(1.0e-6);
    let factor = (allowed_mps / speed_mps).min(turn_share).clamp(0.0, 1.0);
    Twist2 { linear_mps: wanted.linear_mps * factor, angular_radps: wanted.angular_radps * factor }
}

/// One cause lets the robot leave in the direction of the wanted command: it only limits, or its escape points there
/// (FG-REQ-040). `clear_ahead`: no evidence comes nearer in that direction.
#[must_use]
pub fn lets_leave(cause: Cause, action: Action, backward: bool, clear_ahead: bool) -> bool {
    let direction_fits = match cause.escape() {
        Escape::Never => false,
        Escape::Forward => !backward,
        Escape::Backward => backward,
        Escape::AwayFromEvidence => true,
    };
    !action.stops() || (action == Action::Category2 && direction_fits && clear_ahead)
}

/// The wanted command drives straight, so that the proof of [`lets_leave`] holds.
#[must_use]
pub fn is_straight(wanted: Twist2) -> bool {
    wanted.is_finite() && wanted.linear_mps != 0.0 && wanted.angular_radps.abs() <= STRAIGHT_RADPS
}
