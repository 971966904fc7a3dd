//! From scan to scan: each is matched against the returns of the last metres.

mod between;
mod config;
mod local_map;
mod node;
mod packed;
mod saved;
mod sequence;
mod tracker;

pub use between::interpolated;
pub use config::FrontEndConfig;
pub use local_map::LocalMap;
pub use node::{Node, Passage};
pub use packed::PackedScan;
pub use sequence::sequence_edges;
pub use tracker::{Step, Tracker};
