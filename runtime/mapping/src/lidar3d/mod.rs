//! Maps a building in space out of the sweeps of a spinning lidar: trajectory, surfaces as a cloud, files for other tools.

mod cloud;
mod export;
mod mapper;
mod sweep;

pub use cloud::{CloudPoint, SurfaceCloud};
pub use export::{Colour, pcd, ply};
pub use mapper::{Mapper3, Mapper3Config, Mapper3Counters};
pub use sweep::{SweepRecord, sweep_times};
