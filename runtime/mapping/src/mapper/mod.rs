//! The whole way from scans to a map.

mod mapper;

pub use mapper::{MapConfig, Mapper};
