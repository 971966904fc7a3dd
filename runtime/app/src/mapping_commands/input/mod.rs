//! Scans with odometry out of what people have: CARMEN logs, recordings of floorguard, bags of ROS 2.

mod bag;
mod carmen;
mod drive;
mod odometry;
mod sieve;

pub use drive::{Drive, InputOptions, ReadSummary};
pub use sieve::SieveCounters;
