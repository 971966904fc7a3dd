//! Recognises places: stretches of the path against earlier stretches.

mod closer;
mod config;
mod saved;
mod stretch;
mod verify;

pub use closer::{LoopCloser, LoopStatistics};
pub use config::LoopConfig;
pub use stretch::Stretch;
pub use verify::{Agreement, agreement};
