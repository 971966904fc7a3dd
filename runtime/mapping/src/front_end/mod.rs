//! From scan to scan: each is matched against the returns of the last metres.

mod config;
mod local_map;
mod node;
mod tracker;

pub use config::FrontEndConfig;
pub use local_map::LocalMap;
pub use node::{Node, Passage};
pub use tracker::{Step, Tracker};
