//! Closes loops in space: places are recognised by the horizontal part of the sweeps, as on the plane, and measured in space by
//! planes.

mod closer;
mod config;
mod horizontal;
mod key_sweep;
mod registration;

pub use closer::{SpaceCloser, SpaceCloserCounters};
pub use config::SpaceCloserConfig;
pub use key_sweep::{KeySweep, SmallPoints};
