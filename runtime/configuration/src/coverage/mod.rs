//! What no sensor of a robot can see of the volume that its body goes into (book, Coverage of the sensors).
//!
//! Pure geometry of the file: mountings, angles, ranges, body, limits. What is called seen is met by a ray at that place and
//! height; that it is an obstacle then is the guard's business. A test casts the simulator's rays at it.

mod accepted;
mod analysis;
mod area;
mod gap;
mod limits;
mod rays;
mod sight;
#[cfg(test)]
mod tests;

pub use accepted::{AcceptedGap, Refusal};
pub use analysis::{Coverage, GapMotion, SensorGap, SpeedStep};
pub use area::{Motion, Region};
pub use gap::{Gap, Unseen};
pub use limits::{Direction, DirectionLimit, GapSpeed};
pub use sight::{BAR_M, HEIGHTS_M, Sight};

pub(super) use accepted::{Accepted, read_accepted};
pub(super) use limits::unseen_limits;
