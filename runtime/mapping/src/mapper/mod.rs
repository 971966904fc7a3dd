//! The whole way from scans to a map.

mod whole;

pub use whole::{MapConfig, Mapper};
