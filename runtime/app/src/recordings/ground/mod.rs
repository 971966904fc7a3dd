//! The floor in a point cloud of a file, found by the robot's own stage.

mod cloud_file;
mod command;
mod find;
mod lzf;
mod pcd;
mod ply;
mod truth;

pub use cloud_file::read as read_cloud;
pub use command::{GroundArguments, run};
