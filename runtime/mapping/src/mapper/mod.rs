//! The whole way from scans to a map.

mod checkpoint;
mod whole;

pub use checkpoint::Resumed;
pub use whole::{MapConfig, Mapper};

#[cfg(test)]
mod tests;
