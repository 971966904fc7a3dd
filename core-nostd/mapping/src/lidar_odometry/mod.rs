//! Where a spinning lidar moves, from its returns: each sweep is laid onto a map of small planes that earlier sweeps left.
//!
//! The motion during a sweep is part of the estimate (pose and velocity at its end), so that a sweep is straightened by what
//! is being estimated; wheels, a gyroscope and a level floor enter as measurements with their deviations. The book
//! describes it (Lidar odometry in space).

mod align;
mod averaging;
mod doubt;
mod filter;
mod motion;
mod odometry;
mod outcome;
mod solve;
mod sweep_motion;
mod voxel_map;
#[cfg(test)]
#[path = "world_tests.rs"]
mod world;

pub use align::AlignConfig;
pub use averaging::{AveragedReturn, AveragingConfig, RINGS_MAX, SweepReturn, average_returns};
pub use filter::{FloorPrior, Gaussian3, Matrix12, MotionAid, MotionNoise, MotionState, WheelSpeed};
pub use motion::{Pose3, Twist3, cross_matrix};
pub use odometry::{Entering, LidarOdometry, OdometryConfig, SweepTimes};
pub use outcome::{SweepOutcome, WeakDirection};
pub use sweep_motion::SweepMotion;
pub use voxel_map::{
    Bucket, Eigen3, FixedVoxelMap, Level, Plane, Voxel, VoxelKey, VoxelMap, VoxelMapConfig, VoxelPlace, WAYS,
    symmetric_eigen,
};
