//! By how much the stamps of scans are early or late on the clock of the odometry, found from the drive alone.

mod estimate;
mod piece;

pub use estimate::{OFFSET_MAX_S, TimeOffset, estimate_time_offset};

#[cfg(test)]
mod tests;
