//! The last metre to a place that must be met exactly: straight ahead onto it, a look at what was reached, and back for another try.

mod approach;
mod config;

pub use approach::{DockApproach, DockStep};
pub use config::DockingConfig;

#[cfg(test)]
mod approach_tests;
