//! Surfaces of a building in cubes of bounded number.

mod eigen;
mod key;
mod map;
mod plane;
mod voxel;

pub use eigen::{Eigen3, symmetric_eigen};
pub use key::{Level, VoxelKey};
pub use map::{Bucket, FixedVoxelMap, VoxelMap, VoxelMapConfig, VoxelPlace, WAYS};
pub use plane::Plane;
pub use voxel::Voxel;
