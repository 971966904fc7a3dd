//! Where a camera is mounted beside a lidar, from points picked in both (book, Maps without people: Calibration).

mod camera;
mod pairs;
mod picture;
mod refine;
mod solve;
mod start;

pub use camera::CameraIntrinsics;
pub use pairs::{PickedPair, PickedPairsError, read_pairs};
pub use picture::{ResidualPicture, draw_residuals};
pub use solve::{MountingError, SolvedMounting, solve_mounting};

#[cfg(test)]
mod tests;
