//! The robot's file: is it good, what do its sensors not see, and what belongs into it?

mod check;
mod lidar_metadata;

pub use check::{CheckArguments, run as check};
pub(crate) use check::{listed, say_absences};
pub use lidar_metadata::{LidarMetadataArguments, run as lidar_metadata};
