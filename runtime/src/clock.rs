//! The one place where the runtime reads a clock.
//!
//! Core code takes time as an argument; this is where the argument comes from. The board's `embassy-time` driver
//! decides whether it is a hardware timer, the computer's monotonic clock, or the simulator's virtual one.

use embassy_time::Instant;
use floorguard_types::time::Stamp;

/// Now, on the robot's monotonic clock.
#[must_use]
pub fn now() -> Stamp {
    Stamp::from_micros(Instant::now().as_micros())
}

/// The instant of a stamp, for timers.
#[must_use]
pub fn instant(stamp: Stamp) -> Instant {
    Instant::from_micros(stamp.as_micros())
}
