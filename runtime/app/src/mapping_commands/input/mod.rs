//! Scans with odometry out of what people have: CARMEN logs, recordings of floorguard, bags of ROS 2; and revolutions out of
//! lidar captures.

mod bag;
mod carmen;
mod drive;
mod odometry;
mod sieve;
mod sweeps;

pub use drive::{Drive, InputOptions, ReadSummary};
pub use sieve::SieveCounters;
pub use sweeps::{SweepsRead, count_sweeps, read_sweeps};
