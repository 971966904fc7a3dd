//! Scans with odometry out of what people have: CARMEN logs, recordings of floorguard, bags of ROS 2; and revolutions of a lidar
//! out of captures, recordings and bags.

mod aids;
mod bag;
mod carmen;
mod cloud_sweep;
mod drive;
mod odometry_topic;
mod sieve;
mod space_bag;
mod space_drive;
mod sweeps;
mod turn_sum;

pub use drive::{Drive, InputOptions, ReadSummary};
pub use sieve::SieveCounters;
pub use space_drive::SpaceDrive;
pub use sweeps::SweepsRead;
